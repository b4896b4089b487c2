"""The command ``gringo3to5``, which prints or writes translations of files."""

import argparse
import sys
from pathlib import Path
from typing import List, Optional, Sequence, Tuple

from rosoclingo.oclingo.broken_pipe import exits_on_broken_pipe
from rosoclingo.oclingo.errors import Fault, ProgramError
from rosoclingo.oclingo.gringo3.dialect import Dialect
from rosoclingo.oclingo.gringo3.translate import TranslationResult, included_files, translate_program

_DESCRIPTION = "Translates programs for oClingo (2012) from gringo 3's language into clingo 5's language."


@exits_on_broken_pipe
def main(arguments: Optional[Sequence[str]] = None) -> int:
    """Run the command with ``arguments``, by default those of the command line; return the exit code."""
    parser = argparse.ArgumentParser(prog="gringo3to5", description=_DESCRIPTION)
    parser.add_argument("files", nargs="+", metavar="FILE", help="program files in load order (-: standard input)")
    parser.add_argument("-o", "--output", metavar="FOLDER", help="write files with the same names into this folder")
    given = parser.parse_args(arguments)
    return _translate(given.files, given.output)


def _translate(names: Sequence[str], folder: Optional[str]) -> int:
    """Translate the files of a program and return the exit code; ``-`` is standard input.

    Ambiguous files count as gringo 3. The translations go to standard output, or into a folder under the names of the
    files. Warnings and errors go to standard error.
    """
    try:
        sources = [(name, _read(name)) for name in names]
        results = translate_program(sources, Dialect.GRINGO3)
    except ProgramError as error:
        sys.stderr.write(f"{error}\n")
        return 1
    warnings = [warning for result in results for warning in result.warnings]
    sys.stderr.writelines(f"warning: {warning}\n" for warning in [*warnings, *_left_out(sources)])
    return _write(list(zip(names, results)), folder)


def _read(name: str) -> str:
    try:
        data = sys.stdin.buffer.read() if name == "-" else Path(name).read_bytes()
        return data.decode("utf-8")
    except OSError as error:
        raise ProgramError([Fault(name, 0, 0, f"cannot be read: {error.strerror}")]) from None
    except UnicodeDecodeError as error:
        message = f"not UTF-8 text: {error.reason} at byte {error.start}"
        raise ProgramError([Fault(name, 0, 0, message, "save the file as UTF-8")]) from None


def _left_out(sources: Sequence[Tuple[str, str]]) -> List[str]:
    """Return warnings about included files that the command line does not name."""
    given = {Path(name).name for name, _ in sources}
    included = [(name, *found) for name, text in sources for found in included_files(text)]
    message = "{}:{}:1: the included file {} is not translated (also name it on the command line)"
    return [message.format(name, line, file) for name, file, line in included if Path(file).name not in given]


def _write(results: List[Tuple[str, TranslationResult]], folder: Optional[str]) -> int:
    for name, result in results:
        if folder is None:
            sys.stdout.write(result.text if result.text.endswith("\n") or not result.text else result.text + "\n")
            continue
        path = Path(folder) / ("standard_input.lp" if name == "-" else Path(name).name)
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(result.text, encoding="utf-8")
        except OSError as error:
            sys.stderr.write("{}\n".format(Fault(str(path), 0, 0, f"cannot be written: {error.strerror}")))
            return 1
    return 0
