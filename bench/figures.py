"""What a bench has measured: handed on to programs, and set beside what another version has.

A bench takes ``--short`` and ``--json FILE``; the file has one JSON object a line, with the fields of `Figure`.
"""

import json
import statistics
from pathlib import Path
from typing import Iterator, List, NamedTuple, Optional, Sequence, Tuple

TENTH = 0.1  # a ratio that is further from 1 is marked


class FigureError(ValueError):
    """A file is not what a bench writes; the message names the file and the line."""


class Figure(NamedTuple):
    """One measured value; ``better`` is "lower" or "higher"."""

    name: str
    value: float
    unit: str
    better: str = "lower"


class Row(NamedTuple):
    """One figure in all runs: what this checkout and the other commit had, both empty where there was none."""

    bench: str
    name: str
    unit: str
    better: str
    here: Tuple[float, ...]
    there: Tuple[float, ...]

    def best(self, values: Sequence[float]) -> float:
        """The best of some runs: what else the machine does only makes it worse."""
        return min(values) if self.better == "lower" else max(values)

    @property
    def ratio(self) -> Optional[float]:
        """This checkout's best over the other commit's; None where a side has none."""
        if not (self.here and self.there):
            return None
        here, there = self.best(self.here), self.best(self.there)
        if there == 0.0:
            return 1.0 if here == 0.0 else float("inf")
        return here / there

    @property
    def mark(self) -> str:
        """ "better" or "worse" where the two differ by more than a tenth, else nothing; "?" follows if runs overlap."""
        if self.ratio is None or abs(self.ratio - 1.0) <= TENTH:
            return ""
        apart = max(self.here) < min(self.there) or min(self.here) > max(self.there)
        word = "better" if (self.ratio < 1.0) == (self.better == "lower") else "worse"
        return word if apart else word + "?"


def parse(parser, **short):
    """Parse a bench's command line; with ``--short`` the values in ``short`` take the place of the defaults."""
    parser.add_argument(
        "--short", action="store_true", help="the short form, at most two minutes; other options still count"
    )
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the figures as JSON lines, too")
    if parser.parse_known_args()[0].short:
        parser.set_defaults(**short)
    return parser.parse_args()


def write(path: Optional[Path], figures: Sequence[Figure]) -> None:
    """Write figures to a file; nothing where there is no path."""
    if path is not None:
        lines = [json.dumps({**figure._asdict(), "value": float(figure.value)}) for figure in figures]
        path.write_text("".join(line + "\n" for line in lines))


def read(path: Path) -> List[Figure]:
    """Read what `write` has written; raises FigureError."""
    figures = []
    for number, line in enumerate(path.read_text().splitlines(), 1):
        try:
            figure = Figure(**json.loads(line))
        except (TypeError, ValueError):
            raise FigureError(f"{path}:{number}: this is no figure: {line}") from None
        if not isinstance(figure.value, (int, float)) or figure.better not in ("lower", "higher"):
            raise FigureError(f"{path}:{number}: a figure has a number as value, and lower or higher is better: {line}")
        figures.append(figure)
    return figures


def turns(sides: Sequence[str], rounds: int) -> Iterator[str]:
    """Yield whose turn it is: the sides take turns, so that whatever else the machine does hits all alike."""
    for _ in range(rounds):
        yield from sides


def rows(bench: str, here: Sequence[Sequence[Figure]], there: Sequence[Sequence[Figure]] = ()) -> List[Row]:
    """Gather a bench's figures of all runs of both sides by their names, in the order in which they came."""
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
    """Return a value with three digits, or all of a whole part that has more."""
    return f"{value:.0f}" if abs(value) >= 100.0 else f"{value:.3g}"


def table(found: Sequence[Row], other: Optional[str] = None) -> str:
    """Return the figures as text: best and median of each side, and where there are two the ratio of the bests."""
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
