"""The output of the command: text with tables for people, or one JSON object per line for programs."""

import json
from typing import IO, Any

from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.oclingo.service.table import format_answer
from rosoclingo.oclingo.solving.results import SolveOutcome, SolveResult


def write(stream: IO[str], text: str) -> None:
    """Write a text to a stream at once."""
    stream.write(text)
    stream.flush()


class ProgressReport:
    """Reports the progress of a search: on one line of a terminal, else on a new line every ten seconds."""

    def __init__(self, stream: IO[str]) -> None:
        self._stream, self._is_live = stream, stream.isatty()
        self._interval = 1.0 if self._is_live else 10.0
        self._last = 0.0  # seconds from the start of the search to the last report
        self._width = 0

    def report(self, seconds: float, what: str, reached: int) -> None:
        """Report the horizon that the search for ``what`` has ``reached`` after ``seconds``; call this often."""
        if seconds - self._last >= self._interval:
            self._last = seconds
            text = f"{what}: at step {reached}, no answer yet after {seconds:.0f} s"
            write(self._stream, f"\r{text:<{self._width}}" if self._is_live else f"{text}\n")
            self._width = len(text)

    def clear(self) -> None:
        """Clear the line at the end of a search."""
        if self._is_live and self._last:
            write(self._stream, "\r" + " " * self._width + "\r")
        self._last = 0.0


class TextOutput:
    """Prints updates as text, and answers as tables over time."""

    def __init__(self, stream: IO[str], width: int, echo: bool = True) -> None:
        """Print to ``stream``, tables ``width`` characters wide; without ``echo`` updates are not printed."""
        self._stream, self._width, self._echo = stream, width, echo

    def print_update(self, update: StreamUpdate) -> None:
        """Print an update."""
        if self._echo:
            write(self._stream, str(update))

    def print_result(self, update: StreamUpdate, result: SolveResult) -> None:
        """Print the result of an update."""
        for warning in result.warnings:
            write(self._stream, f"Warning: {warning}\n")
        for number, answer in enumerate(result.answers, 1):
            write(self._stream, f"Answer {number}, horizon {result.horizon}\n")
            write(self._stream, format_answer(answer, result.horizon + 1, self._width) or "(no atom)\n")
        if result.outcome is SolveOutcome.UNSATISFIABLE:
            ever = ", for good" if result.permanent else ""
            write(self._stream, f"UNSAT at step {result.horizon}{ever}\n")
        elif result.outcome is SolveOutcome.INTERRUPTED:
            write(self._stream, f"Interrupted at horizon {result.horizon}; the update stays in force\n")
        write(self._stream, "\n")

    def print_error(self, text: str, **where: str) -> None:
        """Print an error; ``where`` is the ``update`` that was refused, or the ``place`` in the text of one."""
        write(self._stream, f"{where.get('place', 'Error')}: {text}\n\n")


class JsonOutput:
    """Prints one line per update: a JSON object.

    Its members: ``update`` (text), ``step``, ``horizon``, ``outcome``, ``answers`` (lists of atoms, sorted),
    ``warnings``, ``permanent``, ``shortest``, ``statistics`` (seconds); or ``update`` and ``error``; or ``place`` and
    ``error``.
    """

    def __init__(self, stream: IO[str]) -> None:
        self._stream = stream

    def print_update(self, update: StreamUpdate) -> None:
        """Print nothing: the update is printed with its result."""

    def print_result(self, update: StreamUpdate, result: SolveResult) -> None:
        """Print an update with its result."""
        self._write(
            update=str(update),
            step=result.step,
            horizon=result.horizon,
            outcome=result.outcome.value,
            answers=[sorted(map(str, answer)) for answer in result.answers],
            warnings=list(result.warnings),
            permanent=result.permanent,
            shortest=result.shortest,
            statistics=result.statistics,
        )

    def print_error(self, text: str, **where: str) -> None:
        """Print an error; ``where`` is the ``update`` that was refused, or the ``place`` in the text of one."""
        self._write(**where, error=text)

    def _write(self, **members: Any) -> None:
        write(self._stream, json.dumps(members) + "\n")
