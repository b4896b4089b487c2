"""The command ``check``: reports likely errors of a program in the format of a compiler."""

import argparse
import json
import shutil
import sys
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, Dict, List, NamedTuple, Optional, Sequence, Tuple

from rosoclingo.checking.extension import NO_EXTENSION, CheckExtension
from rosoclingo.checking.lint.kinds import LintFinding
from rosoclingo.checking.lint.linting import findings, is_error, lint_sources
from rosoclingo.checking.lint.stream_lint import lint_stream
from rosoclingo.checking.verifying import verify_option
from rosoclingo.oclingo.broken_pipe import exits_on_broken_pipe
from rosoclingo.oclingo.errors import Fault, ProgramError, ProgressionError
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.sources import Source, parse_constants
from rosoclingo.oclingo.progression.parser import parse_updates
from rosoclingo.oclingo.service.arguments import TRIAL_SECONDS, TRIAL_STEPS, constants_of, positive, seconds

if TYPE_CHECKING:
    from rosoclingo.checking.trial_plans import TrialPlan
    from rosoclingo.checking.verifying.verification import Verification

CLEAN, FOUND, UNREADABLE = 0, 1, 2
"""Exit codes: no findings; findings; an unreadable file or a wrong command line."""

_DESCRIPTION = """\
Reports likely errors of a reactive logic program before it runs: misspelt predicates, impossible values, heads without
a step and more. With --plan it shows the plan for a request, or the rules that exclude one. It needs no ROS master."""

_EPILOG = """\
A comment "% check: ok KIND" silences findings of a kind on its line or, alone on a line, on the next one. Exit code:
0 no findings; 1 an error, a warning, a request without a plan, or a defect found by --verify; 2 an unreadable file or a
wrong command line."""


def make_parser(extension: CheckExtension = NO_EXTENSION) -> argparse.ArgumentParser:
    """Return the parser of the command line."""
    parser = argparse.ArgumentParser(prog="check", description=_DESCRIPTION, epilog=_EPILOG)
    parser.add_argument("files", nargs="+", metavar="FILE", help="program files, read in order (-: standard input)")
    parser.add_argument(
        "-c", "--const", action="append", default=[], metavar="NAME=VALUE", help="replace a constant; can be repeated"
    )
    parser.add_argument("--stream", metavar="FILE", help="updates for the program, which are checked as well")
    add_trials(parser, extension)
    parser.add_argument("--json", action="store_true", help="print the findings as one JSON object")
    return parser


def add_trials(parser: argparse.ArgumentParser, extension: CheckExtension = NO_EXTENSION) -> None:
    """Add the options of trial plans, of the extension and of the verification."""
    parser.add_argument(
        "--plan",
        action="append",
        nargs="?",
        default=[],
        metavar="REQUEST",
        help="show the plan for a request such as goal(office1,office2,1) after the updates of --stream, or the rules "
        "that exclude one; can be repeated; without REQUEST: one of each kind in the program's rules, or in --orders",
    )
    parser.add_argument(
        "--steps",
        type=positive,
        default=TRIAL_STEPS,
        metavar="N",
        help=f"greatest number of steps of a plan (default: {TRIAL_STEPS})",
    )
    parser.add_argument(
        "--seconds",
        type=seconds,
        default=TRIAL_SECONDS,
        metavar="S",
        help=f"time limit for each plan, and for the reasons if there is none (default: {TRIAL_SECONDS:g})",
    )
    extension.add_arguments(parser)
    verify_option.add_arguments(parser)


@exits_on_broken_pipe
def main(arguments: Optional[Sequence[str]] = None, extension: CheckExtension = NO_EXTENSION) -> int:
    """Run the command and return its exit code; ``arguments`` default to those of the process."""
    options = make_parser(extension).parse_args(arguments)
    try:
        return check(options, extension)
    except KeyboardInterrupt:
        return 130


def check(options: argparse.Namespace, extension: CheckExtension = NO_EXTENSION) -> int:
    """Check the files that ``options`` name, print the report, and return the exit code."""
    unreadable: List[Fault] = []
    sources = [source for file in options.files for source in _read(file, unreadable)]
    stream = _read(options.stream, unreadable) if options.stream else []
    added: List[Source] = []  # rules of the program that come from options
    try:
        constants = constants_of(options.const)
        parse_constants(constants)
        added += [*extension.sources(options), *verify_option.sources(options)]
    except ProgramError as error:
        unreadable += error.faults
    if unreadable:
        sys.stderr.writelines(f"{fault}\n" for fault in unreadable)
        return UNREADABLE
    try:
        report, program = _lint([*sources, *added], constants, stream, extension)
        if program is not None and not program.faults:
            trials = _trials(program, stream, options, extension)
            report = report._replace(trials=trials, verification=verify_option.run(program, options, extension))
    except ProgramError as error:
        sys.stderr.write(f"{error}\n")
        return UNREADABLE
    own = {one.name for one in added}
    report = report._replace(files={name: text for name, text in report.files.items() if name not in own})
    width = max(shutil.get_terminal_size((100, 24)).columns, 60)
    sys.stdout.write(json.dumps(report.to_message(), indent=2) + "\n" if options.json else report.text(width))
    return FOUND if report.failed else CLEAN


class _Report(NamedTuple):
    """The findings, the texts of files by name, the trial plans, and the result of the verification."""

    found: Sequence[LintFinding]
    files: Dict[str, str]
    trials: "Sequence[TrialPlan]" = ()
    verification: "Optional[Verification]" = None

    @property
    def errors(self) -> int:
        """The number of errors."""
        return sum(map(is_error, self.found))

    @property
    def failed(self) -> bool:
        """Whether there are findings, requests without a plan, or defects."""
        unplanned = any(one.answer is None or one.fault for one in self.trials)
        return bool(self.found) or unplanned or (self.verification is not None and not self.verification.clean)

    def text(self, width: int) -> str:
        """Return the report in the format of a compiler."""
        lines = {name: text.splitlines() for name, text in self.files.items()}
        parts = []
        for fault, severity in self.found:
            place = f"{fault.file}:{fault.line}:{fault.column}" if fault.line else fault.file
            remedy = f" ({fault.remedy})" if fault.remedy else ""
            parts.append(f"{place}: {severity}: {fault.message}{remedy} [{fault.kind}]\n")
            parts.append(_excerpt(fault, lines.get(fault.file, ())))
        counts = [_counted(self.errors, "error"), _counted(len(self.found) - self.errors, "warning")]
        parts.append(f"{', '.join(filter(None, counts)) or 'no findings'} in {_counted(len(self.files), 'file')}\n")
        parts += [f"\n{one.text(width)}" for one in self.trials]
        parts += [] if self.verification is None else [f"\n{self.verification.text()}"]
        return "".join(parts)

    def to_message(self) -> Dict[str, Any]:
        """Return the report as a value for JSON."""
        findings = [{**vars(one.fault), "severity": one.severity} for one in self.found]
        warnings = len(self.found) - self.errors
        report = {"errors": self.errors, "warnings": warnings, "files": list(self.files), "findings": findings}
        if self.trials:
            report["plans"] = [one.to_message() for one in self.trials]
        if self.verification is not None:
            report["verify"] = self.verification.to_message()
        return report


def _trials(
    program: ReactiveProgram, stream: Sequence[Source], options: argparse.Namespace, extension: CheckExtension
) -> "List[TrialPlan]":
    """Play the stream, then try the requests; syntax errors of the stream are findings already."""
    if not options.plan:
        return []
    from rosoclingo.checking.trial_plans import Trials  # noqa: PLC0415 slow to load, and rarely used

    trials, found = Trials(program, options.steps, options.seconds), []  # type: Trials, List[TrialPlan]
    for source in stream:
        with suppress(ProgressionError):
            found += trials.play(parse_updates(source.text))
    kinds = extension.requests(program)
    for text in options.plan:
        found += trials.samples(kinds) if text is None else [trials.request(text)]
    return found


def _lint(
    sources: Sequence[Source],
    constants: Dict[str, str],
    stream: Sequence[Source],
    extension: CheckExtension,
) -> Tuple[_Report, Optional[ReactiveProgram]]:
    """Return the findings with their files, and the program if it is readable."""
    program, faults = lint_sources(sources, constants)
    errors = faults if program is None else program.faults
    files = [(one.name, one.text) for one in (*(sources if program is None else program.texts), *stream)]
    if program is not None:
        faults = [*faults, *(fault for one in stream for fault in lint_stream(program, one.text, one.name))]
    checked = extension.check(program)
    files += checked.files
    return _Report(findings([*faults, *checked.faults], files, errors), dict(files)), program


def _read(file: str, unreadable: List[Fault]) -> List[Source]:
    """Return the text of a file, or of standard input for ``-``; adds the faults of unreadable files."""
    if file == "-":
        return [Source("<stdin>", sys.stdin.read(), Path())]
    try:
        return [Source.from_file(Path(file))]
    except ProgramError as error:
        unreadable += error.faults
        return []


_WIDEST = 200  # greatest number of columns of an excerpt


def _excerpt(fault: Fault, lines: Sequence[str]) -> str:
    """Return the line of a fault with a mark below its column."""
    if not 0 < fault.line <= len(lines) or not lines[fault.line - 1].strip():
        return ""
    start = max(0, fault.column - 1 - _WIDEST // 2) if fault.column > _WIDEST else 0
    line = lines[fault.line - 1].replace("\t", " ")[start : start + _WIDEST]
    number = f"{fault.line:6} | "
    return f"{number}{line}\n{'|':>{len(number) - 1}} {' ' * (fault.column - 1 - start)}^\n"


def _counted(number: int, what: str) -> str:
    return "" if not number else f"{number} {what}{'s' * (number > 1)}"


if __name__ == "__main__":
    sys.exit(main())
