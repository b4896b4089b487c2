"""Replaces parts of a text while all the rest, with its comments and lines, stays as it is."""

from typing import Dict, List, Sequence, Tuple, Union

from rosoclingo.oclingo.grammars import SyntaxNode
from rosoclingo.oclingo.grammars import Token as GrammarToken
from rosoclingo.oclingo.gringo3.lexer import SourceToken

SPECIAL = (":=", "#mod", "#div", "#pow", "#abs", ";;", ";")
"""Tokens inside literals and terms that today's syntax lacks or reads otherwise."""

Domains = Sequence[Tuple[str, Sequence[str]]]
"""Atoms declared by ``#domain``, each with its variables."""


def domain_atoms(tokens: Sequence[SourceToken], domains: Domains) -> List[str]:
    """The atoms of those declarations that a variable among the tokens belongs to."""
    names = {token.text for token in tokens}
    return [atom for atom, variables in domains if not names.isdisjoint(variables)]


class Rewriting:
    """Edits of a text, at ranges of its tokens; replaced ranges keep their number of lines."""

    def __init__(self, text: str, tokens: Sequence[SourceToken]) -> None:
        self._text, self._tokens = text, tokens
        self._edits: Dict[int, Tuple[int, str]] = {}
        self._insertions: Dict[int, str] = {}

    def tokens_of(self, node: SyntaxNode) -> Sequence[SourceToken]:
        """The tokens of a node."""
        return self._tokens[slice(*node.span)]

    def is_special(self, node: SyntaxNode) -> bool:
        """Whether a node holds a token that today's syntax lacks or reads otherwise."""
        return any(token.text in SPECIAL for token in self.tokens_of(node))

    def stands_apart(self, index: int) -> bool:
        """Whether there is space before a token."""
        return index == 0 or self._tokens[index - 1].end < self._tokens[index].start

    def put(
        self, first: Union[SyntaxNode, GrammarToken], new: str, last: Union[SyntaxNode, GrammarToken, None] = None
    ) -> None:
        """Replace a node or token, or all from it to the ``last`` one, by a text without newlines."""
        start = first.span[0] if isinstance(first, SyntaxNode) else first.start_pos
        end = last or first
        self.replace(start or 0, (end.span[1] if isinstance(end, SyntaxNode) else end.end_pos) or 0, new)

    def replace(self, first: int, after: int, new: str) -> None:
        """Replace the tokens of a range by a text without newlines; earlier edits inside are dropped."""
        for inner in range(first, after):
            self._edits.pop(inner, None)
            self._insertions.pop(inner, None)
        self._edits[first] = (after, new)

    def insert(self, index: int, new: str) -> None:
        """Put a text directly before a token, after what was put there earlier."""
        self._insertions[index] = self._insertions.get(index, "") + new

    def line(self, node: SyntaxNode) -> str:
        """The text of a node with its edits, on one line and without comments."""
        words, (index, end) = [], node.span
        while index < end:
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
            after, new = self._edits.get(index, (index, ""))
            before = self._text[offset:start]
            if new in (",", ";") and not before.rstrip(" \t").endswith("\n"):
                before = before.rstrip(" \t")  # a separator follows what it separates without a space
            end = self._tokens[after - 1].end if after > index else start
            pieces += [before, self._insertions.get(index, ""), new, "\n" * self._text.count("\n", start, end)]
            offset = end
        return "".join([*pieces, self._text[offset:]])
