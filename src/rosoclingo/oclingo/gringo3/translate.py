"""Translation of programs of gringo 3 and oClingo into clingo 5's language.

The translation changes only what differs and preserves comments, layout and line numbers. It keeps oClingo's own
directives, with the separators of clingo 5 inside.
"""

from dataclasses import dataclass
from typing import List, Sequence, Tuple

from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.gringo3.dialect import Dialect, SourceFile
from rosoclingo.oclingo.gringo3.lexer import TokenKind, tokens


@dataclass(frozen=True)
class TranslationResult:
    """A program in clingo 5's language, the remarks of the translation, and the original language."""

    text: str
    remarks: Tuple[Fault, ...] = ()
    dialect: Dialect = Dialect.EITHER

    @property
    def warnings(self) -> Tuple[str, ...]:
        """The remarks as texts."""
        return tuple(map(str, self.remarks))


def translate(text: str, filename: str, undecided: Dialect = Dialect.CLINGO5) -> TranslationResult:
    """Translate a program of a single file; see :func:`translate_program`."""
    return translate_program([(filename, text)], undecided)[0]


def translate_program(
    files: Sequence[Tuple[str, str]], undecided: Dialect = Dialect.CLINGO5
) -> Tuple[TranslationResult, ...]:
    """Translate a program of several files, given as pairs of name and text in load order.

    ``#domain``, ``#hide``, ``#show``, ``#const`` and the order of optimization statements affect later files, so pass
    all files of a program in one call. Files in clingo 5's language are returned unchanged. ``undecided`` is the
    language of ambiguous files.

    Raises :class:`TranslationError` with all faults of all files.
    """
    sources = [SourceFile(name, text) for name, text in files]
    known = [one.pragma or one.by_directives for one in sources]
    common = Dialect.CLINGO5 if Dialect.CLINGO5 in known else None
    decided = [one.reads_alike or (its or common) is Dialect.CLINGO5 for one, its in zip(sources, known)]
    if all(decided) and all(one.is_plain for one in sources):
        return tuple(TranslationResult(one.text, (), its or Dialect.EITHER) for one, its in zip(sources, known))
    from rosoclingo.oclingo.gringo3.file_translator import translate_sources  # noqa: PLC0415 most programs do not need it

    return tuple(TranslationResult(*found) for found in translate_sources(sources, undecided))


def included_files(text: str) -> List[Tuple[str, int]]:
    """Return the file names in ``#include`` statements with their lines, for both languages.

    The loader needs these names before the translation, because all files of a program are translated together.
    """
    found = tokens(text) if "#include" in text else []
    pairs = zip(found, found[1:])
    return [
        (name.text[1:-1], name.line)
        for word, name in pairs
        if word.text == "#include" and name.kind is TokenKind.STRING
    ]
