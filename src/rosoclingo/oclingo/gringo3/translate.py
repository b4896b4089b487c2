"""Translates programs of gringo 3 and oClingo into clingo 5's language.

Only differing parts change; comments, layout and line numbers stay. oClingo's own directives stay too, with today's
separators inside.
"""

from dataclasses import dataclass
from typing import List, Sequence, Tuple

from rosoclingo.oclingo.gringo3.dialect import Dialect, SourceFile
from rosoclingo.oclingo.gringo3.lexer import TokenKind, tokens


@dataclass(frozen=True)
class TranslationResult:
    """A program in clingo 5's language, warnings about it, and the language that it was in."""

    text: str
    warnings: Tuple[str, ...] = ()
    dialect: Dialect = Dialect.EITHER


def translate(text: str, filename: str, undecided: Dialect = Dialect.CLINGO5) -> TranslationResult:
    """Translate a program of a single file; see :func:`translate_program`."""
    return translate_program([(filename, text)], undecided)[0]


def translate_program(
    files: Sequence[Tuple[str, str]], undecided: Dialect = Dialect.CLINGO5
) -> Tuple[TranslationResult, ...]:
    """Translate a program of several files, given as names and texts in the order in which they are loaded.

    ``#domain``, ``#hide``, ``#show``, ``#const`` and the order of optimization statements reach from file to file, so
    the files of a program belong into one call. Files in clingo 5's language come back as they are. ``undecided`` is
    the language of files that read differently in both languages and hold nothing to tell which one is meant.

    Raises :class:`TranslationError` with all faults of all files.
    """
    sources = [SourceFile(name, text) for name, text in files]
    known = [one.pragma or one.by_directives for one in sources]
    common = Dialect.CLINGO5 if Dialect.CLINGO5 in known else None
    decided = [one.reads_alike or (its or common) is Dialect.CLINGO5 for one, its in zip(sources, known)]
    if all(decided) and all(one.is_plain for one in sources):
        return tuple(TranslationResult(one.text, (), its or Dialect.EITHER) for one, its in zip(sources, known))
    from rosoclingo.oclingo.gringo3.file_translator import translated  # noqa: PLC0415 most programs are clingo's

    return tuple(TranslationResult(*found) for found in translated(sources, undecided))


def included_files(text: str) -> List[Tuple[str, int]]:
    """The files that ``#include`` statements name, each with its line, in either language.

    A program's files have to be translated together, so their loader needs these names before the translation.
    """
    found = tokens(text) if "#include" in text else []
    pairs = zip(found, found[1:])
    return [
        (name.text[1:-1], name.line)
        for word, name in pairs
        if word.text == "#include" and name.kind is TokenKind.STRING
    ]
