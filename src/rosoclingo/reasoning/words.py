"""A program's terms as words for people, and what it says in explanation: the ``_explain(What,Text,C)`` atoms."""

from typing import Dict, FrozenSet, List, Optional, Tuple

from clingo import Symbol, SymbolType

from rosoclingo.reasoning.keywords import EXPLAIN, is_keyword, name_of


def text_of(term: Symbol) -> str:
    """A term as text: the content of a string, the pieces of a tuple joined, else the term as it is written."""
    if term.type is SymbolType.Function and not term.name:
        return "".join(text_of(piece) for piece in term.arguments)
    return name_of(term)


class Explanations:
    """All explanations of an answer; ``faults`` holds what was none."""

    def __init__(self, answer: FrozenSet[Symbol] = frozenset()) -> None:
        self.faults: List[str] = []
        self._texts: Dict[Symbol, Tuple[int, str]] = {}
        for atom in sorted((atom for atom in answer if is_keyword(atom, EXPLAIN)), key=str):
            self._enter(atom)

    def of(self, what: Symbol) -> Optional[str]:
        """What is said of a goal, by its identifier, or of an observation; of several the one of the latest cycle."""
        return self._texts[what][1] if what in self._texts else None

    def _enter(self, atom: Symbol) -> None:
        if len(atom.arguments) != 3 or atom.arguments[2].type is not SymbolType.Number:
            self.faults.append(f"'{atom}' is no explanation: write _explain(What,Text,C)")
            return
        what, text, cycle = atom.arguments
        if what not in self._texts or self._texts[what][0] <= cycle.number:
            self._texts[what] = cycle.number, text_of(text)
