"""Verifies a program: all ways up to a depth, what was found on them, in words, and how far it is proven."""

import time
from typing import Any, Callable, Dict, FrozenSet, List, NamedTuple, Optional, Tuple

from rosoclingo.checking.verifying.findings import Finding
from rosoclingo.checking.verifying.likely_events import likely_repertory
from rosoclingo.checking.verifying.moves import Repertory
from rosoclingo.checking.verifying.scope import SECONDS, Kind, Limits, Wanted
from rosoclingo.checking.verifying.stream_search import Progress, Search
from rosoclingo.oclingo.errors import SolverError
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.planning.explaining.explainer import explain
from rosoclingo.planning.explaining.why_not import WhyNot
from rosoclingo.planning.minimal_sets import UndecidedError


class Fault(NamedTuple):
    """A finding, and which rules forbid an answer, where there is none and that is known."""

    finding: Finding
    why: Optional[WhyNot] = None

    def lines(self) -> List[str]:
        """Return it for people."""
        found = [f"{self.finding.kind.value}: {self.finding.words}", *(f"  {one}" for one in self.finding.story)]
        if self.why is not None:
            found += [f"  {one}" for one in self.why.text().splitlines()]
        comments = [f"% {one}" for one in (self.finding.words, *self.finding.story)]
        return [*found, "", *comments, *self.finding.stream.splitlines()]


class Verdict(NamedTuple):
    """What came of a verification.

    Attributes:
        faults: what is wrong, the shortest way first.
        progress: how far the search came.
        repertory: what could come.
        limits: what was tried.
        seconds: of processor time.

    """

    faults: Tuple[Fault, ...]
    progress: Progress
    repertory: Repertory
    limits: Limits
    seconds: float

    @property
    def clean(self) -> bool:
        """Whether nothing was found up to the whole depth."""
        return not self.faults and self.progress.proven >= self.limits.events

    def text(self) -> str:
        """Return it for people: each fault with its stream, and in the end what is proven, within which bounds."""
        lines = [line for one in self.faults for line in (*one.lines(), "")]
        proven, told = self.progress.proven, f"{self.progress.states} states, {self.seconds:.1f} s"
        if self.clean:
            lines.append(f"clean to depth {proven}: {told}")
        elif self.faults:
            rest = f"; clean to depth {proven}" if proven >= 0 else ""
            lines.append(f"{len(self.faults)} found{rest}: {told}")
        else:
            so_far = f"clean to depth {proven}" if proven >= 0 else "nothing is proven"
            lines.append(f"stopped in depth {proven + 1} after {told}: {so_far}")
        return "\n".join([*lines, *self._bounds()]) + "\n"

    def _bounds(self) -> List[str]:
        """Return within which bounds that is so."""
        one, limits = self.repertory, self.limits
        facts = " ".join(map(str, one.facts)) if one.facts else "none"
        reasons = "; ".join(f"{name}: {' '.join(map(str, values))}" for name, values in sorted(one.reasons.items()))
        plans = (
            "whichever of the shortest plans is taken" if limits.all_plans else "with the plans that the solver finds"
        )
        return [
            f"  depth: events of a stream (goals, cancels, facts, failures), {limits.together} at most between two "
            "updates; what goes as planned counts for nothing",
            f"  goals: {' '.join(map(str, one.goals)) or 'none'}",
            f"  facts: {facts}" + (f"; up to {limits.late} cycles late, {limits.early} early" if one.facts else ""),
            f"  reasons: {reasons or 'none'}; and what another action is about",
            f"  plans of at most {limits.steps} steps, {plans}",
        ]

    def to_message(self) -> Dict[str, Any]:
        """Return it as a plain value that JSON knows."""
        one = self.repertory
        return {
            "clean": self.clean,
            "depth": self.limits.events,
            "proven": self.progress.proven,
            "states": self.progress.states,
            "moves": self.progress.moves,
            "seconds": round(self.seconds, 2),
            "limits": self.limits._asdict(),
            "goals": [*map(str, one.goals)],
            "facts": [*map(str, one.facts)],
            "reasons": {name: [*map(str, values)] for name, values in one.reasons.items()},
            "faults": [fault.finding.to_message() for fault in self.faults],
        }


def verify(
    program: ReactiveProgram,
    wanted: Optional[Wanted] = None,
    limits: Optional[Limits] = None,
    seconds: float = SECONDS,
    skipped: FrozenSet[Kind] = frozenset(),
    clock: Callable[[], float] = time.process_time,
) -> Verdict:
    """Verify a program for ``seconds`` of the ``clock``; raises RuntimeError as clingo does, and SolverError.

    Findings of kinds that are ``skipped`` are none.
    """
    wanted, limits = wanted or Wanted(), limits or Limits()
    begin = clock()
    repertory = likely_repertory(program, wanted)
    search = Search(program, repertory, limits, lambda: clock() - begin >= seconds, skipped)
    progress = search.run()
    spent = clock() - begin
    late = clock()
    faults = [Fault(one, _why(program, one, lambda: clock() - late >= seconds)) for one in search.findings]
    return Verdict(tuple(faults), progress, repertory, limits, spent)


def _why(program: ReactiveProgram, finding: Finding, halt: Callable[[], bool]) -> Optional[WhyNot]:
    if finding.broken is None:
        return None
    try:
        return explain(program, finding.broken, halt)
    except (SolverError, UndecidedError):
        return None
