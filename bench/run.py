#!/usr/bin/env python3
"""Runs the short forms of the benches one after the other and prints one table of their figures: ./dev bench.

With --against, the benches measure this checkout and another commit in turns, in at least three rounds. The other
commit is built once, in a folder outside the source tree. The benches of this checkout measure both. If one does not
run with the other commit, that commit's own bench of this name measures it; if neither runs, it is reported as not
available. The ratio compares the best runs of figures with equal names. "better" and "worse" mark
a difference of more than a tenth. A "?" means that the runs of both sides overlap; repeat the bench with more rounds or
on a quieter machine.

Exit codes: 0 for success, 1 if a bench failed or the other commit cannot be built, 2 for a wrong command line.
"""

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import List, NamedTuple, Optional, Sequence, Tuple

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


class Checkout(NamedTuple):
    """This checkout, or the tree of another commit: the folders of the benches and of logs, and the command's start."""

    name: str
    folder: Path
    start: Sequence[str]
    logs: Path

    def measure(self, bench: str) -> List[figures.Figure]:
        """Run the short form of a bench; raises BenchError."""
        handle, name = tempfile.mkstemp(prefix=f"{bench}-{self.name}-", suffix=".log", dir=str(self.logs))
        os.close(handle)
        log = Path(name)
        result = log.with_suffix(".json")
        command = [*self.start, str(self.folder / f"{bench}.py"), "--short", "--json", str(result)]
        code = run(command, log, LIMIT, os.environ).code
        if code is None:
            raise BenchError(f"it did not end within {LIMIT:.0f} s; output: {log}")
        if code != 0:
            last = log.read_text(errors="replace").rstrip().splitlines()[-SHOWN:]
            raise BenchError("\n    ".join([f"exit code {code}; complete output: {log}", *last]))
        try:
            return figures.read(result)
        except (OSError, TypeError, ValueError) as error:
            raise BenchError(f"it wrote no figures: {error}") from error


def git(*arguments: str) -> bytes:
    """Return the output of a git command for this checkout; raises subprocess.CalledProcessError."""
    return subprocess.run(["git", "-C", str(ROOT), *arguments], check=True, capture_output=True).stdout


def commit_named(text: str) -> str:
    """Return the hash of a commit, as a type for argparse."""
    try:
        return git("rev-parse", "--verify", "--quiet", text + "^{commit}").decode().strip()
    except FileNotFoundError:
        raise argparse.ArgumentTypeError("git is not installed; it is needed for the other commit") from None
    except subprocess.CalledProcessError as error:
        why = error.stderr.decode().strip() or f"git knows no such commit: {text}"
        raise argparse.ArgumentTypeError(why) from None


def other_checkout(commit: str, base: Path, logs: Path) -> Checkout:
    """Build another commit by its own ``./dev`` unless it is built already; raises BenchError."""
    tree = base / commit[:12]
    if not tree.exists():
        base.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=str(base)) as draft:
            archive = git("archive", commit, f"--prefix={tree.name}/")
            subprocess.run(["tar", "-x", "-C", draft], check=True, input=archive)
            (Path(draft) / tree.name).rename(tree)
    lent = tree / "bench-here"  # next to its own folder, so that "../src" belongs to that commit
    shutil.rmtree(str(lent), ignore_errors=True)
    shutil.copytree(str(ROOT / "bench"), str(lent))
    os.environ["ROSOCLINGO_HOME"] = str(base)
    start = [str(tree / "dev"), "exec"]
    try:
        subprocess.run([*start, "true"], check=True)
    except (OSError, subprocess.CalledProcessError) as error:
        raise BenchError(f"commit {commit[:12]} cannot be built: {error}") from error
    return Checkout(commit[:8], lent, [*start, "python3"], logs)


def compare(bench: str, here: Checkout, there: Optional[Checkout], rounds: int) -> List[figures.Row]:
    """Run a bench for one checkout, or for two in turns, so that other load on the machine affects both equally.

    Raises BenchError if it fails in this checkout, or after it has run in the other one.
    """
    ours: List[Sequence[figures.Figure]] = []
    theirs: List[Sequence[figures.Figure]] = []
    for _ in range(rounds):
        report(f"{bench}: {here.name}")
        ours.append(here.measure(bench))
        if there is None:
            continue
        report(f"{bench}: {there.name}")
        if theirs:
            theirs.append(there.measure(bench))
        else:
            there, found = measure_first(bench, there)
            theirs += found
    return figures.rows(bench, ours, theirs)


def measure_first(bench: str, there: Checkout) -> Tuple[Optional[Checkout], List[Sequence[figures.Figure]]]:
    """Run a bench with another commit, or the commit's own bench of this name; return what runs, and its figures."""
    failures = []
    for folder in (there.folder, there.folder.with_name("bench")):
        if (folder / f"{bench}.py").exists():
            try:
                chosen = there._replace(folder=folder)
                return chosen, [chosen.measure(bench)]
            except BenchError as failed:
                failures.append(f"{folder.name}/{bench}.py: {failed}")
    report("\n".join([f"{bench}: not available in {there.name}:", *failures]))
    return None, []


def report(text: str) -> None:
    print(f"bench: {text}", file=sys.stderr, flush=True)


def measure_all(options, logs: Path) -> int:
    """Run the chosen benches and print the table; return the exit code."""
    here, there = Checkout("here", ROOT / "bench", [sys.executable], logs), None
    if options.against:
        there = other_checkout(options.against, options.work / "against", logs)
    found, failures = [], 0
    for bench in options.names:
        try:
            found += compare(bench, here, there, options.rounds)
        except BenchError as failed:
            failures += 1
            report(f"error: {bench} failed: {failed}")
    print(figures.table(found, there and there.name))
    print("load of the machine (1, 5, 15 min):", *(f"{load:.1f}" for load in os.getloadavg()))
    if failures:
        report(f"error: {failures} of {len(options.names)} failed")
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
    parser.add_argument("--work", type=Path, required=True, help=argparse.SUPPRESS)  # the work folder of ./dev
    options = parser.parse_args()
    for name in options.names:
        if name not in BENCHES:
            parser.error(f"no such bench: {name}; the benches are {' '.join(BENCHES)}")
    options.names = options.names or BENCHES
    fewest = FEWEST if options.against else 1
    options.rounds = fewest if options.rounds is None else options.rounds
    if options.rounds < fewest:
        parser.error(f"--rounds must be at least {fewest}{' with --against' if options.against else ''}")
    return options


def main() -> int:
    options = command_line()
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
