"""Verifies a program: explores its streams up to a depth, and reports defects and the proven depth."""

import time
from typing import Any, Dict, FrozenSet, List, NamedTuple, Tuple

from rosoclingo.checking.verifying.defects import Defect
from rosoclingo.checking.verifying.likely_events import likely_repertory
from rosoclingo.checking.verifying.moves import Repertory
from rosoclingo.checking.verifying.scope import SECONDS, DefectKind, EventSelection, VerifyLimits
from rosoclingo.checking.verifying.stream_search import StreamSearch, VerifyProgress
from rosoclingo.oclingo.errors import SolverError
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.planning.explaining.explainer import explain
from rosoclingo.planning.minimal_sets import UndecidedError
from rosoclingo.planning.question import Stop


class Verification(NamedTuple):
    """The result of a verification.

    Attributes:
        defects: the defects, that with the shortest run first.
        progress: the progress of the search.
        repertory: the possible events.
        limits: the limits of the search.
        seconds: the processor time of the search.

    """

    defects: Tuple[Defect, ...]
    progress: VerifyProgress
    repertory: Repertory
    limits: VerifyLimits
    seconds: float

    @property
    def clean(self) -> bool:
        """Whether all streams up to the depth were explored without a defect."""
        return not self.defects and self.progress.proven >= self.limits.events

    def text(self) -> str:
        """Return the defects with their streams, the proven depth, and the bounds."""
        lines = [line for one in self.defects for line in (*one.lines(), "")]
        proven, spent = self.progress.proven, f"{self.progress.states} states, {self.seconds:.1f} s"
        so_far = f"clean to depth {proven}" if proven >= 0 else ""
        if self.clean:
            lines.append(f"{so_far}: {spent}")
        elif self.defects:
            lines.append(f"{len(self.defects)} found{so_far and '; '}{so_far}: {spent}")
        else:
            lines.append(f"stopped in depth {proven + 1} after {spent}: {so_far or 'nothing is proven'}")
        return "\n".join([*lines, *self._bounds()]) + "\n"

    def _bounds(self) -> List[str]:
        one, limits = self.repertory, self.limits
        facts = " ".join(map(str, one.facts)) or "none"
        reasons = "; ".join(f"{name}: {' '.join(map(str, values))}" for name, values in sorted(one.reasons.items()))
        plans = "all shortest ones" if limits.all_plans else "only those that the solver finds"
        return [
            f"  depth: events of a stream (goals, cancels, facts, failures), at most {limits.together} between two "
            "updates; successful returns do not count",
            f"  goals: {' '.join(map(str, one.goals)) or 'none'}",
            f"  facts: {facts}" + (f"; up to {limits.late} cycles late, {limits.early} early" if one.facts else ""),
            f"  reasons: {reasons or 'none'}; and the parameter of another action",
            f"  plans: at most {limits.steps} steps, {plans}",
        ]

    def to_message(self) -> Dict[str, Any]:
        """Return the result as a value for JSON."""
        one = self.repertory
        return {
            "clean": self.clean,
            "depth": self.limits.events,
            **self.progress._asdict(),
            "seconds": round(self.seconds, 2),
            "limits": self.limits._asdict(),
            "goals": [*map(str, one.goals)],
            "facts": [*map(str, one.facts)],
            "reasons": {name: [*map(str, values)] for name, values in one.reasons.items()},
            "faults": [defect.to_message() for defect in self.defects],
        }


def verify(
    program: ReactiveProgram,
    selection: EventSelection,
    limits: VerifyLimits,
    seconds: float = SECONDS,
    skipped: FrozenSet[DefectKind] = frozenset(),
) -> Verification:
    """Verify a program for ``seconds`` of processor time, ignoring ``skipped`` kinds of defects.

    Raises SolverError, and RuntimeError from clingo.
    """
    begin = time.process_time()
    repertory = likely_repertory(program, selection)
    search = StreamSearch(program, repertory, limits, lambda: time.process_time() - begin >= seconds, skipped)
    progress = search.run()
    end = time.process_time()
    defects = (_explained(program, one, lambda: time.process_time() - end >= seconds) for one in search.defects)
    return Verification(tuple(defects), progress, repertory, limits, end - begin)


def _explained(program: ReactiveProgram, defect: Defect, halt: Stop) -> Defect:
    try:
        return defect if defect.broken is None else defect._replace(why=explain(program, defect.broken, halt))
    except (SolverError, UndecidedError):
        return defect
