"""Program texts: read from files with what they include, translated from gringo 3's dialect, parsed by clingo."""

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Dict, List, Mapping, NamedTuple, Optional, Sequence, Set

import clingo
from clingo.ast import AST, ASTSequence, Location, Position, parse_string

from rosoclingo.oclingo.directives import Directives, Placed, take_directives
from rosoclingo.oclingo.errors import Fault, ProgramError, ProgressionError
from rosoclingo.oclingo.messages import Messages
from rosoclingo.oclingo.terms import parse_term

_CONSTANT = re.compile(r"[_']*[a-z][A-Za-z0-9_']*\Z")


@dataclass(frozen=True)
class Source:
    """A program text with the name that messages give to it; ``folder`` is where its includes are looked for."""

    name: str
    text: str
    folder: Optional[Path] = None

    @classmethod
    def from_file(cls, path: Path) -> "Source":
        """Read a file; raise :class:`ProgramError` where it can't be read or is no UTF-8 text."""
        try:
            return cls(str(path), path.read_text(encoding="utf-8"), path.parent)
        except OSError as error:
            raise ProgramError([Fault(str(path), 0, 0, "can't be read: {}".format(error.strerror))]) from None
        except UnicodeDecodeError as error:
            message = "no UTF-8 text: {} at byte {}".format(error.reason, error.start)
            raise ProgramError([Fault(str(path), 0, 0, message, "save the file as UTF-8")]) from None


class Parsed(NamedTuple):
    """A source after parsing."""

    name: str
    statements: List[AST]


def read_sources(sources: Sequence[Source], found: Directives, warnings: List[str]) -> List[Parsed]:
    """Parse ``sources`` and what they include; add oClingo's directives to ``found``.

    Raises ProgramError with all the faults of all files.
    """
    reader = _SourceReader(found, warnings)
    for source in sources:
        reader.read(source)
    if reader.faults:
        raise ProgramError(reader.faults)
    return reader.parsed


class _SourceReader:
    def __init__(self, found: Directives, warnings: List[str]) -> None:
        self._found, self._warnings = found, warnings
        self._seen: Set[Path] = set()
        self.parsed: List[Parsed] = []
        self.faults: List[Fault] = []

    def read(self, source: Source) -> None:
        known = len(self._found.includes)
        try:
            text = translated(source, self._warnings)
        except ProgramError as error:
            self.faults.extend(error.faults)
            return
        text = take_directives(text, source.name, self._found)
        for include in self._found.includes[known:]:
            self._include(source, include)
        self.parsed.append(Parsed(source.name, self._parse(source.name, text)))

    def _include(self, source: Source, include: Placed) -> None:
        folders = [folder for folder in (source.folder, Path()) if folder is not None]
        paths = [folder / include.value for folder in folders if (folder / include.value).is_file()]
        if not paths:
            message = "included file {!r} is not there".format(include.value)
            mend = "looked in {}".format(" and ".join(str(folder.resolve()) for folder in folders))
            self.faults.append(Fault(source.name, include.line, 1, message, mend))
        elif paths[0].resolve() not in self._seen:
            self._seen.add(paths[0].resolve())
            try:
                self.read(Source.from_file(paths[0]))
            except ProgramError as error:
                self.faults.extend(error.faults)

    def _parse(self, name: str, text: str) -> List[AST]:
        messages, statements = Messages(), []  # type: Messages, List[AST]
        try:
            parse_string(text, statements.append, logger=messages.log)
        except RuntimeError:
            self.faults.extend(_named(fault, name) for fault in messages.faults())
        for statement in statements:
            _relocate(statement, name)
        return statements


def translated(source: Source, warnings: List[str]) -> str:
    """Return the text of ``source`` in today's dialect."""
    return source.text


def _named(fault: Fault, name: str) -> Fault:
    message = fault.message.replace("<string>", name)
    return Fault(name if fault.file == "<string>" else fault.file, fault.line, fault.column, message, fault.mend)


def _relocate(node: AST, name: str) -> None:
    """Let ``node`` and all below it say that they stand in file ``name``."""
    if "location" in node.keys():
        begin, end = node.location.begin, node.location.end
        node.location = Location(Position(name, begin.line, begin.column), Position(name, end.line, end.column))
    for key in node.child_keys:
        child = getattr(node, key)
        for one in child if isinstance(child, ASTSequence) else [child]:
            if isinstance(one, AST):
                _relocate(one, name)


def parse_constants(constants: Mapping[str, str]) -> Dict[str, clingo.Symbol]:
    """Return the values of ``-c NAME=VALUE`` constants as symbols; raise :class:`ProgramError` naming each bad one."""
    faults, values = [], {}
    for name, value in constants.items():
        place = "constant {}={}".format(name, value)
        if not _CONSTANT.match(name):
            faults.append(Fault(place, 0, 0, "{!r} is no name for a constant".format(name), "start in lower case"))
            continue
        try:
            values[name] = parse_term(str(value))
        except ProgressionError as error:
            faults.append(Fault(place, 0, 0, "the value is no ground term: {}".format(error.message)))
    if faults:
        raise ProgramError(faults)
    return values
