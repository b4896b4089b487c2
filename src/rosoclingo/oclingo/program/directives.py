"""oClingo's own directives in program texts: found, taken out, and put into today's ``#program`` form.

clingo's parser does not know ``#base.``, ``#cumulative t.``, ``#volatile t : w.``, ``#external p/n.``, ``#forget t :
term.`` and ``#iinit n.``. They are replaced here, line by line in place, so that clingo's messages keep their line
numbers.
"""

import re
from dataclasses import dataclass, field
from typing import Callable, Dict, List, Match, NamedTuple

from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.progression.terms import Signature

VOLATILE_PREFIX = "__oclingo_volatile_"
"""Name of a volatile program part, followed by the index of its window in :attr:`Directives.windows`."""

_NAME = r"[_']*[a-z][A-Za-z0-9_']*"
_SKIP = re.compile(
    r"""
      %(?!\*)[^\n]*
    | "(?:[^"\\\n]|\\.)*"
    | \#script\b.*?\#end\s*\.
    | %\*
    | \*%
    | (?P<strange>[^\x00-\x7f]+)
    | \#(?P<directive>base|cumulative|volatile|external|forget|iinit|include)\b
    """,
    re.VERBOSE | re.DOTALL,
)
_FORMS: Dict[str, str] = {
    "base": r"\s*\.",
    "cumulative": rf"\s+(?P<parameter>{_NAME})\s*\.",
    "volatile": rf"\s+(?P<parameter>{_NAME})\s*(?::\s*(?P<term>[^.:]+?)\s*)?\.",
    "external": rf"\s+(?P<sign>-?)\s*(?P<name>{_NAME})\s*/\s*(?P<arity>[0-9]+)\s*\.",
    "forget": rf"\s+(?P<parameter>{_NAME})\s*:\s*(?P<term>[^.:]+?)\s*\.",
    "iinit": r"\s+(?P<term>[^.:]+?)\s*\.",
    "include": r'\s*"(?P<file>(?:[^"\\\n]|\\.)*)"\s*\.',
}
_PATTERNS = {name: re.compile(form) for name, form in _FORMS.items()}
_MENDS = {
    "base": "write #base.",
    "cumulative": "write #cumulative t.",
    "volatile": "write #volatile t. or #volatile t : w.",
    "forget": "write #forget t : t-3.",
    "iinit": "write #iinit 1.",
}


@dataclass(frozen=True)
class Placed:
    """A directive's value with the place where it stands."""

    value: str
    parameter: str
    file: str
    line: int


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
    reader = _Reader(text, file, found)
    return reader.read()


class _Reader:
    def __init__(self, text: str, file: str, found: Directives) -> None:
        self._text, self._file, self._found = text, file, found
        self._pieces: List[str] = []
        self._copied = 0

    def read(self) -> str:
        """Return the text without its directives."""
        offset, depth = 0, 0
        while True:
            match = _SKIP.search(self._text, offset)
            if match is None:
                self._pieces.append(self._text[self._copied :])
                return "".join(self._pieces)
            offset = match.end()
            if match.group() in ("%*", "*%"):
                depth = max(0, depth + (1 if match.group() == "%*" else -1))
            elif depth and match.group()[0] in '%"':
                offset = match.start() + 1  # inside a block comment quotes and % mean nothing
            elif not depth and match.lastgroup == "strange":
                self._strange(match)
            elif not depth and match.lastgroup == "directive":
                offset = self._directive(match)

    def _strange(self, match: "Match[str]") -> None:
        """Take out what clingo can't even complain about: it cuts such characters in its messages and gives up."""
        line = self._text.count("\n", 0, match.start()) + 1
        column = match.start() - self._text.rfind("\n", 0, match.start())
        message, mend = f"unexpected characters {match.group()!r}", "only strings and comments may hold them"
        self._found.faults.append(Fault(self._file, line, column, message, mend))
        self._pieces.append(self._text[self._copied : match.start()])
        self._copied = match.end()

    def _directive(self, start: "Match[str]") -> int:
        name = start.group("directive")
        match = _PATTERNS[name].match(self._text, start.end())
        line = self._text.count("\n", 0, start.start()) + 1
        if match is None:
            if name in _MENDS:
                message = f"directive #{name} is not written as it must be"
                self._found.faults.append(Fault(self._file, line, 1, message, _MENDS[name]))
            return start.end()  # an ordinary #external or #include is clingo's own
        statement = self._text[start.start() : match.end()]
        self._pieces.append(self._text[self._copied : start.start()])
        self._pieces.append(_HANDLERS[name](self._found, match, self._file, line) + "\n" * statement.count("\n"))
        self._copied = match.end()
        return match.end()


def _volatile(found: Directives, match: "Match[str]", file: str, line: int) -> str:
    found.windows.append(Placed(match.group("term") or "1", match.group("parameter"), file, line))
    return "#program {}{}({}).".format(VOLATILE_PREFIX, len(found.windows) - 1, match.group("parameter"))


def _external(found: Directives, match: "Match[str]", file: str, line: int) -> str:
    signature = Signature(match.group("name"), int(match.group("arity")), not match.group("sign"))
    found.opened.append(Opened(signature, file, line))
    return ""


def _forget(found: Directives, match: "Match[str]", file: str, line: int) -> str:
    found.forgets.append(Placed(match.group("term"), match.group("parameter"), file, line))
    return ""


def _iinit(found: Directives, match: "Match[str]", file: str, line: int) -> str:
    found.first_steps.append(Placed(match.group("term"), "", file, line))
    return ""


def _include(found: Directives, match: "Match[str]", file: str, line: int) -> str:
    return ""  # the file has been added to the program's sources


_HANDLERS: Dict[str, Callable[[Directives, "Match[str]", str, int], str]] = {
    "base": lambda found, match, file, line: "#program base.",
    "cumulative": lambda found, match, file, line: "#program cumulative({}).".format(match.group("parameter")),
    "volatile": _volatile,
    "external": _external,
    "forget": _forget,
    "iinit": _iinit,
    "include": _include,
}
