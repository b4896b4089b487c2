"""Questions about one update: whether there is a plan with some rules, after some of the facts of the stream."""

from dataclasses import replace
from typing import Callable, FrozenSet, Iterable, List, Optional

import clingo

from rosoclingo.oclingo.errors import DroppedError, SolverError
from rosoclingo.oclingo.explaining.minimal_sets import OutOfTimeError
from rosoclingo.oclingo.explaining.relaxed_program import RelaxedProgram
from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.oclingo.solving.assumptions import Search
from rosoclingo.oclingo.solving.inquiry import Inquiry
from rosoclingo.oclingo.solving.stream_state import Setting, StreamState

Halt = Callable[[], bool]
Facts = FrozenSet[clingo.Symbol]


class Questions:
    """What can be asked of a program whose rules can be let go, about ``update``, which follows on ``state``.

    Attributes:
        told: the facts of the stream that are in doubt, and what was done.

    """

    def __init__(
        self, setting: Setting, state: StreamState, update: StreamUpdate, steps: int, idles: bool, halt: Halt
    ) -> None:
        """Ask for plans of at most ``steps`` steps; for ``idles`` see :class:`Inquiry`. ``halt`` ends a question."""
        self.told = _in_doubt(state, update)
        self._about = setting, state, replace(update, bound=None), self.told, idles
        self._steps, self._halt = steps, halt
        self._inquiry = Inquiry(*self._about)

    def about(self, program: RelaxedProgram) -> "Questions":
        """Return the same questions about another program."""
        setting, state, update, _, idles = self._about
        return Questions(replace(setting, program=program), state, update, self._steps, idles, self._halt)

    def ask(self, kept: Iterable[clingo.Symbol], told: Optional[Facts] = None, steps: Optional[int] = None) -> Search:
        """Tell whether there is a plan with all that is ``kept`` after the facts ``told`` (None: all).

        Raises OutOfTimeError, and SolverError where the update is refused.
        """
        untold = self.told - (self.told if told is None else told)
        try:
            verdict = self._inquiry.search(
                untold, self._steps if steps is None else steps, self._halt, self._halt, sorted(kept)
            )
        except DroppedError:
            raise OutOfTimeError from None
        except RuntimeError as error:
            raise SolverError(f"the update was refused: {error}") from None
        if verdict.satisfiable is None:
            raise OutOfTimeError
        return verdict

    def known(self) -> List[clingo.Symbol]:
        """Return all atoms that may be true at the steps that have been ground."""
        return self._inquiry.known()

    def shortest(self, kept: Iterable[clingo.Symbol], found: Search) -> Search:
        """Return the shortest plan with what is kept, of which one was found."""
        kept = list(kept)
        low, best = 0, found
        step = self._about[1].step if self._about[2].step is None else self._about[2].step
        while low < best.horizon - step:
            middle = (low + best.horizon - step) // 2
            verdict = self.ask(kept, steps=middle)
            if not verdict.satisfiable:
                low = middle + 1
            elif verdict.horizon < best.horizon:
                best = verdict
            else:  # steps that are ground whatever the bound
                break
        return best


def _in_doubt(state: StreamState, update: StreamUpdate) -> Facts:
    """Return what may not have been told, or done: a fact that goes takes along what was done because of it."""
    statements = [*state.permanent, *state.unsettled(), *(one for _, one in update.sections())]
    plain = (one for one in statements if one.is_commitment or not one.body)
    return frozenset(one.subject for one in plain if one.subject is not None)
