"""Files of a program that are in a language of their own, by their names' endings: translated as they are read.

A language is a module of :data:`LANGUAGES` with two functions: ``read(text, name)`` returns a :class:`Document`,
whatever the text; ``translate_files(documents, included)`` a :class:`Translation` of each, or raises ProgramError with
all their faults. ``included`` has for each document, for each of its ``includes``, the numbers of the documents that it
brings in.
"""

import importlib
from pathlib import PurePath
from types import ModuleType
from typing import Any, NamedTuple, Optional, Tuple

LANGUAGES = {".golog": "rosoclingo.golog"}
"""The modules that translate, by the ending of the files that they are for; each is imported where one is met."""


class Include(NamedTuple):
    """A file's name as another one names it, with the line and column where it does so."""

    name: str
    line: int
    column: int


class Document(NamedTuple):
    """A file as its language reads it: its name, the files that it includes, and what is the language's own."""

    name: str
    includes: Tuple[Include, ...]
    content: Any


class Translation(NamedTuple):
    """A file as a reactive logic program: the text, one statement on a line, and the line and column each is of."""

    text: str
    places: Tuple[Tuple[int, int], ...]

    def place(self, line: int) -> Tuple[int, int]:
        """Return the line and column of the file from which a line of the text comes."""
        return self.places[line - 1] if 0 < line <= len(self.places) else (1, 1)


def language_of(name: str) -> Optional[ModuleType]:
    """Return the language that a file of this name is in, None where that is clingo's, or gringo 3's."""
    module = LANGUAGES.get(PurePath(name).suffix)
    return importlib.import_module(module) if module else None
