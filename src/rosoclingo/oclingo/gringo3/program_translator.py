"""Translates the files of a program, of which some are in gringo 3's language."""

from pathlib import PurePath
from typing import List, Sequence, Tuple

from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.gringo3.dialect import Dialect, FileDialect
from rosoclingo.oclingo.gringo3.elements import Naming
from rosoclingo.oclingo.gringo3.file_translator import FileTranslator, Program
from rosoclingo.oclingo.gringo3.lexer import Kind, Token, TranslationError


def translated(
    files: Sequence[Tuple[str, str]],
    lexed: Sequence[Sequence[Token]],
    inspected: Sequence[FileDialect],
    dialects: Sequence[Dialect],
) -> List[Tuple[str, Tuple[str, ...]]]:
    """Return the translation of each file, and the warnings about it; raises TranslationError."""
    naming = Naming(token.text for found in lexed for token in found if token.kind is Kind.VARIABLE)
    program, translators = Program(naming), []
    for (name, text), found, findings, dialect in zip(files, lexed, inspected, dialects):
        translators.append(FileTranslator(program, PurePath(name).name, text, found, findings, dialect))
    faults = _run(files, program, translators)
    if faults:
        raise TranslationError(faults)
    return [(one.text(), _warnings(name, one)) for (name, _), one in zip(files, translators)]


def _run(files: Sequence[Tuple[str, str]], program: Program, translators: Sequence[FileTranslator]) -> List[Fault]:
    faults = []
    for (name, _), translator in zip(files, translators):
        faults += [refusal.fault(name) for refusal in translator.run()]
    for statement, refusal in program.visibility.write():
        place = next(i for i, translator in enumerate(translators) if translator.rewriting is statement.rewriting)
        faults.append(refusal.fault(files[place][0]))
    return faults


def _warnings(name: str, translator: FileTranslator) -> Tuple[str, ...]:
    return tuple(f"{name}:{token.line}:{token.column}: {message}" for token, message in translator.warnings)
