"""What a search assumes, what came of it, and which of the assumptions are to blame where there is no answer."""

from typing import Dict, FrozenSet, List, NamedTuple, Optional, Tuple

import clingo

from rosoclingo.oclingo.solving.doubts import Doubts
from rosoclingo.oclingo.solving.foresight import Foreseen


class Search(NamedTuple):
    """Result of one search: satisfiable or not, None where it was stopped; answers; horizon of the last.

    Where there is no answer, ``core`` are the facts in doubt because of which there is none, ``blamed`` the atoms kept
    because of which there is none; ``timeless`` tells that no other horizon has one for the same reason. ``foreseen``
    are returns that may be told, where that is recorded.
    """

    satisfiable: Optional[bool]
    answers: Tuple[FrozenSet[clingo.Symbol], ...] = ()
    horizon: int = 0
    core: FrozenSet[clingo.Symbol] = frozenset()
    foreseen: Foreseen = Foreseen()
    timeless: bool = False
    blamed: FrozenSet[clingo.Symbol] = frozenset()


class Assumptions:
    """What a search assumes beside the horizon: what was told of the facts in doubt, and what is kept.

    And that the program does not claim that there is no plan.

    Attributes:
        literals: they all.

    """

    def __init__(
        self,
        doubts: Optional[Doubts],
        untold: FrozenSet[clingo.Symbol],
        kept: Dict[clingo.Symbol, int],
        claim: Optional[int],
    ) -> None:
        """Take the facts in doubt that are ``untold``, and the literals of what is ``kept`` and of such a ``claim``."""
        self._doubts, self._kept = doubts, kept
        unclaimed = [] if claim is None else [-claim]
        self.literals = [*(doubts.assumptions(untold) if doubts else ()), *unclaimed, *kept.values()]

    def refuted_by(self, found: List[int], horizon: List[int], gave: bool) -> Search:
        """Return the result of a search that has no answer, by the core that was ``found``.

        The literals of its ``horizon`` were assumed as well, and other atoms if it ``gave`` any: clingo may blame those
        by literals that are not theirs.
        """
        core = set(found if self.literals else horizon)
        facts = self._doubts.among(core) if self._doubts else frozenset()
        blamed = frozenset(one for one, literal in self._kept.items() if literal in core)
        return Search(False, core=facts, timeless=not gave and core.isdisjoint(horizon), blamed=blamed)
