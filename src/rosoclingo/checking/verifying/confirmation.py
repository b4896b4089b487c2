"""Goes a way that was found once more, with the solver that cores have: what was found is so for them, too."""

from typing import Callable, Dict, FrozenSet, List, NamedTuple, Optional, Sequence, Tuple

import clingo

from rosoclingo.checking.verifying.findings import Finding
from rosoclingo.checking.verifying.scope import Kind, Limits
from rosoclingo.checking.verifying.trial_core import NO_ANSWER, BrokenError, TrialCore
from rosoclingo.oclingo.errors import SolverError
from rosoclingo.oclingo.program.action_rules import is_action_of
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.updates import Literal, Statement, StreamUpdate, Volatile, commitment
from rosoclingo.oclingo.solving.results import SolveResult
from rosoclingo.planning.explaining.explainer import explain
from rosoclingo.planning.explaining.why_not import WhyNot
from rosoclingo.planning.history import AcceptedUpdate, Plan
from rosoclingo.planning.minimal_sets import UndecidedError
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.reasoning.settings import CoreSettings

Chosen = Dict[int, FrozenSet[clingo.Symbol]]
"""The actions of a step that a plan is to begin with."""


class Confirmation(NamedTuple):
    """What came of a way with the solver that cores have.

    Attributes:
        holds: whether it is as it was found.
        updates: the updates, as the solver took them.
        why: which rules forbid an answer, where there is none and that is known.

    """

    holds: bool
    updates: Tuple[str, ...]
    why: Optional[WhyNot] = None

    @property
    def stream(self) -> str:
        """The updates as an online progression."""
        return "".join(self.updates)


class SteeredSolver(PlanSolver):
    """A solver that takes, of several shortest plans, one that begins with the actions that are ``chosen``."""

    def __init__(self, program: ReactiveProgram, chosen: Chosen) -> None:
        super().__init__(program)
        self._chosen = chosen

    def update(
        self,
        update: StreamUpdate,
        stopped: Optional[Callable[[], bool]] = None,
        dropped: Optional[Callable[[], bool]] = None,
    ) -> SolveResult:
        """Take ``update`` as any solver does; where its answer begins otherwise, look for one of the same length."""
        before = self.log
        result = super().update(update, stopped, dropped)
        wanted, has = self._chosen.get(result.step), _actions_of(result)
        if wanted is None or not result.answers or has == wanted:
            return result
        demands = [commitment(one) for one in sorted(wanted)]
        forbidden = [Statement(None, (Literal(one, positive=True),)) for one in sorted(has - wanted)]
        steered = StreamUpdate(
            update.step, result.horizon - result.step, (*update.items, Volatile(), *demands, *forbidden)
        )
        self.restore(before)
        other = super().update(steered, stopped, dropped)
        found = other if other.answers else result
        self.restore(before.with_entries(AcceptedUpdate(update, found.horizon)).adopt(Plan.from_result(found)))
        return found


def _actions_of(result: SolveResult) -> FrozenSet[clingo.Symbol]:
    return frozenset(filter(is_action_of(result.step), result.answers[0])) if result.answers else frozenset()


def confirm(
    program: ReactiveProgram, finding: Finding, limits: Limits, halt: Callable[[], bool] = lambda: False
) -> Confirmation:
    """Go the way of a finding with the solver that cores have; ``halt`` ends the search for reasons."""
    chosen = {step.cycle: step.chosen for step in finding.way if step.cycle}
    core = TrialCore(program, lambda: SteeredSolver(program, chosen), CoreSettings(horizon_limit=limits.steps))
    core.start()
    if finding.cost == 0 and core.hopeless:
        return Confirmation(finding.kind is Kind.NO_ANSWER, tuple(one for step in finding.way for one in step.updates))
    updates: List[str] = []
    for number, step in enumerate(finding.way):
        try:
            core.make(step.move)
        except BrokenError as broken:
            sent = [one.stream for one in core.updates]
            last = str(broken.stream.update)
            updates += sent if last in sent else [*sent, last]
            holds = broken.kind == finding.kind.value and number == len(finding.way) - 1
            return Confirmation(holds, tuple(updates), _why(program, broken, halt))
        updates += [one.stream for one in core.updates]
    return Confirmation(_is_so(core, finding, updates), tuple(updates))


def _is_so(core: TrialCore, finding: Finding, updates: Sequence[str]) -> bool:
    """Tell whether a way that goes on has led to what was found."""
    if finding.kind is Kind.NO_ANSWER or len(updates) != finding.length:
        return False
    if finding.kind is Kind.REPEATED:
        return finding.subject in [str(one.atom) for one in core.awaited]
    if finding.kind in (Kind.NEVER_ENDED, Kind.PUT_OFF):
        return bool(core.live_goals) and (finding.circular or not (core.awaited or core.due))
    return True


def _why(program: ReactiveProgram, broken: BrokenError, halt: Callable[[], bool]) -> Optional[WhyNot]:
    if broken.kind != NO_ANSWER:
        return None
    try:
        return explain(program, broken.stream, halt)
    except (SolverError, UndecidedError):
        return None
