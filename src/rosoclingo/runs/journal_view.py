"""What a page shows of a run, out of a core's journal: what the core was told, decided and believed, and when.

It goes back to the record with the whole state. What other nodes tell, above all where the robot is, is not in it.
"""

from pathlib import Path
from typing import Any, Dict, List, Mapping, Optional, Set, Tuple

from rosoclingo.oclingo import Statement, StreamUpdate
from rosoclingo.reasoning.goals import TRANSITIONS, GoalEvent, GoalState
from rosoclingo.reasoning.journal.database import State
from rosoclingo.reasoning.journal.keeper import Client
from rosoclingo.reasoning.keywords import REQUEST, RETURN, is_keyword
from rosoclingo.reasoning.records import actions_of, group, keys_of, plan_of, symbol_of
from rosoclingo.reasoning.returns import Dispatch
from rosoclingo.runs.journal_run import JournalReader, horizon_of, journal_history, program_of
from rosoclingo.runs.recorded_run import RecordedCycle
from rosoclingo.runs.run_view import RunView

__all__ = ["journal_view"]

#: What a page says that it cannot show.
LACKS = "a journal has no poses, map or packages, no lines of the core's log and no times of the solver"
TIMELESS = "nor any times: a record counts as a second"

#: From whom facts come that are in an update.
SOMEBODY = "an interface"

#: The statuses of goals that have not ended, as actionlib numbers all of them.
_NUMBERS = {
    state: number
    for number, state in enumerate(
        (
            GoalState.PENDING,
            GoalState.ACTIVE,
            GoalState.PREEMPTED,
            GoalState.SUCCEEDED,
            GoalState.ABORTED,
            GoalState.REJECTED,
            GoalState.PREEMPTING,
            GoalState.RECALLING,
            GoalState.RECALLED,
        )
    )
}
_LOST = 9


def journal_view(file: Path, about: Optional[Mapping[str, Any]] = None) -> RunView:
    """Return what a page shows of the run in a journal; ``about`` is what else the page says.

    Raises RecordingError with the record that is damaged, and OSError.
    """
    header, moments = journal_history(file)
    view, program = RunView(about), program_of(header)
    if program is not None:
        view.program(program.text())
    teller, clock, times = _Teller(view), _Clock(), []
    for state, time in moments:
        times.append(time)
        teller.take(clock.at(time), state)
    view.finish()
    first = f"it begins with cycle {teller.first}" if teller.first > 1 else ""
    lacks = [LACKS, *([TIMELESS] if None in times else []), *filter(None, [first])]
    view.tell(lacks="; ".join(lacks))
    return view


class _Clock:
    """Seconds that only go forward, whatever simulated time did; a record without a time is a second after the last."""

    def __init__(self) -> None:
        self._now, self._last = 0.0, 0.0

    def at(self, time: Optional[float]) -> float:
        """Return the seconds for the time of the next record."""
        if time is None:
            self._now += 1.0
        elif not self._now:
            self._now = time
        else:
            self._now += max(0.0, time - self._last)
        self._last = self._last if time is None else time
        return self._now


class _Teller:
    """Tells a view what has come from one state to the next."""

    def __init__(self, view: RunView) -> None:
        self._view = view
        self._reader: Optional[JournalReader] = None
        self._clients: Dict[str, Client] = {}
        self._ended: Set[str] = set()
        self._states: Dict[str, Tuple[GoalState, bool]] = {}
        self._returns: Set[str] = set()
        self._told = (0, 0, 0)  # cycles, plans of the last one, and actions of it that went out
        self.first = 1

    def take(self, time: float, state: State) -> None:
        """Take the next state, and the time since which it is so."""
        self._arrivals(time, state)
        if self._reader is None:
            self._begin(time, state)
        else:
            self._preempted(time, state)
            self._answers(time, state)
            self._reader.take(state)
            self._progress(time, self._reader.cycles)
        self._view.beliefs(
            time, state["core"]["step"], sorted(str(symbol_of(one)) for one in keys_of(state, "believed"))
        )
        self._statuses(time, state)
        self._view.clock(time)

    def _begin(self, time: float, state: State) -> None:
        """Tell of the plan with which the file begins, and of what is under way."""
        self._reader = JournalReader(state)
        self.first = cycle = max(1, state["core"]["step"])
        if state["plan"] is not None and (state["core"]["told"] or plan_of(state["plan"]).actions):
            self._view.plan(time, cycle, horizon_of(state), [str(one.atom) for one in plan_of(state["plan"]).actions])
        if state["dispatch"] is not None:
            self._view.dispatched(time, [str(one.atom) for one in actions_of(state["dispatch"]["actions"])])
            self._preempted(time, state)
            self._answers(time, state)

    def _arrivals(self, time: float, state: State) -> None:
        """Tell of goals that have come, and of cancellations."""
        found = {key: Client.of_record(value) for key, value in group(state, "client").items()}
        for key, client in found.items():
            before = self._clients.get(key)
            if before is None:
                stamp = client.stamp[0] + 1e-9 * client.stamp[1]
                earlier = self._reader is None and 0.0 < stamp < time
                self._view.goal(stamp if earlier else time, key, client.text)
            if client.cancelled and not (before is not None and before.cancelled):
                self._view.cancel(time, key)
        self._clients.update(found)

    def _preempted(self, time: float, state: State) -> None:
        """Report the actions under way that the core has cancelled."""
        self._view.dispatched(time, [str(one.cancellation) for one in actions_of(state["preemption"]["ended"])])

    def _answers(self, time: float, state: State) -> None:
        """Tell what has come back for the actions under way."""
        if state["dispatch"] is not None:
            self._returned(time, [str(one.atom) for one in Dispatch.of_record(state["dispatch"]).returns])

    def _returned(self, time: float, facts: List[str]) -> None:
        fresh = [text for text in facts if text not in self._returns]
        self._returns.update(fresh)
        self._view.returned(time, SOMEBODY, fresh)

    def _progress(self, time: float, cycles: List[RecordedCycle]) -> None:
        """Tell of cycles that have begun, and of what was decided in the last one."""
        number, plans, sent = self._told
        for cycle in cycles[number:]:
            plans, sent = 0, 0
            for update in cycle.updates:
                self._returned(time, _facts(update))
                self._view.update(time, str(update))
        if not cycles:
            return
        last = cycles[-1]
        for plan in last.plans[plans:]:
            self._view.plan(time, last.cycle, plan.horizon, plan.actions)
        if last.dispatched is not None and not sent:
            self._view.dispatched(time, last.dispatched)
        self._told = len(cycles), len(last.plans), len(last.dispatched or ())

    def _statuses(self, time: float, state: State) -> None:
        """Tell how goals stand, and how they ended."""
        goals = group(state, "goal")
        for key, goal in goals.items():
            state_now, waits = GoalState(goal["state"]), goal["waits"]
            if key in self._clients and self._clients[key].cancelled:
                state_now = TRANSITIONS.get((state_now, GoalEvent.CANCEL_REQUEST), state_now)
            if self._states.get(key) != (state_now, waits):
                self._states[key] = state_now, waits
                self._view.feedback(time, key, "waiting: for its turn" if waits else state_now.value)
                self._view.status(time, key, _NUMBERS[state_now], "")
        present = group(state, "client")
        for key, client in self._clients.items():
            if key in self._ended or (client.ending is None and key in present):
                continue
            self._ended.add(key)
            if client.ending is None:
                self._view.status(time, key, _LOST, "how it ended is not in the journal")
            else:
                self._view.status(time, key, _NUMBERS[client.ending.state], client.ending.message)


def _facts(update: StreamUpdate) -> List[str]:
    """Return what an update states that came from outside: returns first, then other facts."""
    heads = [one.head for one in update.items if isinstance(one, Statement) and one.head is not None]
    told = [head for head in heads if not is_keyword(head, REQUEST)]
    return [str(head) for head in sorted(told, key=lambda head: not is_keyword(head, RETURN))]
