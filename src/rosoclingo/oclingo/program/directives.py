"""oClingo's directives in program texts, and their replacement by clingo's ``#program`` statements.

clingo's parser does not know ``#base.``, ``#cumulative t.``, ``#volatile t : w.``, ``#external p/n.``, ``#forget t :
term.`` and ``#iinit n.``. The replacement keeps all newlines, so that clingo's messages have the right line numbers.
"""

import re
from dataclasses import dataclass, field
from typing import List, Mapping, NamedTuple, Optional, Sequence

import clingo

from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.gringo3.dialect import is_signature
from rosoclingo.oclingo.gringo3.lexer import SourceToken, TokenKind, statements, tokens
from rosoclingo.oclingo.program.nodes import parse
from rosoclingo.oclingo.program.signatures import evaluate
from rosoclingo.oclingo.progression.terms import Signature

VOLATILE_PREFIX = "__oclingo_volatile_"
"""Name of a volatile program part, followed by the index of its window in :attr:`Directives.windows`."""

_NON_ASCII = re.compile(r"[^\x00-\x7f]+")
_NAME = r"(?P<name>[_']*[a-z][A-Za-z0-9_']*)"
_FORMS = {
    "#base": (r"\.", "write #base."),
    "#cumulative": (rf"{_NAME}\.", "write #cumulative t."),
    "#volatile": (rf"{_NAME}(:(?P<term>[^:]+))?\.", "write #volatile t. or #volatile t : w."),
    "#forget": (rf"{_NAME}:(?P<term>[^:]+)\.", "write #forget t : t-3."),
    "#iinit": (r"(?P<term>[^:]+)\.", "write #iinit 1."),
}
"""For each directive, a pattern for the rest of its text without spaces, and a fix for malformed ones."""


@dataclass(frozen=True)
class DirectiveTerm:
    """The term of a directive, with its place and its step parameter ("" if it has none)."""

    value: str
    parameter: str
    file: str
    line: int

    def number(self, constants: Mapping[str, clingo.Symbol], faults: List[Fault], step: int = 1) -> int:
        """Return the number that the term denotes at a step; if there is none, add a fault and return 1."""
        try:
            term = parse(f"value({self.value}).", lambda code, text: None)[-1].head.atom.symbol.arguments[0]
        except RuntimeError:
            faults.append(Fault(self.file, self.line, 1, f"{self.value!r} is not a term"))
            return 1
        value = evaluate(term, {**constants, **({self.parameter: clingo.Number(step)} if self.parameter else {})})
        if value is None or value.type != clingo.SymbolType.Number:
            remedy = "write a number, or a constant that a #const defines as one"
            faults.append(Fault(self.file, self.line, 1, f"{self.value!r} is not a number", remedy))
            return 1
        return value.number


class OpenExternal(NamedTuple):
    """A predicate that ``#external p/n.`` opens, with the place of this directive."""

    signature: Signature
    file: str
    line: int


@dataclass
class Directives:
    """The oClingo directives of a program, in order of appearance."""

    windows: List[DirectiveTerm] = field(default_factory=list)
    opened: List[OpenExternal] = field(default_factory=list)
    forgets: List[DirectiveTerm] = field(default_factory=list)
    first_steps: List[DirectiveTerm] = field(default_factory=list)
    faults: List[Fault] = field(default_factory=list)


def take_directives(text: str, file: str, found: Directives) -> str:
    """Return ``text`` in clingo's syntax with the same lines, and add its directives to ``found``."""
    all_tokens = tokens(text)
    pieces: List[str] = []
    copied = 0
    for start, after in statements(all_tokens):
        statement = all_tokens[start:after]
        new = _replacement(statement, file, found)
        if new is not None:
            begin, end = statement[0].start, statement[-1].end
            pieces += [text[copied:begin], new, "\n" * text.count("\n", begin, end)]
            copied = end
            continue
        for one in statement:  # clingo's module fails if a message cuts such a character
            strange = (
                _NON_ASCII.match(text, one.start) if one.kind is TokenKind.UNKNOWN and one.start >= copied else None
            )
            if strange:
                message, remedy = f"unexpected characters {strange[0]!r}", "only strings and comments can contain them"
                found.faults.append(Fault(file, one.line, one.column, message, remedy))
                pieces.append(text[copied : strange.start()])
                copied = strange.end()
    return "".join([*pieces, text[copied:]])


def _replacement(statement: Sequence[SourceToken], file: str, found: Directives) -> Optional[str]:
    """Return clingo's text for a directive and record its value; None for any other statement."""
    word, line, words = statement[0].text, statement[0].line, [one.text for one in statement]
    if is_signature(statement):
        found.opened.append(OpenExternal(Signature(words[-4], int(words[-2]), words[1] != "-"), file, line))
        return ""
    if word == "#include" and len(words) > 1 and statement[1].kind is TokenKind.STRING:
        return ""  # the collector has added the file to the program's sources
    if word not in _FORMS:
        return None
    form, remedy = _FORMS[word]
    match = re.fullmatch(form, "".join(words[1:]))
    if match is None:
        found.faults.append(Fault(file, line, 1, f"directive {word} is malformed", remedy))
        return None
    parts = {"name": "", "term": "1", **{name: part for name, part in match.groupdict().items() if part}}
    placed = DirectiveTerm(parts["term"], parts["name"], file, line)
    if word == "#volatile":
        found.windows.append(placed)
        return f"#program {VOLATILE_PREFIX}{len(found.windows) - 1}({placed.parameter})."
    if word in ("#forget", "#iinit"):
        (found.forgets if word == "#forget" else found.first_steps).append(placed)
        return ""
    return f"#program cumulative({placed.parameter})." if placed.parameter else "#program base."
