"""Further languages of program files, selected by file suffix and translated on loading.

A language is a module of :data:`LANGUAGES` with two functions:

* ``read(text, name)`` returns a :class:`Document` for any text.
* ``translate_files(documents, included)`` returns a :class:`Translation` of each document, or raises ProgramError with
  the faults of all documents. ``included[i][j]`` lists the indices of the documents that the j-th include of document
  i adds, directly or indirectly.
"""

import importlib
from pathlib import PurePath
from types import ModuleType
from typing import Any, NamedTuple, Optional, Tuple

LANGUAGES = {".golog": "rosoclingo.golog"}
"""The translating module for each file suffix; it is imported when such a file is loaded."""


class Include(NamedTuple):
    """The name of an included file, with the line and column of the include."""

    name: str
    line: int
    column: int


class Document(NamedTuple):
    """A parsed file: its name, its includes, and content in a form that only its language knows."""

    name: str
    includes: Tuple[Include, ...]
    content: Any


class Translation(NamedTuple):
    """A file translated to a reactive logic program: one statement a line, and the original place of each line."""

    text: str
    places: Tuple[Tuple[int, int], ...]

    def place(self, line: int) -> Tuple[int, int]:
        """Return the line and column of the original file for a line of the text."""
        return self.places[line - 1] if 0 < line <= len(self.places) else (1, 1)


def language_of(name: str) -> Optional[ModuleType]:
    """Return the language of a file with this name, None for the languages of clingo and gringo 3."""
    module = LANGUAGES.get(PurePath(name).suffix)
    return importlib.import_module(module) if module else None
