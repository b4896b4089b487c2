"""A run out of a core's journal, as far as that goes back: now and then it begins again with the state alone.

The updates of a cycle are in the solver's log; the decisions are the plan, and the actions that went out.
"""

from dataclasses import replace
from pathlib import Path
from typing import Iterator, List, Optional, Set, Tuple

from rosoclingo.oclingo import StreamUpdate
from rosoclingo.oclingo.progression.updates import Anew
from rosoclingo.planning.history import AcceptedUpdate, entry_from_message
from rosoclingo.reasoning.journal.database import Header, JournalError, Moment, State, history
from rosoclingo.reasoning.records import actions_of, group, log_of, plan_of
from rosoclingo.runs.recorded_run import RecordedCycle, RecordedPlan, RecordedRun, RecordingError, RunProgram


def journal_run(file: Path) -> RecordedRun:
    """Return the run in a journal; raises RecordingError with the record that is damaged, and OSError."""
    header, moments = journal_history(file)
    program = program_of(header)
    begin, _ = next(moments)
    start, reader = log_of(begin) if group(begin, "log") else None, JournalReader(begin)
    for state, _ in moments:
        reader.take(state)
    if not reader.cycles:
        raise RecordingError("nothing was done since it began with the whole state: there is nothing to replay yet")
    return RecordedRun(program, reader.cycles, start)


def journal_history(file: Path) -> Tuple[Header, Iterator[Moment]]:
    """As :func:`history`; raises RecordingError, OSError."""
    try:
        return history(file)
    except JournalError as error:
        raise RecordingError(f"{error}; take another copy of the journal") from None


def program_of(header: Header) -> Optional[RunProgram]:
    """Return the program of a journal's run, None where there is none in it; raises RecordingError."""
    return replace(RunProgram.parse(header.description), run=header.run) if header.description else None


class JournalReader:
    """Goes through the states; ``cycles`` are those whose update came after the first record."""

    def __init__(self, start: State) -> None:
        self.cycles: List[RecordedCycle] = []
        self._known: Set[str] = set(group(start, "log"))
        self._plan: object = None
        self._taken: List[StreamUpdate] = []  # since an update was told
        self._told = _told(start)

    def take(self, state: State) -> None:
        """Take the state after a further record."""
        self._taken += self._new_updates(state)
        if _told(state) > self._told:
            self.cycles.append(RecordedCycle(_told(state), self._in_force()))
            self._told, self._taken, self._plan = _told(state), [], None
        if self.cycles and state["core"]["step"] == self._told:  # else an update was dropped, and its cycle comes again
            self._note(self.cycles[-1], state)

    def _new_updates(self, state: State) -> List[StreamUpdate]:
        entries = {name: value for name, value in group(state, "log").items() if name not in self._known}
        self._known.update(entries)
        taken = (entry_from_message(value) for value in entries.values() if value["do"] == "update")
        return [one.update for one in taken if isinstance(one, AcceptedUpdate) and one.update is not None]

    def _in_force(self) -> List[StreamUpdate]:
        """Of several updates of one step the last; one that begins anew goes through the cycles before."""
        anew = [number for number, update in enumerate(self._taken) if Anew() in update.items]
        if anew:
            return self._taken[anew[-1] :]
        return list({one.step: one for one in self._taken if (one.step or 1) > self._told}.values())

    def _note(self, cycle: RecordedCycle, state: State) -> None:
        """Note what was decided; a plan that was made shorter while actions ran comes behind the one before."""
        plan = state["plan"]
        if plan is not None and plan != self._plan:
            self._plan = plan
            actions = [str(one.atom) for one in plan_of(plan).actions if one.cycle >= cycle.cycle]
            cycle.plans.append(RecordedPlan(horizon_of(state), tuple(actions)))
        dispatch = state["dispatch"]
        if dispatch is not None and dispatch["cycle"] == cycle.cycle:
            cycle.dispatched = [str(one.atom) for one in actions_of(dispatch["actions"])]


def _told(state: State) -> int:
    """The cycle whose update was told last."""
    return int(state["core"]["told"])


def horizon_of(state: State) -> int:
    """Return the horizon of the plan in force, of the last search if there is none."""
    entries = list(group(state, "log").values())
    plans = [one for one in entries if one["do"] == "adopt"]
    return int((plans or [one for one in entries if one["do"] == "update"])[-1]["horizon"])
