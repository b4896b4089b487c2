"""Translates programs of gringo 3 and oClingo into clingo 5's language.

Only what differs is changed; comments, layout and line numbers stay. oClingo's own directives stay too, with today's
separators inside.
"""

from dataclasses import dataclass
from typing import List, Sequence, Tuple

from rosoclingo.oclingo.gringo3.dialect import Dialect, FileDialect, decide, inspect
from rosoclingo.oclingo.gringo3.lexer import Kind, tokens

MARK = "% dialect: clingo 5"
"""Comment put at the end of a translation that could be taken for gringo 3's language again."""


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
    lexed = [tokens(text) for _, text in files]
    inspected = [inspect(text, found) for (_, text), found in zip(files, lexed)]
    decided = decide(inspected, undecided)
    dialects = [dialect for dialect, _ in decided]
    texts: Sequence[Tuple[str, Tuple[str, ...]]] = [(text, ()) for _, text in files]
    if Dialect.GRINGO3 in dialects or any(one.of(Dialect.GRINGO3) for one in inspected):
        from rosoclingo.oclingo.gringo3.file_translator import translated  # noqa: PLC0415 most programs are clingo's

        texts = translated(files, lexed, inspected, dialects)
    return tuple(
        TranslationResult(
            _marked(old, new), warnings + (() if certain else _undecided(name, evidence, dialect)), dialect
        )
        for (name, old), (new, warnings), evidence, (dialect, certain) in zip(files, texts, inspected, decided)
    )


def included_files(text: str) -> List[Tuple[str, int]]:
    """The files that ``#include`` statements name, each with its line, in either language.

    A program's files have to be translated together, so whoever loads them needs to know before the translation.
    """
    found = tokens(text) if "#include" in text else []
    pairs = zip(found, found[1:])
    return [
        (name.text[1:-1], name.line) for word, name in pairs if word.text == "#include" and name.kind is Kind.STRING
    ]


def _marked(old: str, new: str) -> str:
    """A translation, with the mark if it needs one to be known for what it is."""
    if new == old or inspect(new, tokens(new)).decided in (Dialect.CLINGO5, Dialect.EITHER):
        return new
    return new + ("" if new.endswith("\n") else "\n") + MARK + "\n"


def _undecided(name: str, evidence: FileDialect, dialect: Dialect) -> Tuple[str, ...]:
    conflicts = [one for statement in evidence.of(Dialect.CONFLICT) for one in statement.conflicts if one.what]
    text = "{}:{}:{}: {} means one thing in gringo 3 and another in clingo 5; read as {} (say so by '% dialect: {}')"
    return tuple(
        text.format(name, one.token.line, one.token.column, one.what, dialect.value, dialect.value)
        for one in conflicts[:1]
    )
