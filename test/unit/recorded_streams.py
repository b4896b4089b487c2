"""Random streams with the answers of an earlier solver, which ``planning/test_recorded_streams.py`` compares.

A stream is generated from its kind and seed; planned actions are executed. The stored streams were recorded with an
earlier solver. ``python3 test/unit/recorded_streams.py KIND ...`` records the streams of these kinds again (default:
all).
"""

import gzip
import hashlib
import json
import sys
import time
from functools import lru_cache
from pathlib import Path
from random import Random
from typing import Any, Callable, Dict, FrozenSet, Iterator, List, NamedTuple, Optional, Tuple

import clingo
from busy_driver import ERRANDS
from foreign_programs import SOUND
from shipped import shipped

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

DATA = Path(__file__).resolve().parents[1] / "data" / "recorded_streams.jsonl.gz"
ALL = 1000
STEPS = 20  # the bound of each update
SECONDS = 5.0  # processor time for an explanation; longer ones are not recorded
LATE = "late"

Record = Dict[str, Any]


class Domain(NamedTuple):
    """A program whose answers are plans.

    Attributes:
        program: returns the reactive program.
        goal: returns a goal term, given the number of goals before it.
        facts: patterns of facts from outside; ``{}`` is the cycle.
        reasons: values with which actions fail.

    """

    program: Callable[[], ReactiveProgram]
    goal: Callable[[Random, int], str]
    facts: Tuple[str, ...]
    reasons: Tuple[str, ...] = ("failed", "blocked")


@lru_cache(maxsize=None)
def _of_text(text: str) -> ReactiveProgram:
    return ReactiveProgram.from_text(text)


def _foreign(name: str, *facts: str) -> Domain:
    return Domain(lambda: _of_text(SOUND[name][0]), lambda draw, _: draw.choice(SOUND[name][1]), facts)


def _mail(draw: Random, number: int) -> str:
    return f"goal(office{draw.randint(1, 4)},office{draw.randint(1, 4)},{number})"


ROOMS = ("hallway", "living_room", "kitchen", "bedroom", "bathroom", "study")
CALLS = ("control", "serve(2)", "go_floor(5)", "park", "serve_a_floor")
DOMAINS: Dict[str, Domain] = {
    "mailbot": Domain(
        lambda: shipped("mailbot.lp", "office.lp"),
        _mail,
        (
            *("_blocked(office1,office2,{})", "_blocked(office2,office3,{})", "_opened(office2,office3,{})"),
            *("_at(office3,{})", "_aboard(1,{})", "_lies(2,office1,{})", "_off(1,{})", "_lies(777,office2,{})"),
        ),
        ("failed", "blocked", "not_here", "not_at_label", "preempted"),
    ),
    "house": Domain(
        lambda: shipped("house.lp", "home.lp"),
        lambda draw, _: f"bring({draw.choice(ROOMS)},{draw.choice(('cup', 'tray', 'book'))})",
        ("_blocked(hallway,kitchen,{})", "_seen(cup,bathroom,{})", "_at(study,{})", "_lies(book,kitchen,{})"),
        ("failed", "blocked", "not_here"),
    ),
    "paper": Domain(lambda: shipped("paper.lp"), _mail, (), ("failed",)),
    "errands": Domain(
        lambda: _of_text(ERRANDS), lambda draw, n: f"do({draw.choice(('walk', 'walk', 'far', 'never'))},{n})", ()
    ),
    "golog": Domain(
        lambda: shipped("golog/elevator.golog"), lambda draw, n: f"run({draw.choice(CALLS)},{n})", ("_pressed(3,{})",)
    ),
    "day": Domain(
        lambda: shipped("mailbot.lp", "office.lp", "golog/mailbot_day.golog"),
        lambda draw, n: _mail(draw, n) if draw.random() < 0.6 else f"run({draw.choice(('day', 'morning_round'))},{n})",
        ("_low({})", "_hour(evening,{})", "_blocked(office2,office3,{})"),
    ),
    "vacuum": _foreign("vacuum", "_locked(2,{})"),
    "gripper": _foreign("gripper", "_slippery(red,{})"),
    "lift": _foreign("lift", "_held({})"),
    "patrol": _foreign("patrol", "_rain(gate,{})"),
}
GENERAL = ("externals", "volatile", "loops", "aggregates", "optimisation")
KINDS = (*DOMAINS, *GENERAL)


# ---- Playing ---------------------------------------------------------------------------------------------------------


def solver_of(kind: str, program: ReactiveProgram) -> ReactiveSolver:
    """Return the solver that a kind of streams is recorded with."""
    if kind in DOMAINS:
        return PlanSolver(program)
    return ReactiveSolver(program, models=1 if kind == "optimisation" else 0)


def reading(kind: str, result: SolveResult) -> List[Any]:
    """Return the compared values of a result: outcome, horizon, size or digest of the answers, warnings."""
    if kind in DOMAINS:
        size: Any = sum(one.name == "_action_lib" for one in result.answers[0]) if result.answers else None
    elif kind == "optimisation":
        size = sum(one.name == "q" for one in result.answers[-1]) if result.answers else None
    else:
        answers = sorted(" ".join(sorted(map(str, answer))) for answer in result.answers)
        size = [len(answers), hashlib.sha256("\n".join(answers).encode()).hexdigest()[:12]]
    return [result.outcome.value, result.horizon, size, sorted(result.warnings)]


def program_of(record: Record) -> ReactiveProgram:
    """Return the program of a stored stream."""
    return DOMAINS[record["kind"]].program() if record["kind"] in DOMAINS else _of_text(record["program"])


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


# ---- Generating ------------------------------------------------------------------------------------------------------


class Planned:
    """A stream of requests, cancels, returns and facts for a domain; planned actions are executed."""

    def __init__(self, kind: str, seed: int) -> None:
        self.kind, self.domain, self.draw = kind, DOMAINS[kind], Random(f"{kind} {seed}")
        self.solver = solver_of(kind, self.domain.program())
        self.step, self.goals, self.live, self.facts = 0, 0, [], []  # type: int, int, List[str], List[str]

    def record(self) -> Record:
        """Return the stream with its answers."""
        updates: List[List[Any]] = []
        items: List[str] = []
        for _ in range(self.draw.randint(4, 9)):
            items += self.events()
            self.step += 1
            text = f"#step {self.step} : {STEPS}. " + " ".join(f"{item}." for item in items)
            result = self.solver.update(_update(text))
            updates.append([text, *reading(self.kind, result)])
            items = self.outcomes(result)
            if result.outcome is not SolveOutcome.SATISFIABLE and self.draw.random() < 0.5:
                break
        record: Record = {"kind": self.kind, "updates": updates}
        reported = [*self.facts, *(item for item in updates[-1][0][:-1].split(". ") if item.startswith("_"))]
        record["doubted"] = sorted(set(self.draw.sample(reported, min(len(reported), 6))))
        some = [self.draw.sample(record["doubted"], self.draw.randint(0, len(record["doubted"]))) for _ in range(3)]
        record["untold"] = [record["doubted"], *some]
        record["verdicts"] = what_if(record)
        if updates[-1][1] == SolveOutcome.UNSATISFIABLE.value:
            found = why(record)
            if found != LATE:
                record["why"] = found
        record["first"] = list(first_plans(record))
        return record

    def events(self) -> List[str]:
        """Draw the facts that arrive before the next update."""
        draw, step, found = self.draw, self.step + 1, []
        for _ in range(draw.choice((0, 0, 1, 1, 2))):
            self.goals += 1
            goal = self.domain.goal(draw, self.goals)
            self.live.append(goal)
            found.append(f"_request({goal},{step + 1})")
        if self.live and draw.random() < 0.15:
            found.append(f"_request(cancel({parse_atom(draw.choice(self.live)).arguments[-1]}),{step})")
        for _ in range(draw.choice((0, 0, 0, 1, 2)) if self.domain.facts else 0):
            cycle = max(0, step - 1 + draw.choice((0, 0, 0, -1, -2, 1, 3)))
            found.append(draw.choice(self.domain.facts).format(cycle))
        self.facts += [one for one in found if not one.startswith("_request(cancel")]
        return found

    def outcomes(self, result: SolveResult) -> List[str]:
        """Return the commitments and returns of the executed actions of an answer."""
        found = [f"#closed {self.step}"]
        for action in sorted(result.answers[0] if result.answers else ()):
            if action.name == "_action_lib" and action.arguments[2].number == self.step:
                name, what, _ = action.arguments
                value = self.draw.choice(self.domain.reasons) if self.draw.random() < 0.2 else what
                found += [f":- not {action}", f"_return({name},{value},{self.step})"]
                self.facts.append(found[-1])
        return found


BODY = ("a", "b", "p(t)", "p(t-1)", "c(t-1)", "e(t)", "e(t-1)", "f(x,t)", "f(y,t)", "g(x,t)", "d(t)", "w(t-1)")
RULES = {
    "externals": ("h(Z,t) :- g(Z,t).", "h(Z,t) :- h(Z,t-1), not p(t).", "c(t) :- g(Z,U), U <= t."),
    "volatile": ("#volatile t : 2. :- w(t). #cumulative t.", "#volatile t : 3. v(t). :- p(t), v(t). #cumulative t."),
    "loops": ("r(t) :- r(t-1). r(t) :- s(t), not a. s(t) :- r(t), e(t).", "s(t) :- s(t+1), p(t). s(t) :- g(x,t)."),
    "aggregates": ("n(t) :- 2 { g(Z,t) ; f(x,t) }.", "m(S,t) :- S = #count { p(T) : p(T), T <= t, T = t-1..t }."),
    "optimisation": ("{ q(t) }. #minimize { 1,t : q(t) }. :- c(t), not q(t).",),
}


class General:
    """A random reactive program and stream with externals, windows, asserted terms, and further horizons."""

    def __init__(self, kind: str, seed: int) -> None:
        self.kind, self.draw = kind, Random(f"{kind} {seed}")

    def record(self) -> Record:
        """Return the stream with its answers."""
        record: Record = {"kind": self.kind, "program": self._program()}
        solver, updates = solver_of(self.kind, _of_text(record["program"])), []  # type: ReactiveSolver, List[List[Any]]
        step = 0
        for _ in range(self.draw.randint(2, 5)):
            step = max(1, min(5, step + self.draw.choice((0, 1, 1, 2))))
            text = f"#step {step} : {self.draw.randint(0, 2)}. " + " ".join(self._items())
            updates.append([text, *reading(self.kind, solver.update(_update(text)))])
        record["updates"] = updates
        return record

    def _body(self, *more: str) -> str:
        atoms = self.draw.sample((*BODY, *more), self.draw.randint(1, 3))
        return ", ".join(self.draw.choice(("", "not ")) + atom for atom in atoms)

    def _program(self) -> str:
        lines = ["#base.", "{ a }. { b }.", "#cumulative t.", "#external e(t). #external f(x,t). #external f(y,t)."]
        lines += ["#external g/2.", "{ p(t) }.", *RULES[self.kind]]
        for head in self.draw.sample(("c(t)", "d(t)", "w(t)", "d(t)", ""), 3):
            lines.append(f"{head} :- {self._body()}.")
        lines += [
            "#volatile t.",
            self.draw.choice((":- w(t), p(t).", ":- not p(t), not e(t).", f":- p(t), {self._body('c(t)')}.")),
        ]
        return "\n".join(lines) + "\n"

    def _items(self) -> List[str]:
        draw = self.draw
        heads = [f"e({step})" for step in range(1, 6)] + [f"f(x,{step})" for step in range(1, 6)]
        heads += [f"g({name},{step})" for name in "xyz" for step in range(1, 6)]
        found = []
        for _ in range(draw.randint(0, 4)):
            found.append(
                draw.choice(
                    (
                        *(draw.choice(heads) + ".",) * 4,
                        f"{draw.choice(heads)} :- {draw.choice(heads)}, not p({draw.randint(1, 5)}).",
                        f":- {draw.choice(heads)}, p({draw.randint(1, 5)}).",
                        *("#volatile.", "#volatile : 2.", "#cumulative.", "#assert : x.", "#retract : x."),
                        f"#forget {draw.randint(1, 3)}..{draw.randint(3, 5)}.",
                    )
                )
            )
        return found


def generate(number: int) -> Record:
    """Return stream ``number``, with the answers of the present solver."""
    kind = KINDS[number % len(KINDS)]
    return (Planned if kind in DOMAINS else General)(kind, number // len(KINDS)).record()


@lru_cache(maxsize=1)
def recorded() -> List[Record]:
    """Return the stored streams."""
    with gzip.open(DATA, "rt", encoding="utf-8") as file:
        return [json.loads(line) for line in file]


def main() -> None:
    """Record the streams of the named kinds again, by default of all kinds."""
    kinds = sys.argv[1:] or KINDS
    kept = recorded() if sys.argv[1:] else []
    records = [generate(number) if KINDS[number % len(KINDS)] in kinds else kept[number] for number in range(ALL)]
    lines = "".join(json.dumps(record) + "\n" for record in records)
    DATA.write_bytes(gzip.compress(lines.encode("utf-8"), 9, mtime=0))


if __name__ == "__main__":
    main()
