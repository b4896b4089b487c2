"""The command ``golog``: prints what control programs are for the solver, or what is wrong with them."""

import argparse
import sys
from pathlib import Path
from typing import Optional, Sequence

from rosoclingo.oclingo.errors import Fault, ProgramError
from rosoclingo.oclingo.program.sources import Collector, Source
from rosoclingo.oclingo.unread import ends_unread

GOOD, FAULTY, UNREADABLE = 0, 1, 2
"""The exit codes: all is well, there are faults, a file cannot be read or the command line is wrong."""

_DESCRIPTION = """\
Prints control programs in Golog as facts and rules for encodings/golog.lp, which is what the solver makes of them, or
tells what is wrong with them and with those that they include, by line and column. Programs that use them name the
.golog files as they are."""

_EPILOG = "Exit code: 0 all is well; 1 there are faults; 2 a file can't be read, or the command line is wrong."


@ends_unread
def main(arguments: Optional[Sequence[str]] = None) -> int:
    """Run the command with the command line's arguments, or those given; return its exit code."""
    parser = argparse.ArgumentParser(prog="golog", description=_DESCRIPTION, epilog=_EPILOG)
    parser.add_argument("files", nargs="+", metavar="FILE", help="control programs (-: standard input)")
    parser.add_argument("--check", action="store_true", help="only tell what is wrong")
    given = parser.parse_args(arguments)
    codes = [_translate(file, given.check) for file in given.files]
    return max(codes)


def _translate(file: str, silent: bool) -> int:
    try:
        source = _read(file)
    except ProgramError as error:
        sys.stderr.write(f"{error}\n")
        return UNREADABLE
    collector = Collector()
    collector.add(source)
    collector.translate()
    texts = {one.source.name: one.source.text for one in collector.files}
    for fault in collector.faults:
        sys.stderr.write(_told(fault, texts.get(fault.file, "").splitlines()))
    if collector.faults:
        return FAULTY
    if not silent:
        sys.stdout.write(collector.files[0].text)
    return GOOD


def _read(file: str) -> Source:
    if file == "-":
        return Source("stdin.golog", sys.stdin.read())
    if not file.endswith(".golog"):
        raise ProgramError([Fault(file, 0, 0, "no control program by its name", "let it end on .golog")])
    return Source.from_file(Path(file))


def _told(fault: Fault, lines: Sequence[str]) -> str:
    """Return a fault with its line and a mark below its column."""
    if not 0 < fault.line <= len(lines):
        return f"{fault}\n"
    line = lines[fault.line - 1].replace("\t", " ")
    return f"{fault}\n{fault.line:6} | {line}\n       | {' ' * (fault.column - 1)}^\n"
