"""The child of a :class:`~rosoclingo.oclingo.process.SolverProcess`: a solver that does what its standard input says.

Started as ``python3 -m rosoclingo.oclingo.worker LIFELINE``, where LIFELINE is the number of a file descriptor: the
reading end of a pipe that nobody writes to. When the parent goes, however it goes, its end is closed, and the kernel
ends this process by SIGIO, even in the midst of grounding.
"""

import fcntl
import os
import select
import signal
import sys
from typing import Callable, Dict, List

from rosoclingo.oclingo.errors import ProgramError, SolverError
from rosoclingo.oclingo.process_wire import (
    Lines,
    Message,
    encode,
    faults_to_message,
    program_from_message,
    result_to_message,
    symbols_from_text,
)
from rosoclingo.oclingo.progression_parser import parse_update
from rosoclingo.oclingo.solver import ReactiveSolver, SolveResult
from rosoclingo.oclingo.state_wire import state_from_message, state_to_message

_CHUNK = 1 << 20


class Commands:
    """The messages of the parent."""

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor
        self._lines = Lines()
        self._queue: List[Message] = []

    def next(self) -> Message:
        """Wait for the next command; SystemExit where the parent has gone. Late interrupts are dropped."""
        while True:
            while self._queue:
                command = self._queue.pop(0)
                if command["do"] != "interrupt":
                    return command
            self._read()

    def interrupted(self) -> bool:
        """Tell whether the command at work is to be ended."""
        while select.select([self._descriptor], [], [], 0)[0]:
            self._read()
        return any(command["do"] == "interrupt" for command in self._queue)

    def _read(self) -> None:
        data = os.read(self._descriptor, _CHUNK)
        if not data:
            raise SystemExit(0)
        self._queue.extend(self._lines.feed(data))


class Worker:
    """Does commands, one after the other, and answers each."""

    def __init__(self, commands: Commands) -> None:
        self._commands = commands
        self._make: Callable[[], ReactiveSolver]
        self._solvers: Dict[int, ReactiveSolver] = {}
        self._handlers: Dict[str, Callable[[Message], Message]] = {
            "load": self._load,
            "rebuild": self._rebuild,
            "solve": self._solve,
            "update": self._update,
        }

    def run(self, answer: Callable[[Message], None]) -> None:
        """Serve until the parent closes its end."""
        while True:
            command = self._commands.next()
            for number in command.get("left", ()):
                self._solvers.pop(number, None)
            try:
                reply = self._handlers[command["do"]](command)
            except SolverError as error:
                reply = {"refused": str(error)}
            answer(reply)

    def _load(self, command: Message) -> Message:
        try:
            program = program_from_message(command["program"])
        except ProgramError as error:
            return faults_to_message(error.faults)
        self._make = lambda: ReactiveSolver(program, **command["options"])
        return {}

    def _rebuild(self, command: Message) -> Message:
        """Make a solver that takes the whole log."""
        self._solvers[command["solver"]] = self._make()
        self._solver_of(command)
        return {}

    def _solve(self, command: Message) -> Message:
        solver = self._solver_of(command)
        return _reply(command, solver, solver.solve(self._commands.interrupted))

    def _update(self, command: Message) -> Message:
        solver, update = self._solver_of(command), parse_update(command["update"])
        return _reply(command, solver, solver.update(update, self._commands.interrupted))

    def _solver_of(self, command: Message) -> ReactiveSolver:
        """Return the solver of a command, which takes what is new in its log, without searching."""
        solver = self._solvers[command["solver"]]
        for entry in command["log"]:
            if entry["do"] == "close":
                solver.close_cycle(entry["cycle"], symbols_from_text(entry["executed"]))
            elif entry["do"] == "forget":
                solver.forget_before(entry["step"])
            elif entry["do"] == "restore":
                solver.restore(state_from_message(entry["state"]))
            else:
                text = entry.get("update")
                solver.replay(None if text is None else parse_update(text), entry["horizon"])
        return solver


def _reply(command: Message, solver: ReactiveSolver, result: SolveResult) -> Message:
    """Return ``result``, with the state from which a log can go on instead of from the start if that is wanted."""
    reply = result_to_message(result)
    return dict(reply, state=state_to_message(solver.snapshot())) if command["checkpoint"] else reply


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

        Worker(Commands(0)).run(answer)


if __name__ == "__main__":
    main()
