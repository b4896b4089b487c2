"""Parsers made by lark from grammars: trees whose nodes know their places, and errors that list the accepted tokens."""

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
    message = "is not installed, which control programs and programs in gringo 3's language need"
    raise ProgramError([Fault("lark", 0, 0, message, "python3 -m pip install 'lark>=1.1.5'")]) from error

__all__ = ["DEEPEST", "Grammar", "MisfitError", "SyntaxNode", "Token"]

DEEPEST = 250
"""Limit of the unfinished rules around a token: deeper nesting would exhaust Python's stack later."""


class SyntaxNode(Tree[Token]):
    """What a rule of a grammar matched: ``data`` is the rule's name."""

    children: List[Union["SyntaxNode", Token]]  # type: ignore[assignment]  # all are made as nodes

    @property
    def kind(self) -> str:
        """The name of the rule."""
        return str(self.data)

    @property
    def parts(self) -> List["SyntaxNode"]:
        """What the rules within it matched."""
        return [one for one in self.children if isinstance(one, SyntaxNode)]

    @property
    def tokens(self) -> List[Token]:
        """The tokens that the grammar names in this rule."""
        return [one for one in self.children if isinstance(one, Token)]

    @property
    def text(self) -> str:
        """The first of these tokens."""
        return str(self.tokens[0])

    @property
    def first(self) -> Token:
        """The first token in it."""
        child = self.children[0]
        return child.first if isinstance(child, SyntaxNode) else child

    @property
    def span(self) -> Tuple[int, int]:
        """The positions where its first token begins and its last one ends."""
        last = self.children[-1]
        while isinstance(last, SyntaxNode):
            last = last.children[-1]
        return self.first.start_pos or 0, last.end_pos or 0

    @property
    def line(self) -> int:
        """The line where it begins, from 1."""
        return self.meta.line if hasattr(self.meta, "line") else self.first.line or 1

    @property
    def column(self) -> int:
        """The column where it begins, from 1."""
        return self.meta.column if hasattr(self.meta, "column") else self.first.column or 1

    def walk(self) -> Iterator["SyntaxNode"]:
        """Yield the node and all nodes within it, in the order of the text."""
        yield self
        for part in self.parts:
            yield from part.walk()


class _NoLexer(Lexer):
    """Stands for the lexer of a grammar whose tokens are given."""

    def __init__(self, lexer_conf: LexerConf) -> None:
        pass

    def lex(self, lexer_state: LexerState, parser_state: Any) -> Iterator[Token]:
        """Yield nothing."""
        return iter(())


class MisfitError(Exception):
    """A token that no rule accepts where it stands; ``accepted`` are the types of those that would fit.

    None are listed if the nesting is too deep.
    """

    def __init__(self, token: Token, accepted: AbstractSet[str]) -> None:
        self.token, self.accepted = token, accepted
        super().__init__(f"{token!r} in place of {sorted(accepted)}")


def _cache_of(text: str) -> str:
    """Return the file in which lark keeps the parser of a grammar; making one takes longer than all the rest."""
    folder = Path(os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache"), "rosoclingo", "grammars")
    with suppress(OSError):
        folder.mkdir(parents=True, exist_ok=True)
    return str(folder / sha256(text.encode()).hexdigest()[:16])


class Grammar:
    """A grammar with its parser; ``starts`` are the rules that a text can be parsed by.

    Where texts are not ``lexed`` by the grammar, but their tokens given, trees have all of these. The parser is kept in
    the user's cache folder, ``~/.cache/rosoclingo/grammars``, if that can be written.
    """

    def __init__(self, text: str, starts: Sequence[str], lexed: bool = True) -> None:
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
        """Return the type of the token that is this word, "" where the grammar has none."""
        if word not in self._types:
            found = (name for name, pattern in self._patterns.items() if pattern.fullmatch(word))
            self._types[word] = next(found, "")
        return self._types[word]

    def tokens(self, text: str) -> List[Token]:
        """Return the tokens of a text; the grammar has to have one for any character."""
        parser = self._lark.parse_interactive(text, self._starts[0])  # Lark.lex() makes a lexer each time
        return list(parser.lexer_thread.lex(parser.parser_state))

    def parse(self, tokens: Iterable[Token], end: Token, start: str) -> SyntaxNode:
        """Parse tokens, the last of which is followed by ``end``; raises MisfitError."""
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
