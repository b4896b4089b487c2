"""The core: goals, input feeder, action extractor and the cycle that joins them (pure)."""

from typing import TYPE_CHECKING

from rosoclingo.common.lazy import loader

if TYPE_CHECKING:
    from rosoclingo.reasoning.action_extractor import TaskPlan, extract_plan
    from rosoclingo.reasoning.core import Core
    from rosoclingo.reasoning.events import (
        ActionsDispatched,
        ActionsPreempted,
        Event,
        FactTaken,
        GoalChanged,
        GoalProgress,
        GoalRefused,
        GoalUnmet,
        Observer,
        PlanMade,
        Problem,
        ReturnTaken,
        StateChanged,
        UpdateSent,
    )
    from rosoclingo.reasoning.goals import (
        TERMINAL,
        TRANSITIONS,
        Goal,
        GoalError,
        GoalEvent,
        GoalState,
        Outcome,
        TransitionError,
        read_goal,
    )
    from rosoclingo.reasoning.keywords import Action, KeywordError, Return
    from rosoclingo.reasoning.settings import CoreSettings
    from rosoclingo.reasoning.stream_planner import Halt

__all__ = [
    "TERMINAL",
    "TRANSITIONS",
    "Action",
    "ActionsDispatched",
    "ActionsPreempted",
    "Core",
    "CoreSettings",
    "Event",
    "FactTaken",
    "Goal",
    "GoalChanged",
    "GoalError",
    "GoalEvent",
    "GoalProgress",
    "GoalRefused",
    "GoalState",
    "GoalUnmet",
    "Halt",
    "KeywordError",
    "Observer",
    "Outcome",
    "PlanMade",
    "Problem",
    "Return",
    "ReturnTaken",
    "StateChanged",
    "TaskPlan",
    "TransitionError",
    "UpdateSent",
    "extract_plan",
    "read_goal",
]

__getattr__ = loader(
    __name__,
    {
        "Action": "keywords",
        "ActionsDispatched": "events",
        "ActionsPreempted": "events",
        "Core": "core",
        "CoreSettings": "settings",
        "Event": "events",
        "FactTaken": "events",
        "Goal": "goals",
        "GoalChanged": "events",
        "GoalError": "goals",
        "GoalEvent": "goals",
        "GoalProgress": "events",
        "GoalRefused": "events",
        "GoalState": "goals",
        "GoalUnmet": "events",
        "Halt": "stream_planner",
        "KeywordError": "keywords",
        "Observer": "events",
        "Outcome": "goals",
        "PlanMade": "events",
        "Problem": "events",
        "Return": "keywords",
        "ReturnTaken": "events",
        "StateChanged": "events",
        "TERMINAL": "goals",
        "TRANSITIONS": "goals",
        "TaskPlan": "action_extractor",
        "TransitionError": "goals",
        "UpdateSent": "events",
        "extract_plan": "action_extractor",
        "read_goal": "goals",
    },
)
