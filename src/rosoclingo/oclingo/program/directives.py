"""oClingo's own directives in program texts: found, taken out, and put into today's ``#program`` form.

clingo's parser does not know ``#base.``, ``#cumulative t.``, ``#volatile t : w.``, ``#external p/n.``, ``#forget t :
term.`` and ``#iinit n.``. They are replaced here, line by line in place, so that clingo's messages keep their line
numbers.
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

_STRANGE = re.compile(r"[^\x00-\x7f]+")
_NAME = r"(?P<name>[_']*[a-z][A-Za-z0-9_']*)"
_FORMS = {
    "#base": (r"\.", "write #base."),
    "#cumulative": (rf"{_NAME}\.", "write #cumulative t."),
    "#volatile": (rf"{_NAME}(:(?P<term>[^:]+))?\.", "write #volatile t. or #volatile t : w."),
    "#forget": (rf"{_NAME}:(?P<term>[^:]+)\.", "write #forget t : t-3."),
    "#iinit": (r"(?P<term>[^:]+)\.", "write #iinit 1."),
}
"""Each directive without its spaces, and how it is written."""


@dataclass(frozen=True)
class Placed:
    """A directive's term, its step parameter, "" where it has none, and its place."""

    value: str
    parameter: str
    file: str
    line: int

    def number(self, constants: Mapping[str, clingo.Symbol], faults: List[Fault], step: int = 1) -> int:
        """Return the value of the term under constants, at a step; 1 and a fault where it has none."""
        try:
            term = parse(f"value({self.value}).", lambda code, text: None)[-1].head.atom.symbol.arguments[0]
        except RuntimeError:
            faults.append(Fault(self.file, self.line, 1, f"{self.value!r} is no term"))
            return 1
        value = evaluate(term, {**constants, **({self.parameter: clingo.Number(step)} if self.parameter else {})})
        if value is None or value.type != clingo.SymbolType.Number:
            mend = "write a number, or a name that a #const gives a number"
            faults.append(Fault(self.file, self.line, 1, f"{self.value!r} is no number", mend))
            return 1
        return value.number


class Opened(NamedTuple):
    """A predicate of ``#external p/n.`` with the place where it stands."""

    signature: Signature
    file: str
    line: int


@dataclass
class Directives:
    """What oClingo's directives in a program say, in order of appearance."""

    windows: List[Placed] = field(default_factory=list)
    opened: List[Opened] = field(default_factory=list)
    forgets: List[Placed] = field(default_factory=list)
    first_steps: List[Placed] = field(default_factory=list)
    faults: List[Fault] = field(default_factory=list)


def take_directives(text: str, file: str, found: Directives) -> str:
    """Return ``text`` in clingo's syntax, all lines kept, and add its directives to ``found``."""
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
        for one in statement:  # clingo cuts such characters in its messages and gives up
            strange = _STRANGE.match(text, one.start) if one.kind is TokenKind.UNKNOWN and one.start >= copied else None
            if strange:
                message, mend = f"unexpected characters {strange[0]!r}", "only strings and comments may hold them"
                found.faults.append(Fault(file, one.line, one.column, message, mend))
                pieces.append(text[copied : strange.start()])
                copied = strange.end()
    return "".join([*pieces, text[copied:]])


def _replacement(statement: Sequence[SourceToken], file: str, found: Directives) -> Optional[str]:
    """Return the text for clingo in place of a directive, None for any other statement; note its value."""
    word, line, words = statement[0].text, statement[0].line, [one.text for one in statement]
    if is_signature(statement):
        found.opened.append(Opened(Signature(words[-4], int(words[-2]), words[1] != "-"), file, line))
        return ""
    if word == "#include" and len(words) > 1 and statement[1].kind is TokenKind.STRING:
        return ""  # the file has been added to the program's sources
    if word not in _FORMS:
        return None
    form, mend = _FORMS[word]
    match = re.fullmatch(form, "".join(words[1:]))
    if match is None:
        found.faults.append(Fault(file, line, 1, f"directive {word} is not written as it must be", mend))
        return None
    parts = {"name": "", "term": "1", **{name: part for name, part in match.groupdict().items() if part}}
    placed = Placed(parts["term"], parts["name"], file, line)
    if word == "#volatile":
        found.windows.append(placed)
        return f"#program {VOLATILE_PREFIX}{len(found.windows) - 1}({placed.parameter})."
    if word in ("#forget", "#iinit"):
        (found.forgets if word == "#forget" else found.first_steps).append(placed)
        return ""
    return f"#program cumulative({placed.parameter})." if placed.parameter else "#program base."
