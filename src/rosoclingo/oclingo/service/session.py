"""Sessions with a solver: updates from a stream file or from a prompt."""

import signal
import sys
import time
from contextlib import contextmanager
from dataclasses import replace
from typing import Iterable, Iterator, List, Optional, Union

from rosoclingo.oclingo.errors import ProgressionError, SolverError
from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.oclingo.service.output import JsonOutput, ProgressReport, TextOutput
from rosoclingo.oclingo.service.protocol import Request, read_updates
from rosoclingo.oclingo.solving.results import SolveOutcome, SolveResult
from rosoclingo.oclingo.solving.stream_solver import StreamSolver

_PROMPT, _PROMPT_MORE = "oclingo> ", "    ...> "

Output = Union[TextOutput, JsonOutput]


class UpdateAssembler:
    """Assembles updates from lines, and returns each one once it is complete."""

    def __init__(self) -> None:
        self._pending = ""
        self._before = 0  # lines of earlier updates
        self._can_end = False

    @property
    def pending(self) -> bool:
        """Whether there is an incomplete update."""
        return bool(self._pending.strip())

    def feed(self, line: str, is_last: bool = False) -> List[Request]:
        """Append ``line`` and return the updates that are now complete.

        An incomplete update is an error if the line ``is_last``. An error is the last item and has a line number of the
        whole input; the rest of the text is dropped.
        """
        self._pending += line
        self._can_end = self._can_end or "#end" in line or "#stop" in line
        if not is_last and not (self._can_end and "." in line):
            return []
        text, found = self._pending, list(read_updates(self._pending))
        error = found[-1] if found else None
        if isinstance(error, ProgressionError):
            end = (text.count("\n") + 1, len(text) - text.rfind("\n"))
            if not is_last and (error.line, error.column) == end:
                return []  # the update continues
            found[-1] = ProgressionError(self._before + error.line, error.column, error.message)
        self.clear()
        return found

    def clear(self) -> None:
        """Drop the incomplete update."""
        self._before += self._pending.count("\n")
        self._pending, self._can_end = "", False


class Session:
    """Sends a stream of updates to one solver and prints the results.

    Attributes:
        failed: whether there was a syntax error or a refused update.
        unsatisfiable: whether an update had no answer up to its bound.

    """

    def __init__(
        self,
        solver: StreamSolver,
        output: Output,
        time_limit: Optional[float] = None,
        bound: int = 0,
        progress: Optional[ProgressReport] = None,
    ) -> None:
        """Send updates to ``solver``.

        ``time_limit`` ends a search after that many seconds. ``bound`` applies to updates without one (0: no bound).
        ``progress`` reports long searches.
        """
        self._solver, self._output, self._time_limit = solver, output, time_limit
        self._bound, self._progress = bound, progress
        self._bounded = False
        self._interrupted = False
        self.failed = self.unsatisfiable = False

    def play(self, lines: Iterable[str], name: str) -> None:
        """Send the updates of the text ``name`` until ``#stop.`` or its end; errors are printed and skipped."""
        assembler = UpdateAssembler()
        for line in lines:
            if not self._take(assembler.feed(line), name):
                return
        self._take(assembler.feed("", is_last=True), name)

    def ask(self, name: str = "<input>") -> None:
        """Read updates at a prompt until ``#stop.`` or the end of the input (Ctrl-D).

        Ctrl-C ends a search; at the prompt it drops the incomplete update.
        """
        assembler, prompts = UpdateAssembler(), sys.stdin.isatty()
        while True:
            try:
                line = input((_PROMPT_MORE if assembler.pending else _PROMPT) if prompts else "") + "\n"
            except EOFError:
                self._take(assembler.feed("", is_last=True), name)
                return
            except KeyboardInterrupt:
                assembler.clear()
                sys.stdout.write("\n")
                continue
            with self._interruptible():
                if not self._take(assembler.feed(line), name):
                    return

    def _take(self, requests: Iterable[Request], name: str) -> bool:
        """Send the updates of ``requests`` and print the errors; return False after ``#stop.``"""
        for request in requests:
            if isinstance(request, ProgressionError):
                self.failed = True
                self._output.print_error(request.message, place=f"{name}:{request.line}:{request.column}")
            elif request.stops:
                return False
            else:
                self._play(request)
        return True

    def _play(self, update: StreamUpdate) -> None:
        self._interrupted = False
        self._output.print_update(update)
        try:
            result = self._search(self._with_bound(update))
            self.unsatisfiable |= result.outcome is SolveOutcome.UNSATISFIABLE
            self._output.print_result(update, result)
        except SolverError as error:
            self.failed = True
            self._output.print_error(str(error), update=str(update))

    def _with_bound(self, update: StreamUpdate) -> StreamUpdate:
        """Return ``update`` with the default bound, unless it has one or inherits that of the previous update."""
        if not self._bound or update.bound is not None or (update.step is None and self._bounded):
            self._bounded = self._bounded or update.step is not None
            return update
        self._bounded = True
        return replace(update, step=self._solver.step if update.step is None else update.step, bound=self._bound)

    def _search(self, update: StreamUpdate) -> SolveResult:
        step = self._solver.step if update.step is None else update.step
        what = f"update of step {step}" + ("" if update.bound is None else f", up to step {step + update.bound}")
        start = time.monotonic()

        def must_end() -> bool:
            """Report the progress, and return whether the search must end."""
            seconds = time.monotonic() - start
            if self._progress is not None:
                self._progress.report(seconds, what, self._solver.reached)
            return self._interrupted or (self._time_limit is not None and seconds >= self._time_limit)

        try:
            return self._solver.update(update, must_end)
        finally:
            if self._progress is not None:
                self._progress.clear()

    @contextmanager
    def _interruptible(self) -> Iterator[None]:
        """Let Ctrl-C end the search and not the session."""

        def interrupt(number: int, frame: object) -> None:
            self._interrupted = True

        before = signal.signal(signal.SIGINT, interrupt)
        try:
            yield
        finally:
            signal.signal(signal.SIGINT, before)
