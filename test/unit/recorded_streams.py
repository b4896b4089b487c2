"""Random streams with the answers of an earlier solver, which ``planning/test_recorded_streams.py`` compares.

``python3 test/unit/recorded_streams.py`` records the answers of the present solver to the stored streams.
"""

import gzip
import hashlib
import json
import time
from functools import lru_cache, partial
from typing import Any, Callable, Dict, FrozenSet, Iterator, List, Optional, Tuple

import clingo
from busy_driver import ERRANDS
from foreign_programs import SOUND
from shipped import DATA, shipped

from rosoclingo.oclingo import (
    ReactiveProgram,
    ReactiveSolver,
    SolveOutcome,
    SolveResult,
    StreamUpdate,
    parse_atom,
    parse_update,
)
from rosoclingo.planning.explaining.explainer import explain
from rosoclingo.planning.explaining.questions import Stream
from rosoclingo.planning.minimal_sets import UndecidedError
from rosoclingo.planning.solver import PlanSolver

STREAMS = DATA / "recorded_streams.jsonl.gz"
STEPS = 20  # the bound of each update
SECONDS = 5.0  # processor time for an explanation; longer ones are not recorded
LATE = "late"

Record = Dict[str, Any]


@lru_cache(maxsize=None)
def _of_text(text: str) -> ReactiveProgram:
    return ReactiveProgram.from_text(text)


#: Programs whose answers are plans; they execute the planned actions.
PLANNED: Dict[str, Callable[[], ReactiveProgram]] = {
    "mailbot": partial(shipped, "mailbot.lp", "office.lp"),
    "house": partial(shipped, "house.lp", "home.lp"),
    "paper": partial(shipped, "paper.lp"),
    "errands": partial(_of_text, ERRANDS),
    "golog": partial(shipped, "golog/elevator.golog"),
    "day": partial(shipped, "mailbot.lp", "office.lp", "golog/mailbot_day.golog"),
    **{name: partial(_of_text, text) for name, (text, _) in SOUND.items()},
}
#: Kinds of random programs with externals, windows, asserted terms and further horizons.
GENERAL = ("externals", "volatile", "loops", "aggregates", "optimisation")
KINDS = (*PLANNED, *GENERAL)


def solver_of(kind: str, program: ReactiveProgram) -> ReactiveSolver:
    """Return the solver that a kind of streams is recorded with."""
    if kind in PLANNED:
        return PlanSolver(program)
    return ReactiveSolver(program, models=1 if kind == "optimisation" else 0)


def reading(kind: str, result: SolveResult) -> List[Any]:
    """Return the compared values of a result: outcome, horizon, size or digest of the answers, warnings."""
    if kind in PLANNED:
        size: Any = sum(one.name == "_action_lib" for one in result.answers[0]) if result.answers else None
    elif kind == "optimisation":
        size = sum(one.name == "q" for one in result.answers[-1]) if result.answers else None
    else:
        answers = sorted(" ".join(sorted(map(str, answer))) for answer in result.answers)
        size = [len(answers), hashlib.sha256("\n".join(answers).encode()).hexdigest()[:12]]
    return [result.outcome.value, result.horizon, size, sorted(result.warnings)]


def program_of(record: Record) -> ReactiveProgram:
    """Return the program of a stored stream."""
    return PLANNED[record["kind"]]() if record["kind"] in PLANNED else _of_text(record["program"])


def play(record: Record) -> Iterator[List[Any]]:
    """Play the updates of a stored stream; yield the readings."""
    solver = solver_of(record["kind"], program_of(record))
    for update, *_ in record["updates"]:
        yield reading(record["kind"], solver.update(_update(update)))


def before_last(record: Record) -> Tuple[ReactiveSolver, StreamUpdate]:
    """Return a solver that has played all updates except the last, and the last update."""
    solver = solver_of(record["kind"], program_of(record))
    *before, last = [_update(update) for update, *_ in record["updates"]]
    for update in before:
        solver.update(update)
    return solver, last


def first_plans(record: Record) -> Iterator[Optional[int]]:
    """Yield the horizon of the first plan for each update, found without improving it."""
    solver = PlanSolver(program_of(record), plan_time=0.0)
    for update, *_ in record["updates"]:
        result = solver.update(_update(update))
        yield result.horizon if result.answers else None


def what_if(record: Record) -> List[Optional[bool]]:
    """Return for each set of disabled facts whether the last update would have an answer."""
    solver, last = before_last(record)
    assumable = _atoms(record["doubted"])
    return [solver.inquire(last, assumable, _atoms(disabled)).satisfiable for disabled in record["untold"]]


def why(record: Record) -> Any:
    """Return the number of conflicting rules for the last update: None for a plan, LATE after a timeout."""
    solver, last = before_last(record)
    end = time.process_time() + SECONDS
    try:
        found = explain(program_of(record), Stream(solver.log, last, STEPS), lambda: time.process_time() > end)
    except UndecidedError:
        return LATE
    if found is not None and not found.complete:
        return LATE
    return None if found is None else [len(found.rules), found.smallest]


def _update(text: str) -> StreamUpdate:
    return parse_update(text + " #endstep.")


def _atoms(texts: List[str]) -> FrozenSet[clingo.Symbol]:
    return frozenset(map(parse_atom, texts))


@lru_cache(maxsize=1)
def recorded() -> List[Record]:
    """Return the stored streams."""
    with gzip.open(STREAMS, "rt", encoding="utf-8") as file:
        return [json.loads(line) for line in file]


def record_again(record: Record) -> Record:
    """Return a stored stream with the answers of the present solver."""
    updates = [[update, *found] for (update, *_), found in zip(record["updates"], play(record))]
    again = {**record, "updates": updates}
    if record["kind"] in PLANNED:
        again.update(verdicts=what_if(record), first=list(first_plans(record)))
        found = why(record) if updates[-1][1] == SolveOutcome.UNSATISFIABLE.value else LATE
        again.pop("why", None)
        again.update({} if found == LATE else {"why": found})
    return again


def main() -> None:
    """Record the answers of the present solver to all stored streams."""
    lines = "".join(json.dumps(record_again(one)) + "\n" for one in recorded())
    STREAMS.write_bytes(gzip.compress(lines.encode("utf-8"), 9, mtime=0))


if __name__ == "__main__":
    main()
