"""The command ``golog``, which translates control programs and reports their errors."""

import argparse
import sys
from pathlib import Path
from typing import Optional, Sequence

from rosoclingo.oclingo.broken_pipe import exits_on_broken_pipe
from rosoclingo.oclingo.errors import Fault, ProgramError
from rosoclingo.oclingo.program.sources import Collector, Source

GOOD, FAULTY, UNREADABLE = 0, 1, 2
"""Exit codes: no errors, errors in programs, or a file cannot be read or the command line is wrong."""

_DESCRIPTION = """\
Translates control programs in Golog into facts and rules for encodings/golog.lp, or reports the errors in them and in
the files that they include, with line and column. Loading a .golog file needs no translation by this command."""

_EPILOG = "Exit code: 0 no errors; 1 errors in programs; 2 a file can't be read, or the command line is wrong."


@exits_on_broken_pipe
def main(arguments: Optional[Sequence[str]] = None) -> int:
    """Run the command with ``arguments``, by default those of the command line; return the exit code."""
    parser = argparse.ArgumentParser(prog="golog", description=_DESCRIPTION, epilog=_EPILOG)
    parser.add_argument("files", nargs="+", metavar="FILE", help="control programs (-: standard input)")
    parser.add_argument("--check", action="store_true", help="only report errors")
    given = parser.parse_args(arguments)
    codes = [_translate(file, given.check) for file in given.files]
    return max(codes)


def _translate(file: str, silent: bool) -> int:
    try:
        source = _read(file)
    except ProgramError as error:
        sys.stderr.write(f"{error}\n")
        return UNREADABLE
    collector = Collector([source])
    texts = {one.source.name: one.source.text for one in collector.files}
    for fault in collector.faults:
        sys.stderr.write(_with_source_line(fault, texts.get(fault.file, "").splitlines()))
    if collector.faults:
        return FAULTY
    if not silent:
        sys.stdout.write(collector.files[0].text)
    return GOOD


def _read(file: str) -> Source:
    if file == "-":
        return Source("stdin.golog", sys.stdin.read())
    if not file.endswith(".golog"):
        raise ProgramError([Fault(file, 0, 0, "not the name of a control program", "end the file name with .golog")])
    return Source.from_file(Path(file))


def _with_source_line(fault: Fault, lines: Sequence[str]) -> str:
    """Return a fault with its source line and a mark below its column."""
    if not 0 < fault.line <= len(lines):
        return f"{fault}\n"
    line = lines[fault.line - 1].replace("\t", " ")
    return f"{fault}\n{fault.line:6} | {line}\n       | {' ' * (fault.column - 1)}^\n"
