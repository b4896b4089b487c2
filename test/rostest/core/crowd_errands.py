"""The errands of the crowd's clients, drawn from a seed, so that they are the same in every process."""

import random
from typing import List, NamedTuple, Optional

CLIENTS = 4


class Errand(NamedTuple):
    """Bring a package; `patience` is the number of feedbacks before its cancel, None for no cancel."""

    number: int
    origin: str
    destination: str
    patience: Optional[int]

    @property
    def request(self) -> str:
        """Return the text of the goal."""
        return f"goal({self.origin},{self.destination},{self.number})"


def names(offices: int) -> List[str]:
    """Return the offices by name, in a row."""
    return [f"office{number}" for number in range(1, offices + 1)]


def errands(client: int, offices: int, cancels: bool, goals: int) -> List[Errand]:
    """Return ``count`` errands of one client, 0 to CLIENTS - 1, all to be met or some to be cancelled."""
    draw = random.Random(client)
    patience = [None, None, 0, 1, 2, 4] if cancels else [None]
    return [_errand(draw, client * goals + number, offices, patience) for number in range(1, goals + 1)]


def _errand(draw: random.Random, number: int, offices: int, patience: List[Optional[int]]) -> Errand:
    origin, destination = draw.sample(names(offices), 2)
    return Errand(number, origin, destination, draw.choice(patience))
