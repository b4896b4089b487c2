"""A recorded run: its program and, cycle by cycle, its input and its decisions.

A :class:`RunCollector` assembles it from the events of the run.
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
from rosoclingo.oclingo.progression.updates import CloseCycles, Reset
from rosoclingo.planning.history import AcceptedUpdate, Checkpoint, History, Plan
from rosoclingo.runs.topic_atoms import action_in, atom_in

#: The version of the format of :meth:`RunProgram.text`.
FORMAT = 1

_CYCLE = re.compile(r"cycle (\d+): ")


class RecordingError(RuntimeError):
    """A recording that cannot be read or replayed; the text has the fault and a solution."""


class ProgramFile(NamedTuple):
    """A text of a program; ``included`` if another text includes it."""

    name: str
    text: str
    included: bool


@dataclass(frozen=True)
class RunProgram:
    """The whole program of a run, and all parameters that affect its decisions.

    Attributes:
        run: the unique id of the run; a core that resumes a run keeps its id.
        files: all texts in order, including included texts.
        constants: the values of ``#const`` names, as text.
        fingerprint: see :attr:`ReactiveProgram.fingerprint`.
        settings: the core's parameters by name.
        clingo_version: the core's version of clingo.

    """

    run: str
    files: Tuple[ProgramFile, ...]
    constants: Dict[str, str]
    fingerprint: str
    settings: Dict[str, Any] = field(default_factory=dict)
    clingo_version: str = ""

    @classmethod
    def of(cls, run: str, program: ReactiveProgram, settings: Mapping[str, Any]) -> "RunProgram":
        """Return the record of a loaded program."""
        files = tuple(ProgramFile(one.name, one.text, one not in program.sources) for one in program.texts)
        constants = {name: str(value) for name, value in program.constants.items()}
        return cls(run, files, constants, program.fingerprint, dict(settings), ".".join(map(str, clingo.version())))

    def text(self) -> str:
        """Return the program as JSON."""
        return json.dumps({"format": FORMAT, **asdict(self)})

    @classmethod
    def parse(cls, text: str) -> "RunProgram":
        """Parse the result of :meth:`text`; raises RecordingError."""
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
        """Load the program; raises RecordingError."""
        sources = [Source(one.name, one.text) for one in self.files]
        try:
            program = ReactiveProgram(sources, self.constants, whole=True)
        except ProgramError as error:
            raise RecordingError(f"its program cannot be used: {error}") from None
        if program.fingerprint != self.fingerprint:
            raise RecordingError("its program was changed after the run: take another copy of the recording")
        return program

    @property
    def plan_time(self) -> Optional[float]:
        """Seconds of processor time to search for a shorter plan; None if each plan had to be the shortest."""
        return None if self.settings.get("plan") == "shortest" else float(self.settings.get("plan_time", 1.0))

    def write(self, folder: Path) -> List[str]:
        """Write the files into ``folder``, with their relative paths; return the arguments of ``oclingo`` for them."""
        paths = _apart([one.name for one in self.files])
        for path, one in zip(paths, self.files):
            (folder / path).parent.mkdir(parents=True, exist_ok=True)
            (folder / path).write_text(one.text, encoding="utf-8")
        words = [str(folder / path) for path, one in zip(paths, self.files) if not one.included]
        return [*(f"-c {name}={value}" for name, value in sorted(self.constants.items())), *words]


def _apart(names: Sequence[str]) -> List[Path]:
    """Return relative paths for files: paths are relative to their common folder, other names are at the top."""
    folders = [str(Path(name).absolute().parent) for name in names if "/" in name]
    shared = os.path.commonpath(folders) if folders else "/"
    return [
        Path(name).absolute().relative_to(shared) if "/" in name else Path(re.sub(r"\W", "", name) + ".lp")
        for name in names
    ]


@dataclass
class RecordedCycle:
    """The input and the decisions of one cycle.

    Attributes:
        cycle: its number.
        updates: the solver's updates; several only if the program restarts.
        plans: the published plans from this cycle on, in order; the last plan counts. One without actions is no plan.
        dispatched: the dispatched actions, None if unknown.
        problems: the problems in the core's log.

    """

    cycle: int
    updates: List[StreamUpdate] = field(default_factory=list)
    plans: List[Plan] = field(default_factory=list)
    dispatched: Optional[List[str]] = None
    problems: List[str] = field(default_factory=list)


@dataclass
class RecordedRun:
    """A run: its program, None if it was not recorded, and its cycles in order.

    ``start`` is the solver's history before the first cycle, None if the run begins with that cycle.
    """

    program: Optional[RunProgram] = None
    cycles: List[RecordedCycle] = field(default_factory=list)
    start: Optional[History] = None

    @property
    def stream(self) -> str:
        """The online progression, for ``oclingo --shortest --stream``; raises RecordingError if it is incomplete."""
        before = [] if self.start is None else self.start.entries
        if any(isinstance(entry, Checkpoint) for entry in before):
            raise RecordingError(
                f"the updates before cycle {self.cycles[0].cycle} are compacted to a checkpoint, which has no stream:"
                " use a bag of the run (record:=true)"
            )
        accepted = [entry.update for entry in before if isinstance(entry, AcceptedUpdate) and entry.update is not None]
        updates = [update for one in self.cycles for update in one.updates]
        first = {one.step: one for one in accepted if (one.step or 1) < (updates[0].step or 1)}  # the last of each step
        return "\n".join(map(str, [*first.values(), *updates]))


def _check(run: RecordedRun) -> None:
    """Raise RecordingError if updates are missing."""
    expected = 1 if run.start is None or not run.cycles else run.cycles[0].cycle
    for one in run.cycles:
        if one.cycle != expected and not _closes(one.updates[0], expected - 1):
            last = one.cycle - 1
            missing = f"cycle {last}" if expected == last else f"cycles {expected} to {last}"
            fix = "start the recorder before the first request (record:=true)" if expected == 1 else "see its notes"
            raise RecordingError(f"the updates of {missing} are missing, so later cycles cannot be replayed: {fix}")
        expected = one.cycle + 1


def _closes(update: StreamUpdate, cycle: int) -> bool:
    """Return whether an update closes a cycle: successive messages of an interface can skip cycles after it."""
    return any(isinstance(one, CloseCycles) and one.first <= cycle <= one.last for one in update.items)


class RunCollector:
    """Assembles runs from their events; the methods raise RecordingError.

    Each topic is in order, but different topics have no common order. A restarted core begins another run.
    """

    def __init__(self) -> None:
        self._runs: List[RecordedRun] = []
        self._begin()

    def _begin(self, program: Optional[RunProgram] = None) -> None:
        self._runs.append(RecordedRun(program))
        self._latest = 0  # the cycle of its last update
        self._cycles: Dict[int, RecordedCycle] = {}
        self._leading: List[StreamUpdate] = []  # updates of a restarted program, up to the present cycle

    def _at(self, cycle: int) -> RecordedCycle:
        """Return the record of a cycle of the last run."""
        if cycle not in self._cycles:
            self._cycles[cycle] = RecordedCycle(cycle)
            self._runs[-1].cycles.append(self._cycles[cycle])
        return self._cycles[cycle]

    def program(self, time: float, text: str) -> None:
        """Add the program of a core."""
        found, last = RunProgram.parse(text), self._runs[-1]
        if last.program is None and not self._latest:
            last.program = found
        elif last.program is None or last.program.run != found.run:
            self._begin(found)

    def resume(self, history: History, cycle: int) -> None:
        """Begin the run with the solver's history after the update of a cycle."""
        if history.entry is not None:
            self._runs[-1].start, self._latest = history, cycle

    def update(self, time: float, text: str) -> None:
        """Add an accepted update; a restarted program repeats earlier cycles in a few updates."""
        try:
            update = parse_update(text)
        except OclingoError as error:
            raise RecordingError(f"an update is damaged: {error}; take another copy of the recording") from None
        step = update.step or 1
        if update.step == 1 and self._latest and Reset() not in update.items:
            self._begin()
        self._leading.append(update)
        if step > self._latest:
            self._latest = step
            self._at(step).updates += self._leading
            self._leading = []

    def plan(
        self, time: float, cycle: int, horizon: int, actions: Sequence[str], times: Optional[Tuple[float, float]] = None
    ) -> None:
        """Add a published plan, without executed actions.

        An empty plan after another one is the first plan of a restarted core, whose program has not arrived yet.
        """
        plans = self._at(cycle).plans
        plan = Plan.from_atoms(filter(None, map(atom_in, actions)), horizon).rest(cycle)
        if plan.actions or not plans:
            plans.append(plan)

    def dispatched(self, time: float, facts: Sequence[str]) -> None:
        """Add dispatched actions; ignore other facts."""
        for text in facts:
            action = action_in(text)
            if action is not None:
                one = self._at(action.cycle)
                known = one.dispatched or []
                one.dispatched = known if text in known else [*known, text]

    def problem(self, time: float, cycle: int, text: str) -> None:
        """Add a problem from the core's log."""
        self._at(cycle).problems.append(text)

    def _ignore(self, *_event: Any) -> None:
        """Ignore an event that does not affect decisions."""

    begin = goals = cancel = returned = packages = beliefs = mode = pose = path = scan = floor = wall = clock = _ignore

    def runs(self) -> List[RecordedRun]:
        """Return the runs with updates, in order; raises RecordingError if there is none."""
        for run in self._runs:
            run.cycles = sorted((one for one in run.cycles if one.updates), key=lambda one: one.cycle)
            _check(run)
        found = [run for run in self._runs if run.cycles]
        if not found:
            why = "there was no request, or the recorder was not connected"
            raise RecordingError(f"it has no update of a core, so there is nothing to replay yet: {why}")
        return found


def problem_in(text: str) -> Tuple[Optional[int], str]:
    """Return the cycle at the beginning of a line of the core's log, None without one, and the rest."""
    found = _CYCLE.match(text)
    return (None, text) if found is None else (int(found.group(1)), text[found.end() :])
