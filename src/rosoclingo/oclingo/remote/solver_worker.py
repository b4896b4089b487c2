"""The child of a ``SolverProcess``: a solver that does what its standard input says.

Started as ``python3 -m rosoclingo.oclingo.remote.solver_worker LIFELINE``, where LIFELINE is the
number of a file descriptor: the
reading end of a pipe that nobody writes to. When the parent goes, however it goes, its end is closed, and the kernel
ends this process by SIGIO, even in the midst of grounding.
"""

import fcntl
import hashlib
import os
import select
import signal
import sys
from typing import Callable, Dict, List, Sequence

from rosoclingo.oclingo.errors import DroppedError, ProgramError, SolverError
from rosoclingo.oclingo.progression.parser import parse_update
from rosoclingo.oclingo.remote.state_wire import state_from_message, state_to_message
from rosoclingo.oclingo.remote.wire import (
    Lines,
    Message,
    encode,
    faults_to_message,
    program_from_message,
    result_to_message,
    symbols_from_text,
)
from rosoclingo.oclingo.solving.solver import ReactiveSolver, SolveResult
from rosoclingo.oclingo.solving.stream_state import StreamState

_CHUNK = 1 << 20

STATES = 64
"""States that are kept, so that a solver beside another, or one that goes back, need not take a log again."""


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
                if command["do"] not in ("interrupt", "drop"):
                    return command
            self._read()

    def interrupted(self) -> bool:
        """Tell whether the search at work is to be ended."""
        return self._asked("interrupt")

    def dropped(self) -> bool:
        """Tell whether the command at work is to be dropped."""
        return self._asked("drop")

    def _asked(self, what: str) -> bool:
        while select.select([self._descriptor], [], [], 0)[0]:
            self._read()
        return any(command["do"] == what for command in self._queue)

    def _read(self) -> None:
        data = os.read(self._descriptor, _CHUNK)
        if not data:
            raise SystemExit(0)
        self._queue.extend(self._lines.feed(data))


class States:
    """The latest states of all solvers, by the log that leads to them."""

    def __init__(self) -> None:
        self._found: Dict[bytes, StreamState] = {}

    def keep(self, key: bytes, state: StreamState) -> None:
        """``state`` is that after the log of ``key``."""
        self._found.pop(key, None)
        self._found[key] = state
        if len(self._found) > STATES:
            del self._found[next(iter(self._found))]

    def after(self, keys: Sequence[bytes]) -> int:
        """Return how many of the entries whose ``keys`` these are lead to a state that is known."""
        return next((number for number in range(len(keys), 0, -1) if keys[number - 1] in self._found), 0)

    def __getitem__(self, key: bytes) -> StreamState:
        """Return the state after the log of ``key``."""
        return self._found[key]


def keys_of(entries: Sequence[Message], before: bytes = b"") -> List[bytes]:
    """Return, for each entry of a log, what stands for the log up to it, which continues that of ``before``."""
    keys: List[bytes] = []
    for entry in entries:
        before = hashlib.sha256(before + encode(dict(sorted(entry.items())))).digest()
        keys.append(before)
    return keys


class Worker:
    """Does commands, one after the other, and answers each."""

    def __init__(self, commands: Commands) -> None:
        self._commands = commands
        self._make: Callable[[], ReactiveSolver]
        self._solvers: Dict[int, ReactiveSolver] = {}
        self._keys: Dict[int, bytes] = {}
        self._states = States()
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
                self._keys.pop(number, None)
            try:
                reply = self._handlers[command["do"]](command)
            except SolverError as error:
                reply = {"refused": str(error), "dropped": isinstance(error, DroppedError)}
            answer(reply)

    def _load(self, command: Message) -> Message:
        try:
            program = program_from_message(command["program"])
        except ProgramError as error:
            return faults_to_message(error.faults)
        self._make = lambda: ReactiveSolver(program, **command["options"])
        return {}

    def _rebuild(self, command: Message) -> Message:
        """Make a solver in the state after the whole log, as far as that is known; it takes the rest."""
        number, keys = command["solver"], keys_of(command["log"])
        known = self._states.after(keys)
        self._solvers[number], self._keys[number] = self._make(), b""
        if known:
            self._solvers[number].restore(self._states[keys[known - 1]])
            self._keys[number] = keys[known - 1]
        self._solver_of(dict(command, log=command["log"][known:]))
        return {}

    def _solve(self, command: Message) -> Message:
        solver = self._solver_of(command)
        return self._reply(command, solver.solve(self._commands.interrupted, self._commands.dropped))

    def _update(self, command: Message) -> Message:
        solver, update = self._solver_of(command), parse_update(command["update"])
        return self._reply(command, solver.update(update, self._commands.interrupted, self._commands.dropped))

    def _reply(self, command: Message, result: SolveResult) -> Message:
        """Return ``result``, with the state from which a log can go on instead of from the start if that is wanted."""
        number, reply = command["solver"], result_to_message(result)
        if command["checkpoint"]:
            reply = dict(reply, state=state_to_message(self._solvers[number].snapshot()))
            self._keys[number] = b""
            self._took(number, {"do": "restore", "state": reply["state"]})
        else:
            taken: Message = {key: command[key] for key in ("do", "update") if key in command}
            self._took(number, dict(taken, horizon=result.horizon))
        return reply

    def _took(self, number: int, entry: Message) -> None:
        """Note that a solver has taken an entry of its log."""
        (self._keys[number],) = keys_of([entry], self._keys[number])
        self._states.keep(self._keys[number], self._solvers[number].snapshot())

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
            elif entry["do"] == "less":
                solver.restore(solver.snapshot().less(symbols_from_text(entry["facts"])))
            else:
                text = entry.get("update")
                solver.replay(None if text is None else parse_update(text), entry["horizon"])
            self._took(command["solver"], entry)
        return solver


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
