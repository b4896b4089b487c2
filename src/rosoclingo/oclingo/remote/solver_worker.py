"""The child of a ``SolverProcess``: a solver that does what its standard input says.

Started as ``python3 -m rosoclingo.oclingo.remote.solver_worker LIFELINE``, where LIFELINE is the
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
from typing import Callable, Dict, List, Optional, Sequence

from rosoclingo.oclingo.errors import DroppedError, ProgramError, SolverError
from rosoclingo.oclingo.explaining.explainer import explain
from rosoclingo.oclingo.explaining.minimal_sets import OutOfTimeError
from rosoclingo.oclingo.progression.parser import parse_update
from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.oclingo.remote.child import REACHED
from rosoclingo.oclingo.remote.wire import (
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
from rosoclingo.oclingo.solving.solver import ReactiveSolver
from rosoclingo.oclingo.solving.state_text import symbols_from_text
from rosoclingo.oclingo.solving.stream_log import Checkpoint, StreamLog, entry_from_message, key_after

_CHUNK = 1 << 20

EXPLAINING = 10
"""By so much a process that explains gives way to others (nice)."""

TELLING = 0.5
"""Seconds of wall time between two words on how far a search is."""

KNOWN_LOGS = 64
"""Logs that are kept with their states, so that a solver beside another, or one that goes back, need not read again."""


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


class KnownLogs:
    """The latest logs of all solvers, by what stands for their entries."""

    def __init__(self) -> None:
        self._logs: Dict[bytes, StreamLog] = {}

    def keep(self, log: StreamLog) -> StreamLog:
        """Keep ``log`` and return it."""
        self._logs.pop(log.key, None)
        self._logs[log.key] = log
        if len(self._logs) > KNOWN_LOGS:
            del self._logs[next(iter(self._logs))]
        return log

    def longer(self, log: StreamLog, entries: Sequence[Message]) -> StreamLog:
        """Return ``log`` with more entries: the one that is known, where there is one."""
        keys = [log.key]
        for message in entries:
            keys.append(key_after(keys[-1], message))
        known = next((number for number in range(len(entries), 0, -1) if keys[number] in self._logs), 0)
        log = self.keep(self._logs[keys[known]]) if known else log
        for message in entries[known:]:
            log = self.keep(log.then(entry_from_message(message)))
        return log


class Worker:
    """Does commands, one after the other, and answers each."""

    def __init__(self, commands: Commands) -> None:
        self._commands = commands
        self._make: Callable[[], ReactiveSolver]
        self._solvers: Dict[int, ReactiveSolver] = {}
        self._known = KnownLogs()
        self._tell: Callable[[Message], None] = lambda message: None
        self._handlers: Dict[str, Callable[[Message], Message]] = {
            "load": self._load,
            "rebuild": self._rebuild,
            "update": self._update,
            "follow": self._follow,
            "prepare": self._prepare,
            "improve": self._improve,
            "shorten": self._shorten_log,
            "inquire": self._inquire,
            "explain": self._explain,
        }

    def run(self, answer: Callable[[Message], None]) -> None:
        """Serve until the parent closes its end."""
        self._tell = answer
        while True:
            command = self._commands.next()
            for number in command.get("left", ()):
                self._solvers.pop(number, None)
            try:
                reply = self._handlers[command["do"]](command)
            except SolverError as error:
                reply = {"refused": str(error), "dropped": isinstance(error, DroppedError)}
            answer(reply)
            if command.get("improves"):
                answer(self._shortened(command["solver"], reply))

    def _load(self, command: Message) -> Message:
        try:
            program = program_from_message(command["program"])
        except ProgramError as error:
            return faults_to_message(error.faults)
        self._make = lambda: ReactiveSolver(program, **command["options"])
        self._solvers, self._known = {}, KnownLogs()  # those were of another program
        return {}

    def _rebuild(self, command: Message) -> Message:
        """Make a solver that reads a whole log, as far as its state is not known."""
        solver = self._solvers[command["solver"]] = self._make()
        log = self._known.longer(StreamLog(), command["log"])
        log.plan = log.plan or plan_from_message(command.get("plan", {}))
        solver.restore(log)
        solver.read(_update_of(command["coming"]))
        return {}

    def _update(self, command: Message) -> Message:
        """Have a solver read what is new in its log, take an update, and search, with a plan to begin with if told."""
        solver, update = self._solvers[command["solver"]], _update_of(command["update"])
        solver.restore(self._known.longer(solver.log, command["log"]))
        if "plan" in command:
            solver.log.plan = plan_from_message(command["plan"])
        stopped = self._telling(solver)
        if update is None:
            result = solver.solve(stopped, self._commands.dropped)
        else:
            result = solver.update(update, stopped, self._commands.dropped)
        log = solver.log
        checkpoint = log.entry.message if isinstance(log.entry, Checkpoint) else None
        last = log.last
        for one in (last and last.before, last, log):  # some go back to before the update
            if one is not None:
                self._known.keep(one)
        return {**result_to_message(result, solver), "grounded": solver.horizon, "checkpoint": checkpoint}

    def _telling(self, solver: ReactiveSolver) -> Callable[[], bool]:
        """Return what tells whether a search is to be ended; now and then it tells the parent how far that is."""
        told = time.monotonic()

        def interrupted() -> bool:
            """Look."""
            nonlocal told
            if time.monotonic() - told >= TELLING:
                told = time.monotonic()
                self._tell({REACHED: solver.reached})
            return self._commands.interrupted()

        return interrupted

    def _follow(self, command: Message) -> Message:
        """Have a solver read what was foreseen, and so is answered; it may be told the plan that goes on."""
        solver = self._solvers[command["solver"]]
        log = solver.log
        for entry in command["log"]:
            log = self._known.longer(log, [entry])
            log.foreseen = True
        solver.restore(log)
        if "plan" in command:
            solver.log.plan = plan_from_message(command["plan"])
        solver.read()
        return {}

    def _shorten_log(self, command: Message) -> Message:
        """Have a solver read what was foreseen, and put a checkpoint at the end of its log."""
        self._follow(command)
        solver = self._solvers[command["solver"]]
        solver.begin_log_anew()
        entry = self._known.keep(solver.log).entry
        assert isinstance(entry, Checkpoint)
        return {"checkpoint": entry.message}

    def _prepare(self, command: Message) -> Message:
        """Answer an update that may come, unless something else does before long; forget all but that."""
        self._solvers, self._known = {}, KnownLogs()
        if not self._commands.are_none(command["pause"]):
            return {"left": True}
        self._rebuild(command)
        return self._update({**command, "log": []})

    def _shortened(self, number: int, reply: Message) -> Message:
        """Shorten the plan in a ``reply`` until something comes; an empty message where it gets no shorter."""
        shorter: Message = {}
        with suppress(SolverError):  # the plan that there is remains one
            while "outcome" in reply and not self._commands.have_come():
                result = self._solvers[number].improve(self._commands.have_come, retires=False)
                if result is None:
                    break
                shorter = result_to_message(result, self._solvers[number])
        return shorter

    def _improve(self, command: Message) -> Message:
        """Have a solver read what is new in its log, and shorten the plan."""
        solver = self._solvers[command["solver"]]
        solver.restore(self._known.longer(solver.log, command["log"]))
        solver.log.plan = plan_from_message(command["plan"])
        result = solver.improve(self._commands.interrupted)
        return {} if result is None else result_to_message(result, solver)

    def _inquire(self, command: Message) -> Message:
        """Have a solver read what is new in its log, and tell what would be, had some facts not been told."""
        solver = self._solvers[command["solver"]]
        solver.restore(self._known.longer(solver.log, command["log"]))
        doubted, untold = (symbols_from_text(command[key]) for key in ("doubted", "untold"))
        update = parse_update(command["update"])
        return verdict_to_message(
            solver.inquire(update, doubted, untold, self._commands.interrupted, self._commands.dropped)
        )

    def _explain(self, command: Message) -> Message:
        """Tell why there is no plan, of a program of its own; what else the machine has to do comes first."""
        os.nice(EXPLAINING)
        stream = stream_from_message(command["stream"])
        try:
            found = explain(program_from_message(command["program"]), stream, self._commands.interrupted)
        except OutOfTimeError:
            return {"late": True}
        return {"why": None if found is None else found.to_message()}


def _update_of(text: Optional[str]) -> Optional[StreamUpdate]:
    return None if text is None else parse_update(text)


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
