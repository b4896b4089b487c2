"""The child of a ``WorkerPool``: a solver that does what its standard input says.

Started as ``python3 -m rosoclingo.planning.workers.worker_main LIFELINE``, where LIFELINE is the
number of a file descriptor: the
reading end of a pipe that nobody writes to. When the parent goes, however it goes, its end is closed, and the kernel
ends this process by SIGIO, even in the midst of grounding.
"""

import fcntl
import os
import select
import signal
import sys
import time
from contextlib import suppress
from typing import Callable, Dict, List, Optional, Union

from rosoclingo.oclingo.errors import DroppedError, ProgramError, SolverError
from rosoclingo.oclingo.progression.parser import parse_update
from rosoclingo.oclingo.solving.reactive_solver import ReactiveSolver
from rosoclingo.planning.explaining.explainer import explain
from rosoclingo.planning.history import Checkpoint
from rosoclingo.planning.minimal_sets import UndecidedError
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.planning.text import symbols_from_text
from rosoclingo.planning.workers.child import REACHED
from rosoclingo.planning.workers.known_histories import KnownHistories
from rosoclingo.planning.workers.logged_solver import LoggedSolver
from rosoclingo.planning.workers.wire import (
    Lines,
    Message,
    encode,
    faults_to_message,
    plan_from_message,
    program_from_message,
    result_to_message,
    stream_from_message,
    verdict_to_message,
)

_CHUNK = 1 << 20

EXPLAINING = 10
"""By so much a process that explains gives way to others (nice)."""

TELLING = 0.5
"""Seconds of wall time between two words on how far a search is."""

AnySolver = Union[PlanSolver, LoggedSolver]


class Commands:
    """The messages of the parent."""

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor
        self._lines = Lines()
        self._queue: List[Message] = []

    def next(self) -> Message:
        """Wait for the next command; SystemExit where the parent has gone. Interrupts that come late are left out."""
        while True:
            while self._queue:
                command = self._queue.pop(0)
                if command["do"] not in ("interrupt", "drop", "now"):
                    return command
            self._read()

    def are_none(self, seconds: float) -> bool:
        """Wait so many seconds of wall time, and tell whether nothing has come, or the word to begin at once."""
        end = time.monotonic() + seconds
        while not self._queue and (left := end - time.monotonic()) > 0:
            if select.select([self._descriptor], [], [], left)[0]:
                self._read()
        return all(command["do"] == "now" for command in self._queue)

    def have_come(self) -> bool:
        """Tell whether anything has come."""
        while select.select([self._descriptor], [], [], 0)[0]:
            self._read()
        return bool(self._queue)

    def interrupted(self) -> bool:
        """Tell whether the search at work is to be ended."""
        return self._asked("interrupt")

    def dropped(self) -> bool:
        """Tell whether the command at work is to be dropped."""
        return self._asked("drop")

    def _asked(self, what: str) -> bool:
        return self.have_come() and any(command["do"] == what for command in self._queue)

    def _read(self) -> None:
        data = os.read(self._descriptor, _CHUNK)
        if not data:
            raise SystemExit(0)
        self._queue.extend(self._lines.feed(data))


class WorkerMain:
    """Does commands, one after the other, and answers each.

    It keeps nothing but caches: histories with their snapshots, and the solver's groundings.
    """

    def __init__(self, commands: Commands) -> None:
        self._commands = commands
        self._solver: Optional[AnySolver] = None
        self._known = KnownHistories()
        self._tell: Callable[[Message], None] = lambda message: None
        self._handlers: Dict[str, Callable[[Message], Message]] = {
            "load": self._load,
            "update": self._update,
            "prefetch": self._prefetch,
            "improve": self._improve,
            "shorten": self._shorten,
            "inquire": self._inquire,
            "explain": self._explain,
        }

    def run(self, answer: Callable[[Message], None]) -> None:
        """Serve until the parent closes its end."""
        self._tell = answer
        while True:
            command = self._commands.next()
            if "history" in command:
                self.solver.restore(self._known.take(command["history"]))
                self.solver.log.plan = plan_from_message(command.get("plan", {})) or self.solver.log.plan
            try:
                reply = self._handlers[command["do"]](command)
            except SolverError as error:
                reply = {"refused": str(error), "dropped": isinstance(error, DroppedError)}
            if "after" in command:
                self._known.keep(command["after"], self.solver.log)
            answer(reply)
            if command.get("improves"):
                answer(self._shortened(reply))

    @property
    def solver(self) -> AnySolver:
        """The solver, once the program is loaded."""
        assert self._solver is not None
        return self._solver

    def _load(self, command: Message) -> Message:
        try:
            program = program_from_message(command["program"])
        except ProgramError as error:
            return faults_to_message(error.faults)
        options = dict(command["options"])
        if options.pop("shortest", False):
            self._solver = PlanSolver(program, **options)
        else:
            options.pop("plan_time", None)
            self._solver = LoggedSolver(lambda: ReactiveSolver(program, **options))
        return {}

    def _update(self, command: Message) -> Message:
        """Take an update, and search."""
        update, stopped = command["update"], self._telling()
        if update is None:
            result = self.solver.solve(stopped, self._commands.dropped)
        else:
            result = self.solver.update(parse_update(update), stopped, self._commands.dropped)
        entry = self.solver.log.entry
        checkpoint = entry.message if isinstance(entry, Checkpoint) else None
        told = result_to_message(result, self.solver.program, isinstance(self.solver, PlanSolver))
        return {**told, "grounded": self.solver.horizon, "checkpoint": checkpoint}

    def _telling(self) -> Callable[[], bool]:
        """Return what tells whether a search is to be ended; now and then it tells the parent how far that is."""
        told = time.monotonic()

        def interrupted() -> bool:
            """Look."""
            nonlocal told
            if time.monotonic() - told >= TELLING:
                told = time.monotonic()
                self._tell({REACHED: self.solver.reached})
            return self._commands.interrupted()

        return interrupted

    def _prefetch(self, command: Message) -> Message:
        """Answer an update that may come, unless something else does before long."""
        return self._update(command) if self._commands.are_none(command["pause"]) else {"left": True}

    def _shortened(self, reply: Message) -> Message:
        """Shorten the plan in a ``reply`` until something comes; an empty message if it gets no shorter."""
        shorter: Message = {}
        with suppress(SolverError):  # the plan that there is remains one
            while "outcome" in reply and not self._commands.have_come():
                result = self._planner.improve(self._commands.have_come)
                if result is None:
                    break
                shorter = result_to_message(result, self.solver.program)
        return shorter

    @property
    def _planner(self) -> PlanSolver:
        assert isinstance(self._solver, PlanSolver)
        return self._solver

    def _improve(self, _command: Message) -> Message:
        """Shorten the plan."""
        result = self._planner.improve(self._commands.interrupted)
        return {} if result is None else result_to_message(result, self.solver.program)

    def _shorten(self, _command: Message) -> Message:
        """Put a checkpoint at the end of the history."""
        self._planner.begin_log_anew()
        entry = self.solver.log.entry
        assert isinstance(entry, Checkpoint)
        return {"checkpoint": entry.message}

    def _inquire(self, command: Message) -> Message:
        """Tell what would be, had some facts not been told."""
        doubted, untold = (symbols_from_text(command[key]) for key in ("doubted", "untold"))
        update = parse_update(command["update"])
        return verdict_to_message(
            self._planner.inquire(update, doubted, untold, self._commands.interrupted, self._commands.dropped)
        )

    def _explain(self, command: Message) -> Message:
        """Tell why there is no plan, of a program of its own; what else the machine has to do comes first."""
        os.nice(EXPLAINING)
        stream = stream_from_message(command["stream"])
        try:
            found = explain(program_from_message(command["program"]), stream, self._commands.interrupted)
        except UndecidedError:
            return {"late": True}
        return {"why": None if found is None else found.to_message()}


def end_with(lifeline: int) -> None:
    """End this process when the other end of the pipe ``lifeline`` is closed."""
    signal.signal(signal.SIGIO, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGIO])
    fcntl.fcntl(lifeline, fcntl.F_SETOWN, os.getpid())
    fcntl.fcntl(lifeline, fcntl.F_SETFL, fcntl.fcntl(lifeline, fcntl.F_GETFL) | os.O_ASYNC)
    if select.select([lifeline], [], [], 0)[0]:
        raise SystemExit(0)  # it was closed before the kernel was asked to tell


def main() -> None:
    """Serve the parent."""
    end_with(int(sys.argv[1]))
    with os.fdopen(os.dup(1), "wb", buffering=0) as replies:
        os.dup2(2, 1)  # what a script in a program prints must not get among the replies

        def answer(message: Message) -> None:
            """Write a whole message to the parent: one write may take only a part of it."""
            data = memoryview(encode(message))
            while data:
                data = data[replies.write(data) :]

        WorkerMain(Commands(0)).run(answer)


if __name__ == "__main__":
    main()
