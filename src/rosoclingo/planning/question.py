"""Questions of strategies to a grounding, and the replies."""

from typing import Callable, FrozenSet, Generator, NamedTuple, Optional, Sequence, Tuple, TypeVar

import clingo

from rosoclingo.planning.history import Plan
from rosoclingo.planning.prediction import PredictedReturns

Assumptions = Sequence[Tuple[clingo.Symbol, bool]]
"""Atoms with assumed truth values."""

Stop = Callable[[], bool]
"""A stop function: it returns whether to end the search."""


def never() -> bool:
    """Return False; the stop function of a search without a limit."""
    return False


class Question(NamedTuple):
    """Is there an answer with a horizon between ``first`` and ``last``?

    Attributes:
        first: the least horizon.
        last: the greatest horizon; the program is ground up to it.
        given: assumed truth values of atoms.
        lacking: at least one of these atoms has to be false.
        asserted: open externals that hold, in addition to the facts of the snapshot.
        kept: these atoms have to be true.
        disabled: the assumable facts that do not hold; all other facts hold.
        believes: trust the program if it claims that there is no plan.
        models: the number of answers to compute, 0 for all.
        conflicts: the limit of conflicts, None for no limit.
        best: compute only optimal answers, if the program optimizes.
        proven: require a proof of optimality; otherwise accept the best answer found before the stop.
        advised: use the ``#heuristic`` statements.
        shows: compute the shown atoms of each answer.
        differ: any two answers differ in at least one of these atoms.
        whole: compute all true atoms of each answer.

    """

    first: int
    last: int
    given: Assumptions = ()
    lacking: Sequence[clingo.Symbol] = ()
    asserted: FrozenSet[clingo.Symbol] = frozenset()
    kept: Sequence[clingo.Symbol] = ()
    disabled: FrozenSet[clingo.Symbol] = frozenset()
    believes: bool = True
    models: int = 1
    conflicts: Optional[int] = None
    best: bool = False
    proven: bool = True
    advised: bool = True
    shows: bool = True
    differ: Sequence[clingo.Symbol] = ()
    whole: bool = False


class Reply(NamedTuple):
    """The reply to a question.

    Attributes:
        satisfiable: whether there is an answer, None if the search was ended or reached its limit.
        answers: the shown atoms of each answer.
        horizon: the horizon of the last answer.
        cost: the costs of the last answer by priority, highest first, if the program optimizes.
        optimal: whether no answer with these horizons and assumptions costs less.
        core: the assumable facts and the atoms of ``kept`` in the unsat core.
        hopeless: whether all other horizons are unsatisfiable too, for the same reason.
        permanent: whether the program stays unsatisfiable after any further update.
        predicted: returns that leave the last answer valid.
        atoms: all true atoms of each answer, if the question is ``whole``.

    """

    satisfiable: Optional[bool]
    answers: Tuple[FrozenSet[clingo.Symbol], ...] = ()
    horizon: int = 0
    cost: Tuple[int, ...] = ()
    optimal: bool = False
    core: FrozenSet[clingo.Symbol] = frozenset()
    hopeless: bool = False
    permanent: bool = False
    predicted: PredictedReturns = PredictedReturns()
    atoms: Tuple[FrozenSet[clingo.Symbol], ...] = ()

    @property
    def plan(self) -> Plan:
        """The plan in the last answer."""
        return Plan.from_atoms(self.answers[-1], self.horizon)


UNKNOWN = Reply(None)


Result = TypeVar("Result")

Strategy = Generator[Question, Reply, Result]
"""Yields questions, receives the replies and returns its result.

A stop throws :class:`~rosoclingo.oclingo.errors.StoppedError` into it. Then it returns the best result so far or lets
the error pass.
"""
