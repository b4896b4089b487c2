#!/usr/bin/env python3
"""Runs the short forms of the benches one after the other and prints one table of their figures: ./dev bench.

With --against, the benches measure this checkout and another commit in turns, by default in three rounds. The other
commit is built once, in a folder outside the source tree. The benches of this checkout measure both. If one does not
run with the other commit, that commit's own bench of this name measures it. The ratio compares the best runs of
figures with equal names. "better" and "worse" mark a difference of more than a tenth. A "?" means that the runs of
both sides overlap; repeat the bench with more rounds or on a quieter machine.

Exit codes: 0 for success, 1 if a bench failed or the other commit cannot be built, 2 for a wrong command line.
"""

import argparse
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import List, NamedTuple, Optional, Sequence, Tuple

from figures import Figure, number, print_load, read

ROOT = Path(__file__).resolve().parents[1]
sys.path.append(str(ROOT / "test"))

from processes import run  # noqa: E402

BENCHES = sorted(
    path.stem
    for path in (ROOT / "bench").glob("*.py")
    if path != Path(__file__).resolve() and path.read_text().startswith("#!")  # the other files are modules
)
LIMIT = 900.0  # s, time limit of a bench
TENTH = 0.1  # larger differences of a ratio from 1 are marked


class BenchError(Exception):
    """A bench has failed; the message contains the cause."""


class Row(NamedTuple):
    """The values of one figure in all runs of this checkout and of the other commit; empty if it was not measured."""

    bench: str
    name: str
    unit: str
    better: str
    here: Tuple[float, ...]
    there: Tuple[float, ...]

    def best(self, values: Sequence[float]) -> float:
        """Return the best of some values: other load on the machine can only make a run worse."""
        return min(values) if self.better == "lower" else max(values)

    @property
    def ratio(self) -> Optional[float]:
        """The ratio of the best values, this checkout to the other commit; None if either has no value."""
        if not (self.here and self.there):
            return None
        here, there = self.best(self.here), self.best(self.there)
        if there == 0.0:
            return 1.0 if here == 0.0 else float("inf")
        return here / there

    @property
    def mark(self) -> str:
        """The mark "better" or "worse" for a difference of more than a tenth, else empty; with "?" if runs overlap."""
        if self.ratio is None or abs(self.ratio - 1.0) <= TENTH:
            return ""
        apart = max(self.here) < min(self.there) or min(self.here) > max(self.there)
        word = "better" if (self.ratio < 1.0) == (self.better == "lower") else "worse"
        return word if apart else word + "?"


def rows(bench: str, here: Sequence[Figure], there: Sequence[Figure]) -> List[Row]:
    """Group the figures of all runs of a bench by name, in the order of first occurrence."""
    first = {}
    for figure in (*here, *there):
        first.setdefault(figure.name, figure)
    sides = {name: [tuple(one.value for one in side if one.name == name) for side in (here, there)] for name in first}
    return [Row(bench, name, one.unit, one.better, *sides[name]) for name, one in first.items()]


def table(found: Sequence[Row], other: Optional[str] = None) -> str:
    """Return the table of figures: best and median of each side, and the ratio if there are two sides."""
    lines = [["bench", "figure", "unit", "best", "median"]]
    if other is not None:
        lines[0] += [f"{other}: best", "median", "ratio", ""]
    for row in found:
        cells = [row.bench, row.name, row.unit, *_cells(row, row.here)]
        if other is not None:
            cells += [*_cells(row, row.there), "-" if row.ratio is None else f"{row.ratio:.2f}", row.mark]
        lines.append(cells)
    widths = [max(map(len, column)) for column in zip(*lines)]
    ways = [str.ljust] * 3 + [str.rjust] * 5 + [str.ljust]
    aligned = ([way(*one) for way, *one in zip(ways, line, widths)] for line in lines)
    return "\n".join("  ".join(cells).rstrip() for cells in aligned)


def _cells(row: Row, values: Sequence[float]) -> List[str]:
    return [number(row.best(values)), number(statistics.median(values))] if values else ["-", "-"]


class Checkout(NamedTuple):
    """The benches in a folder of this checkout or of another commit; ``start`` is the start of the command."""

    name: str
    folder: Path
    start: Sequence[str]

    def measure(self, bench: str) -> List[Figure]:
        """Run the short form of a bench; raises BenchError."""
        report(f"{bench}: {self.name}")
        with tempfile.TemporaryDirectory() as folder:
            log, result = Path(folder, "log"), Path(folder, "figures")
            command = [*self.start, str(self.folder / f"{bench}.py"), "--short", "--json", str(result)]
            code = run(command, log, LIMIT, os.environ).code
            if code != 0:
                end = f"it did not end within {LIMIT:.0f} s" if code is None else f"exit code {code}"
                raise BenchError(f"{end}; its output:\n{log.read_text(errors='replace')}")
            try:
                return read(result)
            except (OSError, TypeError, ValueError) as error:
                raise BenchError(f"it wrote no figures: {error}") from error


def commit_named(text: str) -> str:
    """Return the hash of a commit, as a type for argparse."""
    command = ["git", "-C", str(ROOT), "rev-parse", "--verify", text + "^{commit}"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise argparse.ArgumentTypeError(f"git knows no such commit: {text} ({done.stderr.strip()})")
    return done.stdout.strip()


def other_checkouts(commit: str, base: Path) -> List[Checkout]:
    """Build another commit by its own ``./dev``; return this checkout's benches and its own; raises BenchError."""
    tree = base / commit[:12]
    lent = tree / "bench-here"  # next to its own folder, so that "../src" belongs to that commit
    os.environ["ROSOCLINGO_HOME"] = str(base)
    start = [str(tree / "dev"), "exec"]
    try:
        if not tree.exists():
            subprocess.run(["git", "clone", "--quiet", "--shared", "--no-checkout", str(ROOT), str(tree)], check=True)
        subprocess.run(["git", "-C", str(tree), "checkout", "--quiet", "--detach", commit], check=True)
        shutil.rmtree(str(lent), ignore_errors=True)
        shutil.copytree(str(ROOT / "bench"), str(lent))
        subprocess.run([*start, "true"], check=True)
    except (OSError, subprocess.CalledProcessError) as error:
        raise BenchError(f"commit {commit[:12]} cannot be built: {error}") from error
    name, start = commit[:8], [*start, "python3"]
    return [Checkout(name, lent, start), Checkout(f"{name}, its own bench", tree / "bench", start)]


def compare(bench: str, here: Checkout, there: Sequence[Checkout], rounds: int) -> List[Row]:
    """Run a bench in turns with the other commit, so that other load on the machine affects both equally.

    A checkout of ``there`` in which it fails is replaced by the next one. Raises BenchError if it fails ``here``.
    """
    ours: List[Figure] = []
    theirs: List[Figure] = []
    for _ in range(rounds):
        ours += here.measure(bench)
        for other in there:
            try:
                theirs += other.measure(bench)
                break
            except BenchError as failed:
                report(f"{bench}: not available in {other.name}: {failed}")
                theirs, there = [], there[1:]
    return rows(bench, ours, theirs)


def report(text: str) -> None:
    print(f"bench: {text}", file=sys.stderr, flush=True)


def measure_all(options) -> int:
    """Run the chosen benches and print the table; return the exit code."""
    here, there = Checkout("here", ROOT / "bench", [sys.executable]), []
    if options.against:
        there = other_checkouts(options.against, options.work / "against")
    found, failures = [], 0
    for bench in options.names:
        try:
            found += compare(bench, here, there, options.rounds)
        except BenchError as failed:
            failures += 1
            report(f"error: {bench} failed: {failed}")
    print(table(found, there[0].name if there else None))
    print_load()
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
    parser.add_argument("--rounds", type=int, help="runs of each bench (default: 1; 3 with --against)")
    parser.add_argument("--work", type=Path, required=True, help=argparse.SUPPRESS)  # the work folder of ./dev
    options = parser.parse_args()
    for name in options.names:
        if name not in BENCHES:
            parser.error(f"no such bench: {name}; the benches are {' '.join(BENCHES)}")
    options.names = options.names or BENCHES
    if options.rounds is None:
        options.rounds = 3 if options.against else 1
    if options.rounds < 1:
        parser.error("--rounds must be at least 1")
    return options


def main() -> int:
    try:
        return measure_all(command_line())
    except BenchError as failed:
        report(f"error: {failed}")
        return 1
    except KeyboardInterrupt:
        report("interrupted")
        return 130


if __name__ == "__main__":
    sys.exit(main())
