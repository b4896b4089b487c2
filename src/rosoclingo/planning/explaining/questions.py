"""Questions about one update: whether there is a plan with some rules, after some of the facts of the stream."""

from dataclasses import replace
from typing import FrozenSet, Iterable, List, NamedTuple, Optional

import clingo

from rosoclingo.oclingo.errors import DroppedError
from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.planning.explaining.relaxed_program import RelaxedProgram
from rosoclingo.planning.history import History
from rosoclingo.planning.minimal_sets import UndecidedError
from rosoclingo.planning.question import Reply, Stop
from rosoclingo.planning.snapshot import Snapshot
from rosoclingo.planning.solver import PlanSolver

Facts = FrozenSet[clingo.Symbol]


class Stream(NamedTuple):
    """What the question is about: ``update`` follows on ``log``, and a plan may have so many ``steps``.

    ``oclingo_strings`` is as for :class:`~rosoclingo.planning.solver.PlanSolver`.
    """

    log: History
    update: StreamUpdate
    steps: int
    oclingo_strings: bool = False


class Questions:
    """What can be asked of a program whose rules can be let go, about a stream.

    Attributes:
        step: the step of the stream's update.
        told: the facts of the stream that are assumable, and what was done.

    """

    def __init__(self, program: RelaxedProgram, stream: Stream, idles: bool, halt: Stop) -> None:
        """Ask for plans; ``idles`` tells whether answers outlive further steps. ``halt`` ends a question."""
        self._stream, self._idles, self._halt = stream, idles, halt
        self._solver = PlanSolver(program, oclingo_strings=stream.oclingo_strings, idles=idles)
        self._solver.restore(stream.log)
        before, update = self._solver.snapshot, stream.update
        self.step = before.step if update.step is None else update.step
        self.told = _assumable(before, update)

    def about(self, program: RelaxedProgram) -> "Questions":
        """Return the same questions about another program."""
        return Questions(program, self._stream, self._idles, self._halt)

    def ask(self, kept: Iterable[clingo.Symbol], told: Optional[Facts] = None, steps: Optional[int] = None) -> Reply:
        """Tell whether there is a plan with all that is ``kept`` after the facts ``told`` (None: all).

        Raises UndecidedError, and SolverError if the update is refused.
        """
        disabled = self.told - (self.told if told is None else told)
        update = replace(self._stream.update, bound=self._stream.steps if steps is None else steps)
        try:
            reply = self._solver.probe(
                update, self.told, disabled, self._halt, self._halt, sorted(kept), believes=False
            )
        except DroppedError:
            raise UndecidedError from None
        if reply.satisfiable is None:
            raise UndecidedError
        return reply

    def known(self) -> List[clingo.Symbol]:
        """Return all atoms that may be true at the steps that have been ground."""
        return self._solver.probed_atoms()

    def shortest(self, kept: Iterable[clingo.Symbol], found: Reply) -> Reply:
        """Return the shortest plan with what is kept, of which one was found."""
        kept = list(kept)
        low, best = 0, found
        while low < best.horizon - self.step:
            middle = (low + best.horizon - self.step) // 2
            reply = self.ask(kept, steps=middle)
            if not reply.satisfiable:
                low = middle + 1
            elif reply.horizon < best.horizon:
                best = reply
            else:  # steps that are ground whatever the bound
                break
        return best


def _assumable(snapshot: Snapshot, update: StreamUpdate) -> Facts:
    """Return what may not have been told, or done: a fact that goes takes along what was done because of it."""
    statements = [*snapshot.statements, *(one for _, one in update.sections())]
    plain = (one for one in statements if one.is_commitment or not one.body)
    return frozenset(one.subject for one in plain if one.subject is not None)
