"""Ground terms, atoms and signatures; text is parsed into :class:`clingo.Symbol` and never evaluated.

The tokenizer covers whole online progressions; :mod:`~rosoclingo.oclingo.progression.parser` builds statements and
directives from its tokens. The grammar of terms is oClingo's: identifiers, "strings", integers, ``f(terms)``; atoms can
have classical negation (``-p(1)``). clingo's other terms are accepted as well: tuples, ``-f(terms)``, ``#inf`` and
``#sup``.
"""

import re
from bisect import bisect_right
from typing import List, NamedTuple, NoReturn, Tuple

import clingo

from rosoclingo.oclingo.errors import ProgressionError

MAX_DEPTH = 256
"""Maximal nesting depth of terms: far above practical needs, and safe for clingo's recursion."""

_SHOWN = 60  # characters of a token that a message shows
_LOWEST, _HIGHEST = -(2**31), 2**31 - 1
_LIMITS = {"#inf": clingo.Infimum, "#sup": clingo.Supremum}
_TOKEN = re.compile(
    r"""
      (?P<space>[ \t\r\n\f\v]+ | %(?!\*)[^\n]*)
    | (?P<block>%\*)
    | (?P<string>"(?:[^"\\\n\0\ud800-\udfff]|\\["\\n])*")
    | (?P<number>[0-9]+)
    | (?P<name>[_']*[a-z][A-Za-z0-9_']*)
    | (?P<directive>\#end[ \t\r\n]+step\b | \#[a-z]+)
    | (?P<symbol>:-|\.\.|[.,:()-])
    """,
    re.VERBOSE,
)
_VARIABLE = re.compile(r"[_']*[A-Z][A-Za-z0-9_']*|_")
_ODD_STRING = re.compile(r'"(?:[^"\\\n]|\\["\\n])*"')
_BLOCK_EDGE = re.compile(r"%\*|\*%")
_ESCAPE = re.compile(r"\\(.)")


class Signature(NamedTuple):
    """Name, arity and sign (False under classical negation) of a predicate."""

    name: str
    arity: int
    positive: bool = True

    def __str__(self) -> str:
        return "{}{}/{}".format("" if self.positive else "-", self.name, self.arity)


def signature_of(atom: clingo.Symbol) -> Signature:
    """Return the signature of a ground atom."""
    return Signature(atom.name, len(atom.arguments), atom.positive)


class Token(NamedTuple):
    """A token: its kind (``string``, ``number``, ``name``, ``directive``, ``symbol`` or ``end``), text and offset."""

    kind: str
    text: str
    offset: int


def _end_of_block(text: str, start: int) -> int:
    """Return the offset after the (nested) block comment at ``start``, -1 if it is not closed."""
    depth = 0
    for edge in _BLOCK_EDGE.finditer(text, start):
        depth += 1 if edge.group() == "%*" else -1
        if depth == 0:
            return edge.end()
    return -1


def _complaint(text: str, offset: int) -> str:
    if _ODD_STRING.match(text, offset):
        return "string with an invalid character (NUL or half of a surrogate pair)"
    if text[offset] == '"':
        return 'unterminated string; close it with " on the same line (escapes are \\", \\\\ and \\n)'
    variable = _VARIABLE.match(text, offset)
    if variable:
        return _of_variable(variable.group(), text[variable.end() : variable.end() + 1] == "(")
    return f"unexpected character {text[offset]!r}"


def _of_variable(name: str, with_arguments: bool) -> str:
    first = len(name) - len(name.lstrip("_'"))
    small = name[: first + 1].lower() + name[first + 1 :]
    if name == "_":
        return "_ is a variable: write a value in its place"
    if with_arguments:
        return f"{name} begins with a capital letter, as only variables do: write {small}"
    return f'{name} is a variable, since it begins with a capital letter: write a value, such as {small} or "{name}"'


class TokenStream:
    """The tokens of a text, with one token of look-ahead.

    Attributes:
        next: the next token, of kind ``end`` after the last one. Text that is not a token raises ProgressionError.
        strings_as_constants: whether strings become constants, see :func:`.parser.strings_as_constants`.

    """

    def __init__(self, text: str, strings_as_constants: bool = False) -> None:
        self._text, self.strings_as_constants = text, strings_as_constants
        self._offset = 0
        self._lines: List[int] = []  # offsets of line starts, computed on demand
        self.next = self._scan()

    def _scan(self) -> Token:
        while self._offset < len(self._text):
            match, start = _TOKEN.match(self._text, self._offset), self._offset
            if match is None:
                raise self.error(start, _complaint(self._text, start))
            self._offset = match.end()
            if match.lastgroup == "block":
                self._offset = _end_of_block(self._text, start)
                if self._offset < 0:
                    raise self.error(start, "unterminated comment; close it with *%")
            elif match.lastgroup != "space":
                return Token(str(match.lastgroup), match.group(), start)
        return Token("end", "", len(self._text))

    def place(self, offset: int) -> Tuple[int, int]:
        """Return the line and column, from 1, of an offset in the text."""
        if not self._lines:
            self._lines = [0, *(one.end() for one in re.finditer("\n", self._text))]
        line = bisect_right(self._lines, offset)
        return line, offset - self._lines[line - 1] + 1

    def error(self, offset: int, message: str) -> ProgressionError:
        """Return the error to raise about the text at ``offset``."""
        return ProgressionError(*self.place(offset), message)

    def take(self) -> Token:
        """Consume and return the next token (the ``end`` token stays)."""
        token, self.next = self.next, self._scan()
        return token

    def at(self, *texts: str) -> bool:
        """Return whether the next token is one of ``texts`` (strings have quotes)."""
        return self.next.text in texts

    def accept(self, text: str) -> bool:
        """Consume the next token if it is ``text``, and return whether it was."""
        if self.at(text):
            self.take()
            return True
        return False

    def expect(self, text: str, where: str) -> Token:
        """Consume ``text``, or raise :class:`ProgressionError`: it is missing ``where``."""
        if not self.at(text):
            self.fail(f"expected {text!r} {where}")
        return self.take()

    def fail(self, message: str) -> NoReturn:
        """Raise :class:`ProgressionError` at the next token."""
        text = self.next.text
        quoted = repr(text) if len(text) <= _SHOWN else repr(text[:_SHOWN]) + "..."
        found = "found the end" if self.next.kind == "end" else f"found {quoted}"
        raise self.error(self.next.offset, f"{message}, {found}")


def parse_term(text: str) -> clingo.Symbol:
    """Return the ground term in ``text``.

    Raises ProgressionError (line and column from 1) for anything else.
    """
    tokens = TokenStream(text)
    term = read_term(tokens)
    _expect_end(tokens)
    return term


def parse_atom(text: str) -> clingo.Symbol:
    """Return the ground atom in ``text`` (``p``, ``-p``, ``p(terms)``); a trailing ``.`` is accepted.

    Raises ProgressionError (line and column from 1) for anything else.
    """
    tokens = TokenStream(text)
    atom = read_atom(tokens)
    tokens.accept(".")
    _expect_end(tokens)
    return atom


def read_atom(tokens: TokenStream) -> clingo.Symbol:
    """Read an atom from ``tokens``."""
    positive = not tokens.accept("-")
    if tokens.next.kind != "name" or tokens.at("not"):
        tokens.fail("expected an atom: a name in lower case, like p or p(1)")
    name = tokens.take().text
    return clingo.Function(name, _read_arguments(tokens, 1)[0] if tokens.at("(") else [], positive)


def read_number(tokens: TokenStream, what: str) -> int:
    """Read a number without sign; ``what`` names it in the error."""
    if tokens.next.kind != "number":
        tokens.fail(f"expected {what}, a number")
    return _read_number(tokens, 1)


def read_term(tokens: TokenStream, depth: int = 0) -> clingo.Symbol:
    """Read a term from ``tokens`` that is nested in ``depth`` others."""
    first = tokens.next
    if first.kind == "string":
        text = tokens.take().text
        if tokens.strings_as_constants:
            return clingo.Function(text)
        return clingo.String(_ESCAPE.sub(lambda match: match.group(1).replace("n", "\n"), text[1:-1]))
    if tokens.at(*_LIMITS):
        return _LIMITS[tokens.take().text]
    positive = not tokens.accept("-")
    if tokens.next.kind == "number":
        return clingo.Number(_read_number(tokens, 1 if positive else -1))
    name = tokens.take().text if tokens.next.kind == "name" and not tokens.at("not") else ""
    if not name and not positive:
        tokens.fail("expected a number or a name after '-'")
    if not name and not tokens.at("("):
        tokens.fail('expected a term: a name in lower case, an integer, a "string", f(terms) or a tuple')
    if not tokens.at("("):
        return clingo.Function(name, [], positive)
    if depth >= MAX_DEPTH:
        raise tokens.error(first.offset, f"term nested deeper than {MAX_DEPTH} levels")
    arguments, comma = _read_arguments(tokens, depth + 1, is_tuple=not name)
    if not name and len(arguments) == 1 and not comma:
        return arguments[0]  # a term in parentheses
    return clingo.Function(name, arguments, positive)


def _read_arguments(tokens: TokenStream, depth: int, is_tuple: bool = False) -> Tuple[List[clingo.Symbol], bool]:
    """Return the arguments in parentheses, and whether there was a comma; a tuple can be empty or end with a comma."""
    tokens.take()
    arguments, comma = [], False
    while not (is_tuple and tokens.at(")")):
        arguments.append(read_term(tokens, depth))
        if tokens.at(")"):
            break
        tokens.expect(",", "or ')' after an argument")
        comma = True
    tokens.take()
    return arguments, comma


def _read_number(tokens: TokenStream, sign: int) -> int:
    token = tokens.take()
    # test the length first: int() is slow on thousands of digits, or rejects them
    value = sign * int(token.text) if len(token.text.lstrip("0")) <= 10 else None
    if value is None or not _LOWEST <= value <= _HIGHEST:
        text = token.text if len(token.text) <= 20 else token.text[:20] + "..."
        limits = f"numbers go from {_LOWEST} to {_HIGHEST}"
        raise tokens.error(token.offset, f"number {text} does not fit in 32 bits; {limits}")
    return value


def _expect_end(tokens: TokenStream) -> None:
    if tokens.next.kind != "end":
        tokens.fail("expected one term or atom and nothing after it")
