#!/usr/bin/env python3
"""Runs the short forms of the benches one after the other and prints one table of their figures: ./dev bench.

With --against, the benches measure this checkout and another commit in turns, in at least three rounds. The other
commit is built once, in a folder outside the source tree. The benches of this checkout measure both; a bench that does
not run with the other commit is reported as not available. The ratio compares the best runs. "better" and "worse" mark
a difference of more than a tenth. A "?" means that the runs of both sides overlap; repeat the bench with more rounds or
on a quieter machine.

Exit codes: 0 for success, 1 if a bench failed or the other commit cannot be built, 2 for a wrong command line.
"""

import argparse
import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Callable, Dict, List, Optional, Sequence

import figures

ROOT = Path(__file__).resolve().parents[1]
sys.path.append(str(ROOT / "test"))

from processes import run  # noqa: E402

BENCHES = sorted(
    path.stem
    for path in (ROOT / "bench").glob("*.py")
    if path != Path(__file__).resolve() and path.read_text().startswith("#!")  # the other files are modules
)
LIMIT = 900.0  # s, time limit of a bench
FEWEST = 3  # least number of rounds if two versions are compared
SHOWN = 15  # number of lines shown of the output of a failed bench


class BenchError(Exception):
    """A bench has failed; the message contains the cause."""


class Checkout:
    """This checkout, or the tree of another commit, with the folder of the benches and the start of the command."""

    def __init__(self, name: str, folder: Path, start: Sequence[str], logs: Path) -> None:
        self.name, self._folder, self._start, self._logs = name, folder, start, logs

    def measure(self, bench: str) -> List[figures.Figure]:
        """Run the short form of a bench; raises BenchError."""
        handle, name = tempfile.mkstemp(prefix=f"{bench}-{self.name}-", suffix=".log", dir=str(self._logs))
        os.close(handle)
        log = Path(name)
        result = log.with_suffix(".json")
        command = [*self._start, str(self._folder / f"{bench}.py"), "--short", "--json", str(result)]
        ended = run(command, log, LIMIT, os.environ)
        if ended.code is None:
            raise BenchError(f"it did not end within {LIMIT:.0f} s; output: {log}")
        if ended.code != 0:
            last = log.read_text(errors="replace").rstrip().splitlines()[-SHOWN:]
            raise BenchError("\n    ".join([f"exit code {ended.code}; complete output: {log}", *last]))
        try:
            return figures.read(result)
        except (OSError, figures.FigureError) as error:
            raise BenchError(f"it wrote no figures: {error}") from error


def git(*arguments: str) -> bytes:
    """Return the output of a git command for this checkout; raises subprocess.CalledProcessError."""
    command = ["git", "-C", str(ROOT), *arguments]
    return subprocess.run(command, check=True, capture_output=True).stdout


def commit_named(text: str) -> str:
    """Return the hash of a commit, as a type for argparse."""
    try:
        return git("rev-parse", "--verify", "--quiet", text + "^{commit}").decode().strip()
    except FileNotFoundError:
        raise argparse.ArgumentTypeError("git is not installed; it is needed for the other commit") from None
    except subprocess.CalledProcessError as error:
        why = error.stderr.decode().strip() or f"git knows no such commit: {text}"
        raise argparse.ArgumentTypeError(why) from None


def make_once(target: Path, make: Callable[[Path], object]) -> None:
    """Create a folder by ``make`` unless it exists.

    The folder appears only when complete, even if another run creates it at the same time.
    """
    target.parent.mkdir(parents=True, exist_ok=True)
    if target.exists():
        return
    with tempfile.TemporaryDirectory(dir=str(target.parent)) as name:
        draft = Path(name) / "draft"
        make(draft)
        try:
            draft.rename(target)
        except OSError:
            if not target.exists():
                raise


def export(commit: str, folder: Path) -> None:
    """Write the files of a commit to a folder."""
    folder.mkdir()
    subprocess.run(["tar", "-x", "-C", str(folder)], check=True, input=git("archive", commit))


def other_checkout(commit: str, base: Path, logs: Path) -> Checkout:
    """Build another commit by its own ``./dev`` unless it is built already; raises BenchError."""
    tree, ours = base / commit[:12], ROOT / "bench"
    make_once(tree, lambda folder: export(commit, folder))
    files = [path for path in sorted(ours.rglob("*.*")) if path.suffix in (".py", ".lp", ".pddl")]
    digest = hashlib.sha256(b"".join(path.read_bytes() for path in files)).hexdigest()[:8]
    lent = tree / f"bench-{digest}"  # next to its own folder, so that "../src" belongs to that commit
    make_once(
        lent, lambda folder: shutil.copytree(str(ours), str(folder), ignore=shutil.ignore_patterns("__pycache__"))
    )
    os.environ["ROSOCLINGO_HOME"] = str(base)
    start = [str(tree / "dev"), "exec"]
    try:
        subprocess.run([*start, "true"], check=True)
    except (OSError, subprocess.CalledProcessError) as error:
        raise BenchError(f"commit {commit[:12]} cannot be built: {error}") from error
    return Checkout(commit[:8], lent, [*start, "python3"], logs)


def compare(bench: str, here: Checkout, there: Optional[Checkout], rounds: int) -> List[figures.Row]:
    """Run a bench for one checkout, or for two in turns; raises BenchError if it fails in this checkout."""
    runs: Dict[str, list] = {"here": [], "there": []}
    sides = {"here": here} if there is None else {"here": here, "there": there}
    missing = False
    for side in figures.turns(list(sides), rounds):
        if side == "there" and missing:
            continue
        report(f"{bench}: {sides[side].name}")
        try:
            runs[side].append(sides[side].measure(bench))
        except BenchError as failed:
            if side == "here" or runs["there"]:
                raise
            missing = True
            report(f"{bench}: not available in {sides[side].name}: {failed}")
    return figures.rows(bench, runs["here"], runs["there"])


def report(text: str) -> None:
    print(f"bench: {text}", file=sys.stderr, flush=True)


def measure_all(options, logs: Path) -> int:
    """Run the chosen benches and print the table; return the exit code."""
    here, there = Checkout("here", ROOT / "bench", [sys.executable], logs), None
    if options.against:
        there = other_checkout(options.against, options.work / "against", logs)
    found, failures = [], 0
    for bench in options.names or BENCHES:
        try:
            found += compare(bench, here, there, options.rounds)
        except BenchError as failed:
            failures += 1
            report(f"error: {bench} failed: {failed}")
    print(figures.table(found, there and there.name))
    print("load of the machine (1, 5, 15 min):", *(f"{load:.1f}" for load in os.getloadavg()))
    if failures:
        report(f"error: {failures} of {len(options.names or BENCHES)} failed")
    return min(failures, 1)


def command_line():
    """Return the options of the command line; exit with code 2 if it is wrong."""
    parser = argparse.ArgumentParser(
        "./dev bench", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"benches to run (default: all): {' '.join(BENCHES)}")
    parser.add_argument(
        "--against", type=commit_named, metavar="COMMIT", help="another commit to compare with this checkout"
    )
    parser.add_argument(
        "--rounds", type=int, help=f"runs of each bench (default: 1; with --against {FEWEST}, which is the least)"
    )
    # The work folder of ./dev. Without it, the command line is only checked, and the names of the benches are printed.
    parser.add_argument("--work", type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    for name in options.names:
        if name not in BENCHES:
            parser.error(f"no such bench: {name}; the benches are {' '.join(BENCHES)}")
    fewest = FEWEST if options.against else 1
    options.rounds = fewest if options.rounds is None else options.rounds
    if options.rounds < fewest:
        parser.error(f"--rounds must be at least {fewest}{' with --against' if options.against else ''}")
    return options


def main() -> int:
    options = command_line()
    if options.work is None:
        print(*(options.names or BENCHES))
        return 0
    (options.work / "bench").mkdir(exist_ok=True)
    logs = Path(tempfile.mkdtemp(dir=str(options.work / "bench")))
    try:
        code = measure_all(options, logs)
    except BenchError as failed:
        report(f"error: {failed}")
        return 1
    except KeyboardInterrupt:
        report(f"interrupted; the output of the benches is in {logs}")
        return 130
    if code == 0:
        shutil.rmtree(str(logs))  # after a failure, the logs show the cause
    return code


if __name__ == "__main__":
    sys.exit(main())
