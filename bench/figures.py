"""Figures of benches: the command line of a bench, the file format, and the table that compares two versions.

Each bench calls `main` with a function that yields its figures. Its command line has the options ``--short`` and
``--json FILE``. The file has one JSON object a line, with the fields of `Figure`.
"""

import argparse
import json
import os
import resource
import statistics
import sys
from pathlib import Path
from typing import Any, Callable, Dict, Iterable, Iterator, List, NamedTuple, Optional, Sequence, Tuple

TENTH = 0.1  # larger differences of a ratio from 1 are marked


class Figure(NamedTuple):
    """One measured value; ``better`` is "lower" or "higher"."""

    name: str
    value: float
    unit: str
    better: str = "lower"


class Option(NamedTuple):
    """An option of a bench: its default gives the type, a list takes several values; ``short`` is for short forms."""

    default: Any
    help: str
    short: Any = None
    choices: Optional[Sequence[Any]] = None


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


def parse(doc: str, options: Dict[str, Option], words: Optional[Sequence[str]] = None) -> argparse.Namespace:
    """Parse the command line of a bench; with ``--short``, the short values replace the defaults."""
    parser = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--short", action="store_true", help="run the short form, at most two minutes; other options override it"
    )
    parser.add_argument("--json", type=Path, metavar="FILE", help="also write the figures as JSON lines to FILE")
    short = "--short" in (sys.argv[1:] if words is None else words)
    for name, (default, text, value, choices) in options.items():
        flag, default = "--" + name.replace("_", "-"), value if short and value is not None else default
        if isinstance(default, bool):
            parser.add_argument(flag, action="store_true", default=default, help=text)
        else:
            nargs, first = ("+", default[0] if default else "") if isinstance(default, list) else (None, default)
            text += " (default: %(default)s)"
            parser.add_argument(flag, type=type(first), nargs=nargs, default=default, choices=choices, help=text)
    return parser.parse_args(words)


def main(doc: str, measure: Callable[[argparse.Namespace], Iterable[Figure]], shown: bool = True, **options: Option):
    """Run a bench: parse its options, and print the figures of ``measure`` unless it prints them (not ``shown``)."""
    chosen, found = parse(doc, options), []
    for figure in measure(chosen):
        found.append(figure)
        if shown:
            print(f"{figure.name:<60} {number(figure.value):>9} {figure.unit}", flush=True)
    print("load of the machine (1, 5, 15 min):", *(f"{load:.1f}" for load in os.getloadavg()))
    write(chosen.json, found)


def write(path: Optional[Path], figures: Sequence[Figure]) -> None:
    """Write figures to a file if there is a ``path``."""
    if path is not None:
        lines = [json.dumps({**figure._asdict(), "value": float(figure.value)}) for figure in figures]
        path.write_text("".join(line + "\n" for line in lines))


def read(path: Path) -> List[Figure]:
    """Read the figures from a file of `write`; raises OSError, TypeError or ValueError."""
    return [Figure(**json.loads(line)) for line in path.read_text().splitlines()]


def quantiles(name: str, values: Sequence[float], unit: str) -> Iterator[Figure]:
    """Yield the median and the 99th percentile of some values."""
    ordered = sorted(values)
    yield Figure(f"{name}, median", statistics.median(ordered), unit)
    yield Figure(f"{name}, 99 %", ordered[int(0.99 * (len(ordered) - 1))], unit)


def children_time() -> float:
    """Return the processor time (s) of all child processes that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def rows(bench: str, here: Sequence[Sequence[Figure]], there: Sequence[Sequence[Figure]] = ()) -> List[Row]:
    """Group the figures of a bench in all runs of both sides by name, in the order of first occurrence."""
    first = {}
    for figure in (figure for run in (*here, *there) for figure in run):
        first.setdefault(figure.name, figure)

    def values(runs, name):
        return tuple(figure.value for run in runs for figure in run if figure.name == name)

    return [
        Row(bench, name, figure.unit, figure.better, values(here, name), values(there, name))
        for name, figure in first.items()
    ]


def number(value: float) -> str:
    """Return a value with three significant digits, or all digits of its integer part."""
    return f"{value:.0f}" if abs(value) >= 100.0 else f"{value:.3g}"


def table(found: Sequence[Row], other: Optional[str] = None) -> str:
    """Return the table of figures: best and median of each side, and the ratio if there are two sides."""
    head = ["bench", "figure", "unit", "best", "median"]
    lines = [head if other is None else [*head, f"{other}: best", "median", "ratio", ""]]
    for row in found:
        cells = [row.bench, row.name, row.unit, *_cells(row, row.here)]
        if other is not None:
            cells += [*_cells(row, row.there), "-" if row.ratio is None else f"{row.ratio:.2f}", row.mark]
        lines.append(cells)
    widths = [max(map(len, column)) for column in zip(*lines)]
    return "\n".join(_line(cells, widths) for cells in lines)


def _cells(row: Row, values: Sequence[float]) -> List[str]:
    return [number(row.best(values)), number(statistics.median(values))] if values else ["-", "-"]


def _line(cells: Sequence[str], widths: Sequence[int]) -> str:
    words, numbers = zip(cells[:3], widths), zip(cells[3:8], widths[3:])
    aligned = [cell.ljust(width) for cell, width in words] + [cell.rjust(width) for cell, width in numbers]
    return "  ".join([*aligned, *cells[8:]]).rstrip()
