"""The command ``replay``: solves a recorded run again, without a master."""

import argparse
import shutil
import sys
from pathlib import Path
from typing import Callable, List, Optional, Sequence, Tuple

from rosoclingo.nodes.recording.bag_reader import REPLAYED, read_recording
from rosoclingo.oclingo import ProgramError, ReactiveProgram
from rosoclingo.oclingo.broken_pipe import exits_on_broken_pipe
from rosoclingo.oclingo.service.arguments import duration, positive
from rosoclingo.oclingo.service.table import format_answer
from rosoclingo.runs.recorded_run import RecordedRun, RecordingError, RunCollector, RunProgram
from rosoclingo.runs.replay import AGREEING, CycleReport, CycleVerdict, Replay, Shown, summary

Say = Callable[[str], None]

_DESCRIPTION = """\
Solve a recorded run again, and report for each cycle whether the decisions agree, or how they differ and why. Another
plan of equal length is not a difference; a longer plan is reported. No ROS master is needed."""

_EPILOG = """\
Exit code: 0, 1 for a difference without an explanation, 2 for a wrong command line or a recording that cannot be
replayed. Launch files record a bag with record:=true. JOURNAL is the folder of a core's ~journal or a file in it, which
has at most some hundred cycles."""


def make_parser() -> argparse.ArgumentParser:
    """Return the parser of the command line."""
    parser = argparse.ArgumentParser(
        prog="replay", description=_DESCRIPTION, epilog=_EPILOG, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "recording", metavar="RUN.bag|JOURNAL", type=Path, help="the recording: a bag, or a core's journal"
    )
    parser.add_argument("--to", type=positive, metavar="N", help="stop at cycle N and show its answer as a table")
    parser.add_argument(
        "--stream",
        metavar="FILE",
        help="write the online progression, for `oclingo --shortest --stream FILE` (-: standard output), and exit",
    )
    parser.add_argument(
        "--program-to",
        type=Path,
        metavar="FOLDER",
        help="write the program's files into FOLDER, and print the command that runs them",
    )
    parser.add_argument(
        "--program",
        nargs="+",
        type=Path,
        metavar="FILE",
        help="the program's files, for a recording without them, or to replay with another program",
    )
    parser.add_argument(
        "-c", "--const", action="append", default=[], metavar="NAME=VALUE", help="with --program: a constant's value"
    )
    parser.add_argument("--core", metavar="NAME", help="the core's name, if the recording has several")
    parser.add_argument("--run", type=positive, metavar="N", help="the run, if the core was started several times")
    parser.add_argument(
        "--plan-time",
        type=duration,
        metavar="SECONDS",
        help="processor time to search for a shorter plan (default: as in the run; no limit for ~plan: shortest)",
    )
    parser.add_argument("--all", action="store_true", help="print a line for each cycle, also if the decisions agree")
    return parser


@exits_on_broken_pipe
def main(arguments: Optional[Sequence[str]] = None, say: Say = print) -> int:
    """Run the command with ``arguments`` (default: those of the process) and return its exit code."""
    parser = make_parser()
    options = parser.parse_args(arguments)
    if options.const and not options.program:
        parser.error("--const needs --program; a recording has its own constants")
    try:
        runs = _chosen(_read(options.recording, options.core), options)
        if options.stream is not None or options.program_to is not None:
            _write(runs[-1], options, say)
            return 0
        return max(_replay(run, options, say) for run in runs)
    except (RecordingError, ProgramError) as error:
        return _fail(str(error))
    except OSError as error:
        return _fail(f"{error.filename}: {error.strerror}")
    except KeyboardInterrupt:
        return 130


def _read(path: Path, core: Optional[str]) -> List[RecordedRun]:
    """Return the runs in a bag or a journal; raises RecordingError, OSError."""
    collector = RunCollector()
    read_recording(path, core, collector, REPLAYED)
    try:
        return collector.runs()
    except RecordingError as error:
        raise RecordingError(f"{path}: {error}") from None


def _fail(text: str) -> int:
    sys.stderr.write(f"replay: {text}\n")
    return 2


def _chosen(runs: List[RecordedRun], options: argparse.Namespace) -> List[RecordedRun]:
    """Return the run of ``--run``, else all runs; raises RecordingError if the options need a single run."""
    if options.run is not None:
        if options.run > len(runs):
            raise RecordingError(f"no run {options.run}: {options.recording} has {len(runs)} runs of the core")
        return [runs[options.run - 1]]
    if len(runs) > 1 and (options.to or options.stream or options.program_to):
        raise RecordingError(f"{options.recording} has {len(runs)} runs of the core: choose one with --run N")
    return runs


def _write(run: RecordedRun, options: argparse.Namespace, say: Say) -> None:
    """Write the stream, the program, or both."""
    if options.stream == "-":
        say(run.stream)
    elif options.stream is not None:
        Path(options.stream).write_text(run.stream, encoding="utf-8")
    if options.program_to is not None:
        words = _program_of(run).write(options.program_to)
        stream = options.stream if options.stream not in (None, "-") else "FILE"
        say(f"rosrun rosoclingo oclingo {' '.join(words)} --shortest --stream {stream}")


def _program_of(run: RecordedRun) -> RunProgram:
    if run.program is None:
        raise RecordingError(
            "the recording lacks the program (topic rosoclingo/program): name its files with --program FILE ..."
        )
    return run.program


def _load(run: RecordedRun, options: argparse.Namespace, say: Say) -> Tuple[ReactiveProgram, Optional[float], float]:
    """Return the program, and the time limits for plans and for searches."""
    if options.program is None:
        program = _program_of(run).load()
    else:
        constants = dict(word.partition("=")[::2] for word in options.const)
        program = ReactiveProgram.from_files(options.program, constants)
        if run.program is not None and program.fingerprint != run.program.fingerprint:
            say("this is not the program of the run, which can cause differences")
    if run.program is None:
        return program, 1.0 if options.plan_time is None else options.plan_time, 10.0
    plan_time = run.program.plan_time if options.plan_time is None else options.plan_time
    return program, plan_time, float(run.program.settings.get("search_timeout", 10.0))


def _replay(run: RecordedRun, options: argparse.Namespace, say: Say) -> int:
    """Replay a run and print the results; return the exit code."""
    program, plan_time, search_time = _load(run, options, say)
    first, last = run.cycles[0].cycle, run.cycles[-1].cycle
    if options.to is not None and options.to > last:
        raise RecordingError(f"--to {options.to} is after the last cycle of the run, {last}")
    if options.to is not None and options.to < first:
        raise RecordingError(f"--to {options.to} is before the first cycle of the recording, {first}")
    reports: List[CycleReport] = []
    for report in Replay(run, program, plan_time, search_time).reports():
        reports.append(report)
        if options.all or not report.explained or report.verdict not in AGREEING:
            say(report.line())
        if report.cycle == options.to:
            _show(report, say)
            break
    for line in summary(reports):
        say(line)
    return int(not all(report.explained for report in reports))


def _show(report: CycleReport, say: Say) -> None:
    """Print a cycle's recorded answer, and the new answer if it differs."""
    if report.verdict not in (CycleVerdict.SAME, CycleVerdict.NONE):
        _table("as recorded", report.published, say)
        _table("of the replay", report.found, say)
    else:
        _table("", report.found or report.published, say)


def _table(words: str, shown: Optional[Shown], say: Say) -> None:
    title = f"Answer {words}".rstrip()
    if shown is None:
        say(f"{title}: none")
        return
    say(f"{title}, horizon {shown.horizon}")
    width = max(shutil.get_terminal_size((100, 24)).columns, 60)
    say(format_answer(shown.atoms, shown.horizon + 1, width).rstrip() or "(no atom)")
