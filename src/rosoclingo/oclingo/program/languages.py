"""Files of a program that are in a language of their own, by their names' endings: translated as they are read."""

import importlib
import re
from pathlib import PurePath
from typing import NamedTuple, Optional, Tuple

PLACE = "rosoclingo.languages"
"""The package whose modules translate, each the files that end on its name."""

_ENDING = re.compile(r"\.[a-z][a-z0-9_]*\Z")


class Translation(NamedTuple):
    """A file as a reactive logic program: the text, one statement on a line, and the line and column each is of."""

    text: str
    places: Tuple[Tuple[int, int], ...]

    def place(self, line: int) -> Tuple[int, int]:
        """Return the line and column of the file from which a line of the text comes."""
        return self.places[line - 1] if 0 < line <= len(self.places) else (1, 1)


def translation_of(text: str, name: str) -> Optional[Translation]:
    """Return the translation of a file, None where it needs none; raises ProgramError with all its faults."""
    ending = PurePath(name).suffix
    if not _ENDING.match(ending):
        return None
    try:
        module = importlib.import_module(PLACE + ending)
    except ModuleNotFoundError as error:
        if error.name in (PLACE, PLACE + ending):
            return None
        raise
    found: Translation = module.translate(text, name)
    return found
