"""A run as it was recorded: its program and, cycle by cycle, its input and its decisions.

A :class:`RunCollector` puts it together from the events of the run.
"""

import json
import os
import re
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

import clingo

from rosoclingo.oclingo import OclingoError, ProgramError, ReactiveProgram, StreamUpdate, parse_update
from rosoclingo.oclingo.program.sources import Source
from rosoclingo.oclingo.progression.updates import Anew
from rosoclingo.planning.history import AcceptedUpdate, Checkpoint, History
from rosoclingo.runs.events import RunEvents
from rosoclingo.runs.topic_atoms import action_in

#: The form of what :meth:`RunProgram.text` writes.
FORMAT = 1

_CYCLE = re.compile(r"cycle (\d+): ")


class RecordingError(RuntimeError):
    """A recording that cannot be read or replayed; the text says what is wrong with it and what to do."""


class ProgramFile(NamedTuple):
    """A text of a program; ``included`` where another one names it."""

    name: str
    text: str
    included: bool


@dataclass(frozen=True)
class RunProgram:
    """The program of a run, whole, and what else its decisions depend on.

    Attributes:
        run: what no other run has; a core that goes on with an earlier run has that one's.
        files: all texts in order, those that others include as well.
        constants: the values of ``#const`` names, as text.
        fingerprint: see :attr:`ReactiveProgram.fingerprint`.
        settings: the core's parameters by name.
        clingo_version: that of the core.

    """

    run: str
    files: Tuple[ProgramFile, ...]
    constants: Dict[str, str]
    fingerprint: str
    settings: Dict[str, Any] = field(default_factory=dict)
    clingo_version: str = ""

    @classmethod
    def of(cls, run: str, program: ReactiveProgram, settings: Mapping[str, Any]) -> "RunProgram":
        """Return what is to be kept of a loaded program."""
        files = tuple(ProgramFile(one.name, one.text, one not in program.sources) for one in program.texts)
        constants = {name: str(value) for name, value in program.constants.items()}
        return cls(run, files, constants, program.fingerprint, dict(settings), ".".join(map(str, clingo.version())))

    def text(self) -> str:
        """Return it as JSON."""
        return json.dumps({"format": FORMAT, **asdict(self)})

    @classmethod
    def parse(cls, text: str) -> "RunProgram":
        """Return what :meth:`text` wrote; raises RecordingError."""
        try:
            values = json.loads(text)
            form = values.pop("format")
            if form != FORMAT:
                version = "a later" if form > FORMAT else "another"
                raise RecordingError(f"its program has format {form}: replay it with {version} version of rosoclingo")
            return cls(**{**values, "files": tuple(ProgramFile(*one) for one in values["files"])})
        except (ValueError, TypeError, KeyError, AttributeError) as error:
            raise RecordingError(f"its program is damaged: {error}; take another copy of the recording") from None

    def load(self) -> ReactiveProgram:
        """Return the program; raises RecordingError."""
        sources = [Source(one.name, one.text) for one in self.files]
        try:
            program = ReactiveProgram(sources, self.constants, whole=True)
        except ProgramError as error:
            raise RecordingError(f"its program cannot be used: {error}") from None
        if program.fingerprint != self.fingerprint:
            raise RecordingError("its program is not that of the run: the recording was changed; take another copy")
        return program

    @property
    def plan_time(self) -> Optional[float]:
        """Seconds of processor time for a shorter plan than the first; None where each plan was to be shortest."""
        return None if self.settings.get("plan") == "shortest" else float(self.settings.get("plan_time", 1.0))

    def write(self, folder: Path) -> List[str]:
        """Write the files into ``folder``, as they lay to each other; return the arguments of ``oclingo`` for them."""
        paths = _apart([one.name for one in self.files])
        for path, one in zip(paths, self.files):
            (folder / path).parent.mkdir(parents=True, exist_ok=True)
            (folder / path).write_text(one.text, encoding="utf-8")
        words = [str(folder / path) for path, one in zip(paths, self.files) if not one.included]
        return [*(f"-c {name}={value}" for name, value in sorted(self.constants.items())), *words]


def _apart(names: Sequence[str]) -> List[Path]:
    """Return where files of these names go in a folder: paths below their common folder, other names at its top."""
    folders = [str(Path(name).absolute().parent) for name in names if "/" in name]
    shared = os.path.commonpath(folders) if folders else "/"
    return [
        Path(name).absolute().relative_to(shared) if "/" in name else Path(re.sub(r"\W", "", name) + ".lp")
        for name in names
    ]


class RecordedPlan(NamedTuple):
    """A published plan: its actions from its cycle on, none without a plan, and the last step ground."""

    horizon: int
    actions: Tuple[str, ...]


@dataclass
class RecordedCycle:
    """What led to a cycle, and what was decided.

    Attributes:
        cycle: its number.
        updates: the solver's updates, one unless the program begins again.
        plans: the published plans, in order; the last one counts.
        dispatched: the actions that went out, None where that is not known.
        problems: the problems in the core's log.

    """

    cycle: int
    updates: List[StreamUpdate] = field(default_factory=list)
    plans: List[RecordedPlan] = field(default_factory=list)
    dispatched: Optional[List[str]] = None
    problems: List[str] = field(default_factory=list)


@dataclass
class RecordedRun:
    """A run: its program, None where that was not recorded, and its cycles in order.

    ``start`` is what the solver had taken before the first of them, None where the run begins with it.
    """

    program: Optional[RunProgram] = None
    cycles: List[RecordedCycle] = field(default_factory=list)
    start: Optional[History] = None

    @property
    def stream(self) -> str:
        """The online progression, for ``oclingo --shortest --stream``; raises RecordingError where it is not whole."""
        before = [] if self.start is None else self.start.entries
        if any(isinstance(entry, Checkpoint) for entry in before):
            raise RecordingError(
                f"what came before cycle {self.cycles[0].cycle} is in it as a state alone, of which there is no stream:"
                " take a bag of the run (record:=true)"
            )
        taken = [entry.update for entry in before if isinstance(entry, AcceptedUpdate) and entry.update is not None]
        updates = [update for one in self.cycles for update in one.updates]
        first = {one.step: one for one in taken if (one.step or 1) < (updates[0].step or 1)}  # in force is the last
        return "\n".join(map(str, [*first.values(), *updates]))


class _Open:
    """A run of which more may come: cycles by number, since topics overtake each other."""

    def __init__(self, program: Optional[RunProgram] = None, start: Optional[History] = None, latest: int = 0) -> None:
        self.program, self.start, self.latest = program, start, latest
        self._leading: List[StreamUpdate] = []  # of a program that begins again, up to the present cycle
        self.last: Optional[RecordedCycle] = None  # whose plan came last of all
        self._cycles: Dict[int, RecordedCycle] = {}

    def at(self, cycle: int) -> RecordedCycle:
        """What is known of a cycle."""
        self.last = None
        return self._cycles.setdefault(cycle, RecordedCycle(cycle))

    def update(self, update: StreamUpdate) -> None:
        """Take an update; a program that begins again passes through the earlier cycles in a few of them."""
        step = update.step or 1
        self._leading.append(update)
        if step > self.latest:
            self.latest = step
            self.at(step).updates += self._leading
            self._leading = []

    def close(self) -> RecordedRun:
        """The run; raises RecordingError where updates are lacking."""
        cycles = [self._cycles[number] for number in sorted(self._cycles) if self._cycles[number].updates]
        first = 1 if self.start is None or not cycles else cycles[0].cycle
        for expected, one in enumerate(cycles, first):
            if one.cycle != expected:
                raise RecordingError(_lacking(expected, one.cycle - 1))
        return RecordedRun(self.program, cycles, self.start)


def _lacking(first: int, last: int) -> str:
    cycles = f"cycle {first}" if first == last else f"cycles {first} to {last}"
    mend = "let the recorder begin before the first request (record:=true)" if first == 1 else "see its notes"
    return f"the updates of {cycles} are lacking, without which the others cannot be solved again: {mend}"


class RunCollector(RunEvents):
    """Puts runs together from their events; each can raise RecordingError.

    Topics may overtake each other, but each is in order itself. A core that is started again begins another run.
    """

    def __init__(self, start: Optional[History] = None, latest: int = 0) -> None:
        """Begin before the first cycle, or with a history after the update of the cycle ``latest``."""
        self._runs: List[_Open] = [] if start is None else [_Open(start=start, latest=latest)]

    def program(self, time: float, text: str) -> None:
        """Take what a core said of its program when it began."""
        found = RunProgram.parse(text)
        if self._runs and self._runs[-1].program is not None and self._runs[-1].program.run == found.run:
            return
        if (
            self._runs
            and self._runs[-1].program is None
            and (self._runs[-1].start is not None or not self._runs[-1].latest)
        ):
            self._runs[-1].program = found
            return
        self._begin(found)

    def update(self, time: float, text: str) -> None:
        """Take an update that was in force."""
        try:
            update = parse_update(text)
        except OclingoError as error:
            raise RecordingError(f"an update is damaged: {error}; take another copy of the recording") from None
        if update.step == 1 and self._run.latest and Anew() not in update.items:
            self._begin()
        self._run.update(update)

    def plan(
        self, time: float, cycle: int, horizon: int, actions: Sequence[str], times: Optional[Tuple[float, float]] = None
    ) -> None:
        """Take a published plan, with the last actions done."""
        ahead = tuple(text for text in actions if _cycle_of(text) >= cycle)
        found = self._run.at(cycle)
        found.plans.append(RecordedPlan(horizon, ahead))
        self._run.last = found

    def dispatched(self, time: float, facts: Sequence[str]) -> None:
        """Take what went out to the interfaces; what is no action is passed over."""
        for text in facts:
            cycle = _cycle_of(text)
            if cycle:
                one = self._run.at(cycle)
                known = one.dispatched or []
                one.dispatched = known if text in known else [*known, text]

    def problem(self, time: float, cycle: int, text: str) -> None:
        """Take a problem from the core's log."""
        if self._runs:
            self._run.at(cycle).problems.append(text)

    def runs(self) -> List[RecordedRun]:
        """Return the runs with updates, in order; raises RecordingError where there is none."""
        found = [one for one in (run.close() for run in self._runs) if one.cycles]
        if not found:
            raise RecordingError(
                "no update of a core is in it: nobody has asked for anything, or the recorder was not connected"
            )
        return found

    def _begin(self, program: Optional[RunProgram] = None) -> None:
        """Begin another run; the plan that a core tells as it begins may have come before."""
        early = self._runs[-1].last if self._runs else None
        if early is not None and early.cycle == 1 and not early.plans[-1].actions:
            early.plans.pop()
        self._runs.append(_Open(program))

    @property
    def _run(self) -> _Open:
        if not self._runs:
            self._runs.append(_Open())
        return self._runs[-1]


def problem_in(text: str) -> Tuple[Optional[int], str]:
    """Return the cycle with which a line of the core's log begins, None where it does not, and the rest."""
    found = _CYCLE.match(text)
    return (None, text) if found is None else (int(found.group(1)), text[found.end() :])


def _cycle_of(text: str) -> int:
    """Return the cycle of an action, 0 for anything else."""
    action = action_in(text)
    return 0 if action is None else action.cycle
