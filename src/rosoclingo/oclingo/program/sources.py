"""Program texts: read from files with what they include, translated from other languages, parsed by clingo."""

import os
import re
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Dict, List, Mapping, NamedTuple, Optional, Sequence, Set

import clingo
from clingo.ast import Position

from rosoclingo.oclingo.errors import Fault, ProgramError, ProgressionError
from rosoclingo.oclingo.gringo3 import included_files, translate_program
from rosoclingo.oclingo.gringo3.lexer import SourceToken, statements, tokens
from rosoclingo.oclingo.program.clingo_messages import Messages
from rosoclingo.oclingo.program.directives import Directives, take_directives
from rosoclingo.oclingo.program.endings import ended_before
from rosoclingo.oclingo.program.languages import Document, Include, Translation, language_of
from rosoclingo.oclingo.program.nodes import Node, parse
from rosoclingo.oclingo.progression.terms import parse_term

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
            raise ProgramError([Fault(str(path), 0, 0, f"can't be read: {error.strerror}")]) from None
        except UnicodeDecodeError as error:
            message = f"no UTF-8 text: {error.reason} at byte {error.start}"
            raise ProgramError([Fault(str(path), 0, 0, message, "save the file as UTF-8")]) from None


class Parsed(NamedTuple):
    """A source after parsing."""

    source: Source
    statements: List[Node]


def read_sources(
    sources: Sequence[Source], found: Directives, remarks: List[Fault], whole: bool = False
) -> List[Parsed]:
    """Parse ``sources`` and what they include, in either dialect; add oClingo's directives to ``found``.

    With ``whole`` all that they include is among them. Raises ProgramError with all the faults of all files.
    """
    collector = Collector(sources if whole else ())
    for source in sources:
        collector.add(source)
    collector.translate()
    texts: Sequence[str] = ()
    faults = list(collector.faults)
    try:
        results = translate_program([(one.source.name, one.text) for one in collector.files])
        texts = [result.text for result in results]
        for one, result in zip(collector.files, results):
            remarks.extend(_remark(one.source.name, warning) for warning in result.warnings)
    except ProgramError as error:
        faults.extend(error.faults)
    pairs = zip(collector.files, texts)
    parsed = [_parse(one.source, text, found, faults, one.translation) for one, text in pairs]
    if faults or found.faults:
        raise ProgramError([*found.faults, *faults])
    return parsed


@dataclass(eq=False)
class LoadedFile:
    """A text of a program.

    Attributes:
        source: the text as it is.
        document: how its language reads it, if it has one of its own.
        text: it in clingo's language or gringo 3's.
        translation: where the lines of this text come from, if it was translated.
        includes: the files that it includes, None for those that are not there.

    """

    source: Source
    document: Optional[Document]
    text: str
    translation: Optional[Translation] = None
    includes: List[Optional["LoadedFile"]] = field(default_factory=list)


class Collector:
    """Follows includes, each file once; the files of a program are translated together.

    Files are read; but if all texts of a program are given, an included one is that of its name among them.
    """

    def __init__(self, given: Sequence[Source] = ()) -> None:
        self._given = {os.path.normpath(one.name): one for one in given}
        self._unreadable: Set[Path] = set()
        self.files: List[LoadedFile] = []
        self.faults: List[Fault] = []

    def add(self, source: Source) -> LoadedFile:
        """Take a source and all that it includes, unless it was included or named before; return its file."""
        path = Path(source.name).resolve()
        known = (one for one in self.files if Path(one.source.name).resolve() == path)
        before = next((one for one in known if one.source.text == source.text), None)
        if before is not None:
            return before
        language = language_of(source.name)
        file = LoadedFile(source, language.read(source.text, source.name) if language else None, source.text)
        self.files.append(file)
        own = (Include(name, line, 1) for name, line in included_files(source.text))
        for one in file.document.includes if file.document else own:
            included = self._find(source, one)
            file.includes.append(None if included is None else self.add(included))
        return file

    def _find(self, source: Source, wanted: Include) -> Optional[Source]:
        """Return the file that a source includes, None if it is not there or cannot be read."""
        if self._given:
            beside = os.path.join(os.path.dirname(source.name), wanted.name)
            found = (self._given.get(os.path.normpath(name)) for name in (beside, wanted.name))
            return next((one for one in found if one is not None), None)
        folders = [folder for folder in (source.folder, Path()) if folder is not None]
        path = next((folder / wanted.name for folder in folders if (folder / wanted.name).is_file()), None)
        if path is None:
            mend = f"looked in {' and '.join(dict.fromkeys(str(folder.resolve()) for folder in folders))}"
            message = f"included file {wanted.name!r} is not there"
            self.faults.append(Fault(source.name, wanted.line, wanted.column, message, mend))
        elif path.resolve() not in self._unreadable:
            try:
                return Source.from_file(path)
            except ProgramError as error:
                self.faults.extend(error.faults)
                self._unreadable.add(path.resolve())
        return None

    def translate(self) -> None:
        """Translate what is in a language of its own."""
        files = [one for one in self.files if one.document is not None]
        language = language_of(files[0].source.name) if files else None
        if language is None:
            return
        included = [[self._brought(other, files) for other in one.includes] for one in files]
        try:
            found = language.translate_files([one.document for one in files], included)
            for one, translation in zip(files, found):
                one.translation, one.text = translation, translation.text
        except ProgramError as error:
            self.faults.extend(error.faults)
            for one in files:
                one.text = ""

    def _brought(self, file: Optional[LoadedFile], wanted: Sequence[LoadedFile]) -> List[int]:
        """Return the places among the ``wanted`` files of those that an include brings in."""
        found: List[int] = []
        waiting, seen = [file], {file}
        while waiting:
            one = waiting.pop()
            if one in wanted:
                found.append(wanted.index(one))
            elif one is not None:
                waiting += [other for other in one.includes if other not in seen]
                seen.update(one.includes)
        return sorted(found)


def _parse(
    source: Source, text: str, found: Directives, faults: List[Fault], translation: Optional[Translation] = None
) -> Parsed:
    name, messages = source.name, Messages()
    try:
        statements = parse(take_directives(text, name, found), messages.log)
    except RuntimeError as error:
        faults.extend(ended_before(_named(fault, name), text) for fault in messages.faults(error))
        return Parsed(source, [])

    def place(one: Position) -> Position:
        """Return where it stands in the file, which may have been translated."""
        line, column = (one.line, one.column) if translation is None else translation.place(one.line)
        return Position(name, line, column)

    for statement in statements:
        statement.move(place)
    return Parsed(source, statements)


def _remark(name: str, text: str) -> Fault:
    """Return what the translation says of a file, NAME:LINE:COLUMN: MESSAGE."""
    line, column, message = text[len(name) + 1 :].split(":", 2)
    return Fault(name, int(line), int(column), message.strip(), kind="translation")


def _named(fault: Fault, name: str) -> Fault:
    message = fault.message.replace("<string>", name)
    return replace(fault, file=name if fault.file == "<string>" else fault.file, message=message)


def statement_at(sources: Sequence[Source], file: str, line: int, column: int) -> str:
    """Return the statement at a place of one of the ``sources``, as written there but on one line; else "".

    A translation keeps lines, but not columns, so the last statement that begins before the place counts.
    """
    text = next((one.text for one in sources if one.name == file and language_of(file) is None), "")
    all_tokens = tokens(text)
    found: Sequence[SourceToken] = ()
    for first, after in statements(all_tokens):
        begin = all_tokens[first]
        if (begin.line, begin.column) > (line, column) and (found or begin.line > line):
            break
        found = all_tokens[first:after] if all_tokens[after - 1].line >= line else ()
    pairs = zip(found, found[1:])
    return "".join(
        [*(one.text + " " * (one.end < other.start) for one, other in pairs), *(one.text for one in found[-1:])]
    )


def parse_constants(constants: Mapping[str, str]) -> Dict[str, clingo.Symbol]:
    """Return the values of ``-c NAME=VALUE`` constants as symbols; raise :class:`ProgramError` naming each bad one."""
    faults, values = [], {}
    for name, value in constants.items():
        place = f"constant {name}={value}"
        if not _CONSTANT.match(name):
            faults.append(Fault(place, 0, 0, f"{name!r} is no name for a constant", "start in lower case"))
            continue
        try:
            values[name] = parse_term(str(value))
        except ProgressionError as error:
            faults.append(Fault(place, 0, 0, f"the value is no term: {error.message}"))
    if faults:
        raise ProgramError(faults)
    return values
