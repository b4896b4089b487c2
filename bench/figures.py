"""Figures of benches, and the command line of a bench.

Each bench calls `main` with a function that yields its figures. Its command line has the options ``--short`` and
``--json FILE``. The file has one JSON object a line, with the fields of `Figure`. Benches can import the modules of
test/unit as well.
"""

import argparse
import json
import os
import resource
import statistics
import sys
import time
from pathlib import Path
from typing import Any, Callable, Dict, Iterable, Iterator, List, NamedTuple, Optional, Sequence

sys.path.append(str(Path(__file__).resolve().parents[1] / "test" / "unit"))


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


def parse(doc: str, options: Dict[str, Option]) -> argparse.Namespace:
    """Parse the command line of a bench; with ``--short``, the short values replace the defaults."""
    parser = argparse.ArgumentParser(description=doc, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--short", action="store_true", help="run the short form, at most two minutes; other options override it"
    )
    parser.add_argument("--json", type=Path, metavar="FILE", help="also write the figures as JSON lines to FILE")
    for name, (default, text, short, choices) in options.items():
        flag, value = "--" + name.replace("_", "-"), default
        if short is not None and "--short" in sys.argv:
            value = short
        if isinstance(default, bool):
            parser.add_argument(flag, action="store_true", default=value, help=text)
        else:
            nargs, first = ("+", default[0] if default else "") if isinstance(default, list) else (None, default)
            text += " (default: %(default)s)"
            parser.add_argument(flag, type=type(first), nargs=nargs, default=value, choices=choices, help=text)
    return parser.parse_args()


def main(doc: str, measure: Callable[[argparse.Namespace], Iterable[Figure]], **options: Option) -> None:
    """Run a bench: parse its options, print each figure of ``measure`` when it is known, and write all of them."""
    chosen, found = parse(doc, options), []
    for figure in measure(chosen):
        found.append(figure)
        print(f"{figure.name:<60} {number(figure.value):>9} {figure.unit}", flush=True)
    print_load()
    if chosen.json:
        lines = [json.dumps({**figure._asdict(), "value": float(figure.value)}) for figure in found]
        chosen.json.write_text("".join(line + "\n" for line in lines))


def read(path: Path) -> List[Figure]:
    """Read the figures that a bench wrote; raises OSError, TypeError or ValueError."""
    return [Figure(**json.loads(line)) for line in path.read_text().splitlines()]


def number(value: float) -> str:
    """Return a value with three significant digits, or all digits of its integer part."""
    return f"{value:.0f}" if abs(value) >= 100.0 else f"{value:.3g}"


def print_load() -> None:
    """Print the load of the machine, which affects wall times."""
    print("load of the machine (1, 5, 15 min):", *(f"{load:.1f}" for load in os.getloadavg()))


def row_figures(name: str, cells: Dict[str, Optional[float]], units: Dict[str, str]) -> Iterator[Figure]:
    """Yield the figures of a row that have a value, named by row and column; ``units`` has the columns in order."""
    for column, unit in units.items():
        if cells.get(column) is not None:
            yield Figure(f"{name}: {column}", cells[column], unit)


def quantiles(name: str, values: Sequence[float], unit: str) -> Iterator[Figure]:
    """Yield the median and the 99th percentile of some values."""
    ordered = sorted(values)
    yield Figure(f"{name}, median", statistics.median(ordered), unit)
    yield Figure(f"{name}, 99 %", ordered[int(0.99 * (len(ordered) - 1))], unit)


def processor_time(pid: int) -> float:
    """Return the processor time (s) of a running process."""
    return time.clock_gettime((~pid << 3) | 2)  # as clock_getcpuclockid(3) on Linux


def children_time() -> float:
    """Return the processor time (s) of all child processes that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
