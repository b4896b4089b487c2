"""What a program says of its goals: the ``_status(Id,S,C)`` atoms of an answer.

``S`` is accepted, rejected, succeeded, canceled or aborted, or one of these words around a reason,
``rejected(unknown_office)``, ``aborted(("package ",3," is not at ",office2))``.
"""

from typing import Dict, FrozenSet, List, NamedTuple, Optional, Tuple

from clingo import Symbol, SymbolType

from rosoclingo.reasoning.goals import Outcome
from rosoclingo.reasoning.keywords import STATUS, is_keyword
from rosoclingo.reasoning.words import text_of

#: The words of ``_status``, worst first, and how they end a goal (None: it goes on).
WORDS: Dict[str, Optional[Outcome]] = {
    "aborted": Outcome.ABORTED,
    "rejected": Outcome.REJECTED,
    "canceled": Outcome.CANCELED,
    "succeeded": Outcome.SUCCEEDED,
    "accepted": None,
}


class Status(NamedTuple):
    """One word about one goal, with the program's reason (empty when it gives none)."""

    word: str
    reason: str = ""

    @property
    def outcome(self) -> Optional[Outcome]:
        """How the word ends a goal; None for accepted."""
        return WORDS[self.word]


class Statuses:
    """All statuses of an answer; ``faults`` holds what was no status."""

    def __init__(self, answer: FrozenSet[Symbol]) -> None:
        self.faults: List[str] = []
        self._table: Dict[Tuple[Symbol, int], List[Status]] = {}
        for atom in sorted((atom for atom in answer if is_keyword(atom, STATUS)), key=str):
            self._enter(atom)

    def read(self, identifier: Symbol, cycle: int) -> Optional[Status]:
        """The goal's status in a cycle; of several the worst. None when the program says nothing."""
        found = self._table.get((identifier, cycle), [])
        return min(found, key=lambda status: list(WORDS).index(status.word), default=None)

    def _enter(self, atom: Symbol) -> None:
        status = _status_of(atom)
        if status is None:
            self.faults.append("'{}' is no status: write _status(Id,S,C), S one of {}".format(atom, ", ".join(WORDS)))
        else:
            self._table.setdefault((atom.arguments[0], atom.arguments[2].number), []).append(status)


def _status_of(atom: Symbol) -> Optional[Status]:
    if len(atom.arguments) != 3 or atom.arguments[2].type is not SymbolType.Number:
        return None
    word = atom.arguments[1]
    if word.type is not SymbolType.Function or word.name not in WORDS:
        return None
    return Status(word.name, ", ".join(text_of(argument) for argument in word.arguments))
