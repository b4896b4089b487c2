"""The command ``oclingo``: serves a reactive logic program by TCP, plays a stream, or reads updates at a prompt."""

import argparse
import io
import os
import re
import shutil
import signal
import sys
from contextlib import suppress
from pathlib import Path
from typing import Callable, ContextManager, List, Optional, Sequence, Tuple

from rosoclingo.oclingo.broken_pipe import exits_on_broken_pipe
from rosoclingo.oclingo.errors import ProgramError, SolverError
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.sources import Source
from rosoclingo.oclingo.service.arguments import constants_of, duration, natural, port, positive, seconds
from rosoclingo.oclingo.service.output import JsonOutput, ProgressReport, TextOutput, write
from rosoclingo.oclingo.service.protocol import DEFAULT_PORT
from rosoclingo.oclingo.service.session import Output, Session
from rosoclingo.oclingo.solving.stream_solver import StreamSolver

DEFAULT_HOST = "127.0.0.1"

BOUND = 100
"""The default bound for updates of a played stream."""

UNSATISFIABLE = 20
"""The exit code if an update of a played stream has no answer, as in clingo."""

_DESCRIPTION = """\
A reactive ASP solver: loads a reactive logic program and answers stream updates. Without --stream or --interactive it
is a TCP service with oClingo's protocol: clients connect, send updates and receive answers, until a client
sends "#stop."."""

_EPILOG = """\
An update is "#step K : M." (": M" bounds the horizon at K+M), facts and rules, "#endstep.". Programs can be written in
gringo 3's language. Exit code: 0; 1 for errors in program, stream or updates; 2 for a wrong command line; 20 if an
update of --stream has no answer."""

_REMAPPING = re.compile(r"[\w~/]+:=")


Check = Callable[[argparse.ArgumentParser], Callable[[argparse.Namespace], int]]
"""Adds the arguments of ``--check`` to a parser, and returns a function that checks and returns the exit code."""


MakeSolver = Callable[..., ContextManager[StreamSolver]]
"""Returns a solver for a program; the options are ``models``, ``horizon_limit``, ``shortest`` and ``plan_time``."""


def make_parser() -> argparse.ArgumentParser:
    """Return the parser of the command line, without the options of the check."""
    parser = argparse.ArgumentParser(prog="oclingo", description=_DESCRIPTION, epilog=_EPILOG)
    parser.add_argument(
        "words",
        nargs="*",
        metavar="FILE | MODELS",
        help="program files, read in order (- or none: standard input); a number that is not a file is MODELS, "
        "the number of answers to compute for an update (0: all, default: 1)",
    )
    parser.add_argument(
        "-c",
        "--const",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="replace the constant NAME of the program by a term; can be repeated",
    )
    _add_search(parser)
    _add_modes(parser)
    return parser


def _add_search(parser: argparse.ArgumentParser) -> None:
    """Add the options of the search."""
    parser.add_argument("--imax", type=positive, metavar="N", help="last step to ground (default: no limit)")
    parser.add_argument(
        "--shortest",
        action="store_true",
        help="answer as rosoclingo's core with ~plan shortest: all plans are shortest plans, and strings of updates "
        "equal strings of the program; the stream of a core (topic ~updates) then gives the same plans",
    )
    parser.add_argument(
        "--plan-time",
        type=duration,
        metavar="SECONDS",
        help="with --shortest: limit of the processor time for a shortest plan; after it, answer with the best known "
        "plan, or continue up to the first plan (default: no limit)",
    )
    parser.add_argument(
        "--time-limit",
        type=seconds,
        metavar="SECONDS",
        help="end the search for an update after this time; the update stays in force (default: no limit)",
    )


def _add_modes(parser: argparse.ArgumentParser) -> None:
    """Add the options for the source of updates and for the output."""
    mode = parser.add_mutually_exclusive_group()
    mode.add_argument(
        "--stream", metavar="FILE", help="play the updates of FILE (-: standard input) and print answers as tables"
    )
    parser.add_argument(
        "--bound",
        type=natural,
        metavar="M",
        help='with --stream: the bound of updates without one ("#step K." becomes "#step K : M."); 0 for no bound '
        f"(default: {BOUND})",
    )
    mode.add_argument(
        "--interactive",
        action="store_true",
        help="read updates at a prompt; Ctrl-C ends a search, Ctrl-D the session",
    )
    parser.add_argument(
        "--check",
        action="store_true",
        help="report likely faults in the program, and in the updates of --stream, as the command check does, with the "
        "same options (oclingo --check --help). Exit code: 0 no findings, 1 findings, 2 a file can't be read",
    )
    parser.add_argument(
        "--json",
        action="store_true",
        help="with --stream or --interactive: print one JSON object per update; with --check: one with all findings",
    )
    parser.add_argument("--host", help=f"address to listen on (default: {DEFAULT_HOST}, this machine only)")
    parser.add_argument(
        "--port", type=port, metavar="N", help=f"port to listen on, 0 for any free port (default: {DEFAULT_PORT})"
    )


@exits_on_broken_pipe
def main(arguments: Optional[Sequence[str]], make_solver: MakeSolver, add_check: Check) -> int:
    """Run the command with ``arguments`` (None: those of the process) and return its exit code."""
    words = [word for word in (sys.argv[1:] if arguments is None else arguments) if not _REMAPPING.match(word)]
    parser = make_parser()
    is_check = any("--check".startswith(word) and len(word) > len("--c") for word in words)
    check = add_check(parser) if is_check else None
    options = parser.parse_intermixed_args(words)
    files, models = _files_and_models(options.words)
    _check(parser, options, files)
    if check is not None:
        options.files = files
        return check(options)
    signal.signal(signal.SIGTERM, lambda number, frame: sys.exit(0))
    if isinstance(sys.stdin, io.TextIOWrapper):
        sys.stdin.reconfigure(encoding="utf-8", errors="replace")
    try:
        constants = constants_of(options.const)
        program = ReactiveProgram([_source(file) for file in files], constants)
        for text in program.warnings:
            _say(f"warning: {text}")
        settings = {"shortest": options.shortest, "plan_time": options.plan_time}
        with make_solver(program, models=models, horizon_limit=options.imax, **settings) as solver:
            return _run(solver, options)
    except (ProgramError, SolverError) as error:
        _say(str(error))
        return 1
    except BrokenPipeError:
        raise
    except OSError as error:
        _say(f"error: {error}")
        return 1
    except KeyboardInterrupt:
        return 130


def _run(solver: StreamSolver, options: argparse.Namespace) -> int:
    if options.stream is None and not options.interactive:
        return _serve(solver, options)
    if options.interactive:
        with suppress(ImportError):  # enables line editing and history if available
            import readline  # noqa: F401, PLC0415
        Session(solver, _output(options), options.time_limit).ask()
        return 0
    bound = BOUND if options.bound is None else options.bound
    session = Session(solver, _output(options), options.time_limit, bound, ProgressReport(sys.stderr))
    if options.stream == "-":
        session.play(sys.stdin, "<stdin>")
    else:
        text = Source.from_file(Path(options.stream)).text
        session.play(io.StringIO(text), options.stream)
    return int(session.failed) or (UNSATISFIABLE if session.unsatisfiable else 0)


def _serve(solver: StreamSolver, options: argparse.Namespace) -> int:
    from rosoclingo.oclingo.service.server import Service, listen  # noqa: PLC0415 only the service needs it

    host = DEFAULT_HOST if options.host is None else options.host
    port = DEFAULT_PORT if options.port is None else options.port
    try:
        listener = listen(host, port)
    except OSError as error:
        why = os.strerror(error.errno) if error.errno and error.errno > 0 else error.strerror or error
        raise OSError(f"can't listen on {host}:{port}: {why}; choose another --port or --host") from None
    host, port = listener.getsockname()[:2]
    write(sys.stdout, f"Listening on {host}:{port}\n")
    try:
        Service(solver, listener, options.time_limit).run()
    except KeyboardInterrupt:
        _say("stopped")
    return 0


def _output(options: argparse.Namespace) -> Output:
    if options.json:
        return JsonOutput(sys.stdout)
    echo = not (options.interactive and sys.stdin.isatty())  # a terminal already shows typed updates
    return TextOutput(sys.stdout, max(shutil.get_terminal_size((100, 24)).columns, 60), echo)


def _files_and_models(words: Sequence[str]) -> Tuple[List[str], int]:
    """Return the program files and the number of models: the last number that is not a file."""
    numbers = [word for word in words if word.isdigit() and word.isascii() and not Path(word).exists()]
    files = [word for word in words if word and word not in numbers]
    return files or ["-"], int(numbers[-1]) if numbers else 1


def _check(parser: argparse.ArgumentParser, options: argparse.Namespace, files: Sequence[str]) -> None:
    """Refuse options that exclude each other."""
    serves = options.stream is None and not options.interactive
    reads_updates = options.stream == "-" or options.interactive
    address = options.port is not None or options.host is not None
    for is_wrong, text in (
        (options.json and serves and not options.check, "--json needs --stream, --interactive or --check"),
        (options.check and options.interactive, "--check reads files: it cannot be combined with --interactive"),
        (address and not serves, "--host and --port cannot be combined with --stream or --interactive"),
        (options.bound is not None and options.stream is None, "--bound needs --stream"),
        (options.plan_time is not None and not options.shortest, "--plan-time needs --shortest"),
        ("-" in files and reads_updates, "standard input contains the updates: name a program file"),
        (files.count("-") > 1, "standard input can be read only once"),
    ):
        if is_wrong:
            parser.error(text)


def _source(file: str) -> Source:
    if file != "-":
        return Source.from_file(Path(file))
    if sys.stdin.isatty():
        _say("reading the program from standard input; end it with Ctrl-D")
    return Source("<stdin>", sys.stdin.read(), Path())


def _say(text: str) -> None:
    write(sys.stderr, text + "\n")
