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
        self._table: Dict[Tuple[Symbol, int], List[Symbol]] = {}
        for atom in answer:
            if is_keyword(atom, STATUS):
                self._enter(atom)
        self.faults.sort()

    def read(self, identifier: Symbol, cycle: int) -> Optional[Status]:
        """The goal's status in a cycle; of several the worst. None when the program says nothing."""
        found = map(_status_of, self._table.get((identifier, cycle), []))
        return min(found, key=lambda status: (list(WORDS).index(status.word), status.reason), default=None)

    def _enter(self, atom: Symbol) -> None:
        identifier, word, cycle = atom.arguments if len(atom.arguments) == 3 else (atom, atom, atom)
        if cycle.type is SymbolType.Number and word.type is SymbolType.Function and word.name in WORDS:
            self._table.setdefault((identifier, cycle.number), []).append(word)
        else:
            self.faults.append("'{}' is no status: write _status(Id,S,C), S one of {}".format(atom, ", ".join(WORDS)))


def _status_of(word: Symbol) -> Status:
    return Status(word.name, ", ".join(text_of(argument) for argument in word.arguments))
