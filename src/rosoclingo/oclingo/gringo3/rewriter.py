"""Replaces parts of a text while all the rest, with its comments and lines, stays as it is."""

from typing import Dict, List, Sequence, Tuple

from rosoclingo.oclingo.gringo3.lexer import Token
from rosoclingo.oclingo.gringo3.syntax import Span


class Rewriting:
    """Edits of a text, given as ranges of its tokens; replaced ranges keep their number of lines."""

    def __init__(self, text: str, tokens: Sequence[Token]) -> None:
        self._text, self._tokens = text, tokens
        self._edits: Dict[int, Tuple[int, str]] = {}
        self._insertions: Dict[int, str] = {}

    def replace(self, span: Span, new: str) -> None:
        """Replace the tokens of a span by a text without newlines; earlier edits inside the span are dropped."""
        first, after = span
        for inner in range(first, after):
            self._edits.pop(inner, None)
            self._insertions.pop(inner, None)
        self._edits[first] = (after, new)

    def insert(self, index: int, new: str) -> None:
        """Put a text directly before a token, after what was put there earlier."""
        self._insertions[index] = self._insertions.get(index, "") + new

    def line(self, span: Span) -> str:
        """The text of a span with its edits, on one line and without comments."""
        words, index = [], span[0]
        while index < span[1]:
            after, new = self._edits.get(index, (index + 1, self._tokens[index].text))
            words.append(self._insertions.get(index, "") + new)
            index = after
        return " ".join(word for word in words if word)

    def result(self) -> str:
        """The text with all edits."""
        pieces: List[str] = []
        offset = 0
        for index in sorted({*self._edits, *self._insertions}):
            start = self._tokens[index].start
            if start < offset:
                continue
            pieces += [self._before(index, self._text[offset:start]), self._insertions.get(index, "")]
            offset = start
            if index in self._edits:
                offset = self._replacement(index, pieces)
        return "".join([*pieces, self._text[offset:]])

    def _before(self, index: int, text: str) -> str:
        """The untouched text before an edit; a separator follows what it separates without a space."""
        separates = index in self._edits and self._edits[index][1] in (",", ";")
        stripped = text.rstrip(" \t")
        return stripped if separates and not stripped.endswith("\n") else text

    def _replacement(self, index: int, pieces: List[str]) -> int:
        after, new = self._edits[index]
        start, end = self._tokens[index].start, self._tokens[after - 1].end
        pieces.append(new + "\n" * self._text.count("\n", start, end))
        return end
