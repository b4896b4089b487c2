"""Parsers from lark grammars, with places in the syntax tree and errors that list the accepted tokens."""

import os
import re
from contextlib import suppress
from hashlib import sha256
from pathlib import Path
from typing import AbstractSet, Any, Dict, Iterable, Iterator, List, Sequence, Tuple, Union

from rosoclingo.oclingo.errors import Fault, ProgramError

try:
    from lark import Lark, Token, Tree, UnexpectedToken
    from lark.common import LexerConf
    from lark.lexer import Lexer, LexerState
except ModuleNotFoundError as error:
    message = "not installed; it is required for Golog programs and for programs in the language of gringo 3"
    raise ProgramError([Fault("lark", 0, 0, message, "python3 -m pip install 'lark>=1.1.5'")]) from error

__all__ = ["DEEPEST", "Grammar", "MisfitError", "SyntaxNode", "Token"]

DEEPEST = 250
"""Limit of unfinished rules around a token; deeper syntax trees would exhaust Python's stack."""


class SyntaxNode(Tree[Token]):
    """The part of a text that matches one rule of the grammar."""

    children: List[Union["SyntaxNode", Token]]  # type: ignore[assignment]  # lark creates only this class

    @property
    def kind(self) -> str:
        """The name of the rule."""
        return str(self.data)

    @property
    def parts(self) -> List["SyntaxNode"]:
        """The child nodes, without tokens."""
        return [one for one in self.children if isinstance(one, SyntaxNode)]

    @property
    def tokens(self) -> List[Token]:
        """The child tokens, without nodes."""
        return [one for one in self.children if isinstance(one, Token)]

    @property
    def text(self) -> str:
        """The text of the first child token."""
        return str(self.tokens[0])

    @property
    def first(self) -> Token:
        """The first token of the node and its descendants."""
        child = self.children[0]
        return child.first if isinstance(child, SyntaxNode) else child

    @property
    def span(self) -> Tuple[int, int]:
        """The start of the first token and the end of the last token, as positions in the text."""
        last = self.children[-1]
        while isinstance(last, SyntaxNode):
            last = last.children[-1]
        return self.first.start_pos or 0, last.end_pos or 0

    @property
    def line(self) -> int:
        """The first line of the node, from 1."""
        return self.meta.line if hasattr(self.meta, "line") else self.first.line or 1

    @property
    def column(self) -> int:
        """The column of the first token, from 1."""
        return self.meta.column if hasattr(self.meta, "column") else self.first.column or 1

    def walk(self) -> Iterator["SyntaxNode"]:
        """Yield the node and all its descendants, in the order of the text."""
        yield self
        for part in self.parts:
            yield from part.walk()


class _NoLexer(Lexer):
    """Placeholder for the lexer of a grammar that parses a list of tokens."""

    def __init__(self, lexer_conf: LexerConf) -> None:
        pass

    def lex(self, lexer_state: LexerState, parser_state: Any) -> Iterator[Token]:
        """Yield nothing."""
        return iter(())


class MisfitError(Exception):
    """A token does not fit the grammar.

    Attributes:
        token: the token.
        accepted: the types of the tokens that would fit; empty if the nesting is too deep.

    """

    def __init__(self, token: Token, accepted: AbstractSet[str]) -> None:
        self.token, self.accepted = token, accepted
        super().__init__(f"{token!r} in place of {sorted(accepted)}")


def _cache_of(text: str) -> str:
    """Return the cache file for the parser of a grammar; generating a parser is slow."""
    folder = Path(os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache"), "rosoclingo", "grammars")
    with suppress(OSError):
        folder.mkdir(parents=True, exist_ok=True)
    return str(folder / sha256(text.encode()).hexdigest()[:16])


class Grammar:
    """A grammar and its parser, which is cached in ``~/.cache/rosoclingo/grammars`` if this folder is writable."""

    def __init__(self, text: str, starts: Sequence[str], lexed: bool = True) -> None:
        """Build the parser for the grammar ``text``.

        Args:
            text: the grammar in lark's language.
            starts: the start rules.
            lexed: whether the grammar also defines the lexer. Otherwise the caller provides the tokens, and syntax
                trees contain all of them.

        """
        self._starts = list(starts)
        self._lark = Lark(
            text,
            parser="lalr",
            lexer="basic" if lexed else _NoLexer,
            keep_all_tokens=not lexed,
            start=self._starts,
            tree_class=SyntaxNode,
            propagate_positions=lexed,
            maybe_placeholders=False,
            cache=_cache_of(text),
        )
        self._patterns = {one.name: re.compile(one.pattern.to_regexp()) for one in self._lark.terminals if one.pattern}
        self._types: Dict[str, str] = {}

    def type_of(self, word: str) -> str:
        """Return the type of the token ``word``; empty if the grammar has no such token."""
        if word not in self._types:
            found = (name for name, pattern in self._patterns.items() if pattern.fullmatch(word))
            self._types[word] = next(found, "")
        return self._types[word]

    def tokens(self, text: str) -> List[Token]:
        """Return the tokens of ``text``; the grammar must accept every character."""
        parser = self._lark.parse_interactive(text, self._starts[0])  # Lark.lex() makes a lexer each time
        return list(parser.lexer_thread.lex(parser.parser_state))

    def parse(self, tokens: Iterable[Token], end: Token, start: str) -> SyntaxNode:
        """Parse ``tokens`` by the rule ``start``; raises MisfitError, with the token ``end`` at the end of the text."""
        parser = self._lark.parse_interactive("", start)
        token = end
        try:
            for token in tokens:
                parser.feed_token(token)
                if len(parser.parser_state.state_stack) > DEEPEST:
                    raise MisfitError(token, frozenset())
            token = end
            found: SyntaxNode = parser.feed_token(Token.new_borrow_pos("$END", str(end), end))
        except UnexpectedToken:
            raise MisfitError(token, parser.accepts()) from None
        return found
