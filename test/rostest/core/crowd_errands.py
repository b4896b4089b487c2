"""What the clients of the crowd want: the same in every process, as it is drawn with a seed."""

import random
from typing import List, NamedTuple, Optional

OFFICES = ("office1", "office2")
CLIENTS = 4
GOALS = 25  # of each client, all at once


class Errand(NamedTuple):
    """Bring a package; `patience` is how many feedbacks are heard before it is cancelled, None: it is not."""

    number: int
    origin: str
    destination: str
    patience: Optional[int]

    @property
    def request(self) -> str:
        """The text of the goal."""
        return f"goal({self.origin},{self.destination},{self.number})"


def errands(client: int) -> List[Errand]:
    """The errands of one client, 0 to CLIENTS - 1."""
    draw = random.Random(client)
    return [_errand(draw, client * GOALS + number) for number in range(1, GOALS + 1)]


def _errand(draw: random.Random, number: int) -> Errand:
    origin, destination = draw.sample(OFFICES, 2)
    return Errand(number, origin, destination, draw.choice([None, None, 0, 1, 2, 4]))
