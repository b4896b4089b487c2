"""What a strategy asks a grounding, and what it gets to know."""

from typing import Callable, FrozenSet, Generator, NamedTuple, Optional, Sequence, Tuple, TypeVar

import clingo

from rosoclingo.planning.prediction import Predicted

Given = Sequence[Tuple[clingo.Symbol, bool]]
"""Atoms with the truth values that they are to have."""

Stop = Callable[[], bool]
"""Tells whether a search is to end."""


Read = Callable[[clingo.Model], FrozenSet[clingo.Symbol]]


class Question(NamedTuple):
    """Is there an answer of a horizon in ``first`` to ``last``?

    Attributes:
        first: the least horizon.
        last: the greatest one; the program is ground up to it.
        given: only answers in which these atoms are so.
        lacking: only answers in which at least one of these atoms is false.
        kept: only answers in which these atoms are true; those because of which there is none are told.
        disabled: assumable facts that were not told; all others were.
        believes: whether to take it for true if the program claims that there is no plan.
        models: number of answers to find, 0 for all.
        conflicts: limit of conflicts, None for no limit.
        best: whether only the best answers count, if the program optimizes.
        proven: whether the best answer has to be proven best; else the best one found until the stop will do.
        advised: whether ``#heuristic`` statements count.
        until: ends this question beside the stop of all; None for nothing.
        blames: whether the reply tells because of which assumable facts and atoms kept there is no answer.
        brief: whether it is asked in place, which spares a thread; it has to end soon by ``conflicts`` then, as no stop
            is heard.
        shows: whether the reply has the shown atoms of each answer.
        differ: atoms in which any two answers differ.
        reads: what to read of the model of each answer.

    """

    first: int
    last: int
    given: Given = ()
    lacking: Sequence[clingo.Symbol] = ()
    kept: Sequence[clingo.Symbol] = ()
    disabled: FrozenSet[clingo.Symbol] = frozenset()
    believes: bool = True
    models: int = 1
    conflicts: Optional[int] = None
    best: bool = False
    proven: bool = True
    advised: bool = True
    until: Optional[Stop] = None
    blames: bool = True
    brief: bool = False
    shows: bool = True
    differ: Sequence[clingo.Symbol] = ()
    reads: Sequence[Read] = ()


class Reply(NamedTuple):
    """What came of a question.

    Attributes:
        satisfiable: whether there is an answer, None if that was not found out.
        answers: the shown atoms of each answer.
        horizon: that of the last answer.
        core: assumable facts because of which there is no answer.
        blamed: the atoms kept because of which there is none.
        hopeless: whether no other horizon has an answer either, for the same reason.
        permanent: whether nothing that may be told makes the program satisfiable again.
        predicted: returns with which the answer stays one.
        read: what was read of each answer.

    """

    satisfiable: Optional[bool]
    answers: Tuple[FrozenSet[clingo.Symbol], ...] = ()
    horizon: int = 0
    core: FrozenSet[clingo.Symbol] = frozenset()
    blamed: FrozenSet[clingo.Symbol] = frozenset()
    hopeless: bool = False
    permanent: bool = False
    predicted: Predicted = Predicted()
    read: Tuple[Tuple[FrozenSet[clingo.Symbol], ...], ...] = ()


UNKNOWN = Reply(None)

Result = TypeVar("Result")

Strategy = Generator[Question, Reply, Result]
"""Yields questions, is sent the replies, and returns what it has found; :class:`StoppedError` is thrown into it."""


class StoppedError(Exception):
    """A strategy is to end; if it has found something that will do it returns that."""
