"""The core: goals, input feeder, action extractor and the cycle that joins them (pure)."""

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
