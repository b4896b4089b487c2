"""Program texts: reading of files and their includes, translation from other languages, parsing by clingo."""

import os
import re
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import Dict, List, Mapping, Optional, Sequence, Set

import clingo
from clingo.ast import Position

from rosoclingo.oclingo.errors import Fault, ProgramError, ProgressionError
from rosoclingo.oclingo.gringo3 import included_files, translate_program
from rosoclingo.oclingo.gringo3.lexer import SourceToken, statements, tokens
from rosoclingo.oclingo.program.clingo_messages import Messages
from rosoclingo.oclingo.program.directives import Directives, take_directives
from rosoclingo.oclingo.program.endings import locate_missing_dot
from rosoclingo.oclingo.program.languages import Document, Include, Translation, language_of
from rosoclingo.oclingo.program.nodes import Node, parse
from rosoclingo.oclingo.progression.terms import parse_term
from rosoclingo.oclingo.reachable import reachable

_CONSTANT = re.compile(r"[_']*[a-z][A-Za-z0-9_']*\Z")


@dataclass(frozen=True)
class Source:
    """A program text with its name in messages; ``folder`` is the first folder for its includes."""

    name: str
    text: str
    folder: Optional[Path] = None

    @classmethod
    def from_file(cls, path: Path) -> "Source":
        """Read a file; raise :class:`ProgramError` if that fails or the file is not UTF-8 text."""
        try:
            return cls(str(path), path.read_text(encoding="utf-8"), path.parent)
        except OSError as error:
            raise ProgramError([Fault(str(path), 0, 0, f"can't be read: {error.strerror}")]) from None
        except UnicodeDecodeError as error:
            message = f"not UTF-8 text: {error.reason} at byte {error.start}"
            raise ProgramError([Fault(str(path), 0, 0, message, "save the file as UTF-8")]) from None


def read_sources(
    sources: Sequence[Source], found: Directives, remarks: List[Fault], whole: bool = False
) -> List["LoadedFile"]:
    """Parse ``sources`` and the files that they include; add oClingo's directives to ``found``.

    The texts can be in any supported language. ``whole`` means that ``sources`` contain all included files. Raises
    ProgramError with the faults of all files.
    """
    collector = Collector(sources, whole)
    faults = list(collector.faults)
    try:
        results = translate_program([(one.source.name, one.text) for one in collector.files])
        for one, result in zip(collector.files, results):
            remarks.extend(result.remarks)
            one.statements = _parse(one, result.text, found, faults)
    except ProgramError as error:
        faults.extend(error.faults)
    if faults or found.faults:
        raise ProgramError([*found.faults, *faults])
    return collector.files


@dataclass(eq=False)
class LoadedFile:
    """A text of a program.

    Attributes:
        source: the original text.
        document: the parsed text if it is in a further language, such as Golog.
        text: the text in the language of clingo or gringo 3.
        translation: the origin of the lines of this text, if it was translated.
        includes: the included files, None for missing ones.
        statements: the statements of the text.

    """

    source: Source
    document: Optional[Document]
    text: str
    translation: Optional[Translation] = None
    includes: List[Optional["LoadedFile"]] = field(default_factory=list)
    statements: Sequence[Node] = ()


class Collector:
    """The files of a program and their includes, each file once, translated together.

    Included files are read from disk. If the sources are the whole program, they are looked up by name among these.
    """

    def __init__(self, sources: Sequence[Source], whole: bool = False) -> None:
        self._given = {os.path.normpath(one.name): one for one in sources} if whole else {}
        self._unreadable: Set[Path] = set()
        self.files: List[LoadedFile] = []
        self.faults: List[Fault] = []
        for source in sources:
            self._add(source)
        self._translate()

    def _add(self, source: Source) -> LoadedFile:
        """Add a source and its includes, unless it was added before; return its file."""
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
            file.includes.append(None if included is None else self._add(included))
        return file

    def _find(self, source: Source, wanted: Include) -> Optional[Source]:
        """Return the file that a source includes, None if it is missing or unreadable."""
        if self._given:
            relative = os.path.join(os.path.dirname(source.name), wanted.name)
            found = (self._given.get(os.path.normpath(name)) for name in (relative, wanted.name))
            return next((one for one in found if one is not None), None)
        folders = [folder for folder in (source.folder, Path()) if folder is not None]
        path = next((folder / wanted.name for folder in folders if (folder / wanted.name).is_file()), None)
        if path is None:
            remedy = f"looked in {' and '.join(dict.fromkeys(str(folder.resolve()) for folder in folders))}"
            message = f"included file {wanted.name!r} does not exist"
            self.faults.append(Fault(source.name, wanted.line, wanted.column, message, remedy))
        elif path.resolve() not in self._unreadable:
            try:
                return Source.from_file(path)
            except ProgramError as error:
                self.faults.extend(error.faults)
                self._unreadable.add(path.resolve())
        return None

    def _translate(self) -> None:
        """Translate the files in further languages."""
        files = [one for one in self.files if one.document is not None]
        language = language_of(files[0].source.name) if files else None
        if language is None:
            return
        included = [[self._indices_of_included(other, files) for other in one.includes] for one in files]
        try:
            found = language.translate_files([one.document for one in files], included)
            for one, translation in zip(files, found):
                one.translation, one.text = translation, translation.text
        except ProgramError as error:
            self.faults.extend(error.faults)
            for one in files:
                one.text = ""

    def _indices_of_included(self, file: Optional[LoadedFile], wanted: Sequence[LoadedFile]) -> List[int]:
        """Return the indices in ``wanted`` of the files that an include adds, directly or indirectly."""
        found = reachable([file], lambda one: () if one is None or one in wanted else one.includes)
        return [number for number, one in enumerate(wanted) if one in found]


def _parse(file: LoadedFile, text: str, found: Directives, faults: List[Fault]) -> Sequence[Node]:
    name, plain = file.source.name, take_directives(text, file.source.name, found)
    try:
        return _parse_text(plain, name, file.translation)
    except ProgramError as error:
        for fault in error.faults:  # clingo names the text <string>
            place, message = fault.file.replace("<string>", name), fault.message.replace("<string>", name)
            faults.append(locate_missing_dot(replace(fault, file=place, message=message), text))
        return ()


@lru_cache(maxsize=32)  # programs with common files are loaded repeatedly
def _parse_text(text: str, name: str, translation: Optional[Translation]) -> Sequence[Node]:
    """Return the statements of a text, with the positions of the file ``name``; raises ProgramError."""

    def place(one: Position) -> Position:
        return Position(name, *(translation.place(one.line) if translation else (one.line, one.column)))

    messages = Messages()
    try:
        statements = parse(text, messages.log)
    except RuntimeError as error:
        raise ProgramError(messages.faults(error)) from None
    for statement in statements:
        statement.move(place)
    return statements


def statement_at(sources: Sequence[Source], file: str, line: int, column: int) -> str:
    """Return the statement at a place of one of the ``sources`` on a single line, "" if there is none.

    A translation keeps lines but not columns, so the result is the last statement that begins before the place.
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
    """Return the values of ``-c NAME=VALUE`` constants as symbols; raise ProgramError with all faults."""
    faults, values = [], {}
    for name, value in constants.items():
        place = f"constant {name}={value}"
        if not _CONSTANT.match(name):
            faults.append(
                Fault(place, 0, 0, f"{name!r} is not a valid name of a constant", "start with a lower-case letter")
            )
            continue
        try:
            values[name] = parse_term(str(value))
        except ProgressionError as error:
            faults.append(Fault(place, 0, 0, f"the value is not a term: {error.message}"))
    if faults:
        raise ProgramError(faults)
    return values
