"""The command ``report``: writes a recorded run as one HTML file, without a master."""

import argparse
import sys
from pathlib import Path
from typing import Any, Callable, Mapping, Optional, Sequence

import rospkg

from rosoclingo.nodes.recording.bag_reader import read_recording
from rosoclingo.oclingo.broken_pipe import exits_on_broken_pipe
from rosoclingo.reasoning.journal.database import file_of
from rosoclingo.runs.recorded_run import RecordingError
from rosoclingo.runs.report_page import report_page
from rosoclingo.runs.run_view import RunView

_DESCRIPTION = """\
Write a recorded run as one HTML file for any browser: map, timeline, goals, plans with their reasons and times, log and
figures, with a slider over the run. It needs no other file and no network. No ROS master is needed."""

_EPILOG = """\
Exit code: 0, 2 for a wrong command line, a recording that cannot be read or a file that cannot be written.
Launch files record a bag with record:=true. JOURNAL is the folder of a core's ~journal or a file in it. It has at most
some hundred cycles, without poses, map, packages, lines of the core's log and times of the solver.
FILE.html#t=12.5 opens the report at 12.5 s."""


def web() -> Path:
    """Return the folder of the front-end files."""
    return Path(rospkg.RosPack().get_path("rosoclingo")) / "web"


def write_report(run: Path, to: Path, core: Optional[str] = None, about: Optional[Mapping[str, Any]] = None) -> None:
    """Write the report of a bag or a journal; raises RecordingError, OSError.

    ``about`` has further texts of the page: ``title``, ``source``, and ``verdict``, the differences from the expected
    end.
    """
    about = {"title": run.stem, "source": run.name, **(about or {})}
    view = RunView(about)
    read_recording(run, core, view)
    view.finish()
    to.write_text(report_page(view.changes(), web()), encoding="utf-8")


def make_parser() -> argparse.ArgumentParser:
    """Return the parser of the command line."""
    parser = argparse.ArgumentParser(
        prog="report", description=_DESCRIPTION, epilog=_EPILOG, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "recording", metavar="RUN.bag|JOURNAL", type=Path, help="the recording: a bag, or a core's journal"
    )
    parser.add_argument(
        "-o", "--output", metavar="FILE", type=Path, help="the report (default: RUN.html next to the recording)"
    )
    parser.add_argument("--title", help="the report's title (default: the recording's name)")
    parser.add_argument("--core", metavar="NAME", help="the core's name, if the recording has several")
    return parser


@exits_on_broken_pipe
def main(arguments: Optional[Sequence[str]] = None, say: Callable[[str], None] = print) -> int:
    """Run the command with ``arguments`` (default: those of the process) and return its exit code."""
    options = make_parser().parse_args(arguments)
    to = options.output or file_of(options.recording).with_suffix(".html")
    try:
        write_report(options.recording, to, options.core, {"title": options.title} if options.title else {})
    except RecordingError as error:
        return _fail(str(error))
    except OSError as error:
        return _fail(f"{error.filename or to}: {error.strerror}")
    say(f"report: {to}")
    return 0


def _fail(text: str) -> int:
    sys.stderr.write(f"report: {text}\n")
    return 2
