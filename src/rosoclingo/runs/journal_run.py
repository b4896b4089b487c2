"""Reads the events of a run from a core's journal, from its last checkpoint on.

The updates of a cycle are in the solver's log; the decisions are the plan and the dispatched actions. A journal has no
messages of other nodes, such as the robot's pose.
"""

from dataclasses import replace
from pathlib import Path
from typing import Dict, FrozenSet, List, Mapping, Optional, Set, Tuple

from rosoclingo.oclingo import Statement, StreamUpdate
from rosoclingo.oclingo.progression.updates import Reset
from rosoclingo.planning.history import AcceptedUpdate, entry_from_message
from rosoclingo.reasoning.action_extractor import TaskPlan
from rosoclingo.reasoning.goals import GoalState
from rosoclingo.reasoning.journal.database import Header, JournalError, Moment, history
from rosoclingo.reasoning.journal.keeper import ClientGoal
from rosoclingo.reasoning.keywords import REQUEST, RETURN, RUNNING, TAKES, Action
from rosoclingo.reasoning.recorded_history import RecordedHistory
from rosoclingo.reasoning.records import Record, codec, group
from rosoclingo.reasoning.returns import Dispatch
from rosoclingo.runs.events import GoalReport
from rosoclingo.runs.recorded_run import RecordingError, RunProgram
from rosoclingo.runs.run_view import RunEvents

#: The sender of facts in an update.
SOMEBODY = "an interface"

#: actionlib's number of a lost goal.
_LOST = 9

_read_plan, _read_client = codec(TaskPlan).decode, codec(ClientGoal).decode
_read_actions, _read_dispatches = codec(FrozenSet[Action]).decode, codec(List[Dispatch]).decode


def read_journal(file: Path, events: RunEvents) -> None:
    """Pass the events of the run in a journal to ``events``; raises RecordingError for a damaged one, and OSError."""
    try:
        header, moments = history(file)
    except JournalError as error:
        raise RecordingError(f"{file}: {error}; take another copy of the journal") from None
    reader = _Reader(events, header)
    for moment in moments:
        reader.take(moment)


class _Reader:
    """Reports the events between successive states."""

    def __init__(self, events: RunEvents, header: Header) -> None:
        """Report to ``events``, beginning with the program; raises RecordingError."""
        self._events = events
        self._now = self._last = 0.0  # the time of the last state, which never goes back, and as it was recorded
        self._clients: Dict[str, ClientGoal] = {}  # of the last state
        self._returns: Set[str] = set()
        self._entries: Set[str] = set()  # names of the log's entries
        self._updates: List[StreamUpdate] = []  # updates since the beginning of the last cycle
        self._cycle = -1  # of the last accepted update, -1 before the first state
        self._has_update = False  # whether a cycle has begun since the first state
        self._plan: object = None  # of that cycle
        if header.description:
            program = replace(RunProgram.parse(header.description), run=header.run)
            events.program(0.0, program.text())
        events.goals(0.0, [])  # goals of the first state are news

    def take(self, moment: Moment) -> None:
        """Process the next state and its time."""
        self._now += max(0.0, moment.time - self._last)
        self._last = moment.time
        state, time = moment.state, self._now
        found: Dict[str, ClientGoal] = {key: _read_client(value) for key, value in group(state, "client").items()}
        dispatches: List[Dispatch] = _read_dispatches(state["execution:dispatches"])
        sent = [action for one in dispatches for action in one.actions]
        self._arrivals(time, found)
        if self._cycle < 0:
            self._cycle, start = _latest(state), RecordedHistory()
            start.restore(state)
            self._events.resume(start.history, self._cycle)
            self._entries.update(group(state, "log"))
        ended = sorted(_read_actions(state["preemption:found"]))
        self._events.dispatched(time, [*(str(one.atom) for one in sent), *(str(one.cancellation) for one in ended)])
        self._accepted(time, state)
        self._decided(time, state)
        self._returned(time, [str(one.atom) for dispatch in dispatches for one in dispatch.returns])
        self._events.beliefs(time, state["core:step"], sorted(group(state, "believed")))
        self._events.mode(time, state["core:mode"])
        self._statuses(time, found, group(state, "goal"))
        self._events.clock(time)

    def _arrivals(self, time: float, found: Mapping[str, ClientGoal]) -> None:
        """Report new goals and cancels."""
        new = {key: client for key, client in found.items() if key not in self._clients}
        for key, client in new.items():
            stamp = client.stamp[0] + 1e-9 * client.stamp[1]
            earlier = self._cycle < 0 and 0.0 < stamp < time
            self._events.goals(stamp if earlier else time, [GoalReport(key, client.text, GoalState.PENDING.number, "")])
        for key, client in found.items():
            if client.cancelled and (key in new or not self._clients[key].cancelled):
                self._events.cancel(time, key)

    def _returned(self, time: float, facts: List[str]) -> None:
        fresh = [text for text in facts if text not in self._returns]
        self._returns.update(fresh)
        self._events.returned(time, SOMEBODY, fresh)

    def _accepted(self, time: float, state: Record) -> None:
        """Report the updates of a new cycle."""
        entries = {name: value for name, value in group(state, "log").items() if name not in self._entries}
        self._entries.update(entries)
        accepted = (entry_from_message(value) for value in entries.values() if value["do"] == "update")
        self._updates += [one.update for one in accepted if isinstance(one, AcceptedUpdate) and one.update is not None]
        if _latest(state) > self._cycle:
            for update in self._effective_updates():
                self._returned(time, _facts(update))
                self._events.update(time, str(update))
            self._cycle, self._updates, self._plan, self._has_update = _latest(state), [], None, True

    def _effective_updates(self) -> List[StreamUpdate]:
        """Return the last update of each step, or all updates from the last restart of the program on."""
        restarts = [number for number, update in enumerate(self._updates) if Reset() in update.items]
        if restarts:
            return self._updates[restarts[-1] :]
        return list({one.step: one for one in self._updates if (one.step or 1) > self._cycle}.values())

    def _decided(self, time: float, state: Record) -> None:
        """Report a new plan, with the horizon of the adopted plan or of the last search."""
        plan, step = state["core:plan"], state["core:step"]
        if plan in (None, self._plan) or (self._has_update and step != self._cycle):  # the core has dropped an update
            return
        self._plan = plan
        actions = [str(one.atom) for one in _read_plan(plan).actions if one.cycle >= step]
        if self._cycle or actions:
            entries = list(group(state, "log").values())
            plans = [one for one in entries if one["do"] == "adopt"]
            horizon = int((plans or [one for one in entries if one["do"] == "update"])[-1]["horizon"])
            self._events.plan(time, max(1, step), horizon, actions)

    def _statuses(self, time: float, found: Dict[str, ClientGoal], goals: Record) -> None:
        """Report the states of goals, and their ends."""
        reports = [GoalReport(key, client.text, *_status(client, goals.get(key))) for key, client in found.items()]
        lost = [(key, one) for key, one in self._clients.items() if key not in found and one.ending is None]
        reports += [GoalReport(key, client.text, _LOST, "its end is not in the journal") for key, client in lost]
        self._events.goals(time, reports)
        self._clients = found


def _status(client: ClientGoal, goal: Optional[Record]) -> Tuple[int, str]:
    """Return actionlib's number and the reason of a goal's state; ``goal`` is None if the core does not have it."""
    number = client.state(None if goal is None else GoalState(goal["state"])).number
    if client.ending is not None:
        return number, client.ending.message
    return number, "for its turn" if goal is not None and goal["waits"] else ""


def _latest(state: Record) -> int:
    """Return the cycle of the last accepted update."""
    return int(state["announced:published"])


def _facts(update: StreamUpdate) -> List[str]:
    """Return the facts of interfaces in an update, except returns."""
    heads = [one.head for one in update.items if isinstance(one, Statement) and one.head is not None]
    return [str(head) for head in heads if head.name not in (REQUEST, RETURN, RUNNING, TAKES)]
