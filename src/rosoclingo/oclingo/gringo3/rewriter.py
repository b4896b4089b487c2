"""Replacement of statements in a text that preserves comments, layout and line numbers."""

from difflib import SequenceMatcher
from typing import Dict, List, Sequence, Tuple

from rosoclingo.oclingo.gringo3.lexer import SourceToken, tokens

_MOST = 100_000  # maximum number of compared token pairs; larger statements lose their layout


class Rewriting:
    """Collects replacements of statements; each statement keeps its number of lines."""

    def __init__(self, text: str, all_tokens: Sequence[SourceToken]) -> None:
        self._text, self._tokens = text, all_tokens
        self._new: Dict[int, Tuple[int, str]] = {}

    def replace(self, first: int, after: int, new: str) -> None:
        """Replace a range of tokens by a text without newlines and comments."""
        self._new[first] = (after, new)

    def result(self) -> str:
        """Return the text with all replacements; unchanged tokens keep their layout and comments."""
        pieces: List[str] = []
        offset = 0
        for first, (after, new) in sorted(self._new.items()):
            old = self._tokens[first:after]
            pieces += [self._text[offset : old[0].start], self._merged(old, new)]
            offset = old[-1].end
        return "".join([*pieces, self._text[offset:]])

    def _merged(self, old: Sequence[SourceToken], text: str) -> str:
        new = tokens(text)[:-1]
        words, new_words = [one.text for one in old], [one.text for one in new]
        small = len(words) * len(new_words) < _MOST
        whole = [("replace", 0, len(words), 0, len(new_words))]
        matcher = SequenceMatcher(lambda word: word in ",;:", words, new_words, autojunk=False)
        found = ""
        for kind, first, after, start, end in matcher.get_opcodes() if small else whole:
            gap, own = _gap(self._text, old, first), _gap(text, new, start)
            lead = gap if kind != "insert" and {"\n", "%"} & set(gap) else "" if kind == "delete" else own
            if kind == "equal":
                kept = (_gap(self._text, old, n) + old[n].text for n in range(first + 1, after))
                found += lead + old[first].text + "".join(kept)
            else:
                dropped = self._text[old[first].start : old[after - 1].end] if after > first else ""
                added = text[new[start].start : new[end - 1].end] if end > start else ""
                found += lead + added + "\n" * dropped.count("\n")
        return found


def _gap(text: str, row: Sequence[SourceToken], index: int) -> str:
    """Return the text between a token and its predecessor."""
    return text[row[index - 1].end : row[index].start] if 0 < index < len(row) else ""
