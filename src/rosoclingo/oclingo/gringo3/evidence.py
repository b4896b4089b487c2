"""Detection of a file's language with clingo's parser and the grammar of gringo 3."""

from functools import cached_property
from typing import Optional, Sequence, Union

from rosoclingo.oclingo.grammars import SyntaxNode
from rosoclingo.oclingo.gringo3.dialect import GRINGO3_WORDS, STEP_DIRECTIVES, Dialect, SourceFile
from rosoclingo.oclingo.gringo3.grammar import UntranslatableError, parse
from rosoclingo.oclingo.gringo3.lexer import SourceToken, TokenKind


class Evidence:
    """The results of both parsers for the statements of a file.

    Attributes:
        source: the file.
        trees: for each statement, its tree by gringo 3's grammar, or the parse error.

    """

    def __init__(self, source: SourceFile) -> None:
        self.source = source
        self.trees = [_read(source.tokens, *one) for one in source.ranges]

    def dialect_of(self, number: int) -> Dialect:
        """Return the only language that accepts a statement, ``EITHER`` if both or neither do."""
        words, tree = [one.text for one in self.source.statement(number)], self.trees[number]
        refused = isinstance(tree, UntranslatableError) and not tree.limits
        if not GRINGO3_WORDS.isdisjoint(words) or (words[0] == "#external" and words.count(":") > 1):
            return Dialect.GRINGO3
        if number in self.source.not_clingo5:
            return Dialect.EITHER if refused else Dialect.GRINGO3
        unknown = refused and words[0] not in (*STEP_DIRECTIVES, "#include")
        return Dialect.CLINGO5 if unknown else Dialect.EITHER

    @cached_property
    def dialect(self) -> Optional[Dialect]:
        """The language of the file, None if it is ambiguous."""
        if self.source.pragma is not None:
            return self.source.pragma
        found = set(map(self.dialect_of, range(len(self.trees)))) - {Dialect.EITHER}
        return found.pop() if len(found) == 1 else self.source.by_directives


def _read(tokens: Sequence[SourceToken], first: int, after: int) -> Union[SyntaxNode, UntranslatableError]:
    begin, end = tokens[first], tokens[after - 1]
    ends = end.text == "." or (begin.text, end.text) == (":~", ">") or begin.kind is TokenKind.SCRIPT
    try:
        if not ends:
            raise UntranslatableError(end, "this statement has no dot at its end")
        return parse(tokens, first, after)
    except UntranslatableError as error:
        return error
