"""Answers as tables over time: a row for each atom without its time, a column for each time step."""

from functools import lru_cache
from typing import Dict, Iterable, List, Optional, Set, Tuple

import clingo

Row = Tuple[str, Set[int]]


def format_answer(answer: Iterable[clingo.Symbol], last: int, width: int = 100) -> str:
    """Return ``answer`` as a table of lines, at most ``width`` characters wide if possible.

    The time of an atom is its last argument, if that is an integer in 0..``last`` in all atoms of its predicate. The
    row shows ``t`` in its place, and ``x`` in the columns of the times. Atoms without time come first; wide tables are
    split into blocks of columns.
    """
    timeless, rows = _sort(answer, last)
    lines = _wrap(timeless, width)
    if rows:
        margin = max(len(stem) for stem, _ in rows)
        times = sorted(set().union(*(held for _, held in rows)))
        cell = len(str(times[-1])) + 1
        size = max((width - margin - 2) // cell, 10)
        for start in range(times[0], times[-1] + 1, size):
            lines += _block_lines(rows, range(start, min(start + size, times[-1] + 1)), margin, cell)
    return "".join(f"{line.rstrip()}\n" for line in lines)


def _sort(answer: Iterable[clingo.Symbol], last: int) -> Tuple[List[str], List[Row]]:
    """Return the atoms without time, and the rows sorted by predicate and first time."""
    atoms = [_text_signature_and_time(atom) for atom in answer]
    without_time = {signature for _, signature, time in atoms if time is None or time > last}
    held: Dict[Tuple[str, int, str], Set[int]] = {}
    for text, signature, time in atoms:
        if time is not None and signature not in without_time:
            stem = text[: -len(f"{time})")] + "t)"
            held.setdefault((*signature, stem), set()).add(time)
    timeless = [text for text, signature, _ in atoms if signature in without_time]
    order = sorted(held, key=lambda key: (key[0], key[1], min(held[key]), key[2]))
    return sorted(timeless), [(key[2], held[key]) for key in order]


@lru_cache(maxsize=4096)  # most atoms of an answer are in the previous one
def _text_signature_and_time(atom: clingo.Symbol) -> Tuple[str, Tuple[str, int], Optional[int]]:
    if atom.type is not clingo.SymbolType.Function:
        return str(atom), ("", 0), None
    name, arguments = atom.name, atom.arguments
    time = arguments[-1] if name and arguments else atom
    timed = time.type is clingo.SymbolType.Number and time.number >= 0
    return str(atom), (name, len(arguments)), time.number if timed else None


def _wrap(words: List[str], width: int) -> List[str]:
    lines: List[str] = []
    for word in words:
        if lines and len(lines[-1]) + 2 + len(word) <= width:
            lines[-1] += "  " + word
        else:
            lines.append(word)
    return lines


def _block_lines(rows: List[Row], times: range, margin: int, cell: int) -> List[str]:
    """Return the header and rows of one block of columns, without its empty rows."""
    lines = [" " * (margin + 1) + "".join(f"{time:>{cell}}" for time in times)]
    for stem, held in rows:
        if held.intersection(times):
            lines.append(f"{stem:<{margin}} " + "".join(("x" if time in held else ".").rjust(cell) for time in times))
    return lines
