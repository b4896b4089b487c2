"""Places, and the moves that lead from one to another."""

from collections import deque
from typing import Dict, List, Optional, Tuple

import clingo

Deed = Tuple[clingo.Symbol, clingo.Symbol]
"""An action without its cycle: its kind and its parameter."""

Place = Optional[Deed]
"""Where a move has led to, named by it; None where no move is known that has."""

FAR = 1_000_000
"""Moves to where no way leads."""


class Ways:
    """Ways over moves that are known.

    Attributes:
        here: where the last move has led to.

    """

    def __init__(self, here: Place, back: bool) -> None:
        """Begin at a place. Where moves lead ``back``, one can go to where a move has begun."""
        self.here = here
        self._back = back
        self._beside: Dict[Place, Dict[Deed, None]] = {here: {}}
        self._found: Dict[Place, Dict[Place, Tuple[int, Place]]] = {}

    def go(self, place: Deed) -> None:
        """Move to a place."""
        self._beside[self.here][place] = None
        beside = self._beside.setdefault(place, {})
        if self._back and self.here is not None:
            beside[self.here] = None
        self.here = place
        self._found.clear()

    def steps(self, start: Place, end: Place) -> int:
        """Return how many moves lead from one place to another, ``FAR`` where none do."""
        return self._from(start).get(end, (FAR, None))[0]

    def way(self, start: Place, end: Place) -> List[Deed]:
        """Return the moves of a shortest way; raises KeyError where there is none."""
        found, way = self._from(start), []
        while end != start:
            _, before = found[end]
            assert end is not None
            way.append(end)
            end = before
        return way[::-1]

    def _from(self, start: Place) -> Dict[Place, Tuple[int, Place]]:
        """Return for each place that can be reached how many moves lead there, and where the last of them begins."""
        if start not in self._found:
            found: Dict[Place, Tuple[int, Place]] = {start: (0, None)}
            queue = deque([start])
            while queue:
                here = queue.popleft()
                for place in self._beside[here]:
                    if place not in found:
                        found[place] = found[here][0] + 1, here
                        queue.append(place)
            self._found[start] = found
        return self._found[start]
