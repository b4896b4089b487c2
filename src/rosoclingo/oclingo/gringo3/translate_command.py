"""The command ``gringo3to5``: reads files, prints or writes their translations."""

import argparse
import sys
from pathlib import Path
from typing import List, Optional, Sequence, Tuple

from rosoclingo.oclingo.errors import Fault, ProgramError
from rosoclingo.oclingo.gringo3.dialect import Dialect
from rosoclingo.oclingo.gringo3.translate import TranslationResult, included_files, translate_program
from rosoclingo.oclingo.unread import ends_unread

_DESCRIPTION = "Prints programs written for oClingo (2012), in gringo 3's language, in clingo 5's language."


@ends_unread
def main(arguments: Optional[Sequence[str]] = None) -> int:
    """Run the command with the command line's arguments, or those given; returns the exit code."""
    parser = argparse.ArgumentParser(prog="gringo3to5", description=_DESCRIPTION)
    parser.add_argument("files", nargs="+", metavar="FILE", help="program files in order, - for standard input")
    parser.add_argument("-o", "--output", metavar="FOLDER", help="write files of the same names there")
    given = parser.parse_args(arguments)
    return _translate(given.files, given.output)


def _translate(names: Sequence[str], folder: Optional[str]) -> int:
    """Translate the files of a program; ``-`` is standard input.

    What reads differently in both languages is taken for gringo 3's, since that is what the command is asked for. The
    translations are printed one after the other, or written under the files' names into a folder; warnings and errors
    go to standard error. Returns the exit code.
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
        message = f"no UTF-8 text: {error.reason} at byte {error.start}"
        raise ProgramError([Fault(name, 0, 0, message, "save the file as UTF-8")]) from None


def _left_out(sources: Sequence[Tuple[str, str]]) -> List[str]:
    """Warnings about included files that were not given to the command."""
    given = {Path(name).name for name, _ in sources}
    included = [(name, *found) for name, text in sources for found in included_files(text)]
    message = "{}:{}:1: the included file {} is not translated (name it on the command line, too)"
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
