"""The main program of a worker process.

:mod:`~rosoclingo.planning.workers.process` starts it. The standard input only serves as a lifeline: when the parent
ends, it is closed, and the kernel ends this process by SIGIO, even while it is grounding.
"""

import fcntl
import json
import os
import select
import signal
import socket
import time
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Callable, Dict, List, Optional, Union

from rosoclingo.oclingo.errors import DroppedError, SolverError
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.parser import parse_update
from rosoclingo.oclingo.solving.reactive_solver import ReactiveSolver
from rosoclingo.oclingo.solving.results import SolveResult
from rosoclingo.planning.history import History, entry_from_message, entry_to_message
from rosoclingo.planning.text import Message, symbols_from_text, symbols_to_text
from rosoclingo.planning.workers.channel import CONNECTION, Channel
from rosoclingo.planning.workers.logged_solver import LoggedSolver
from rosoclingo.planning.workers.wire import program_from_message, result_to_message

if TYPE_CHECKING:
    from rosoclingo.planning.solver import PlanSolver

NICENESS = 10
"""Niceness of an explaining process."""

REPORTING = 0.5
"""Seconds of wall time between two progress reports of a search."""


def new_solver(program: ReactiveProgram, options: Message) -> "Union[PlanSolver, LoggedSolver]":
    """Return a solver with the ``options`` of :class:`WorkerPool`."""
    if options.pop("shortest", False):
        from rosoclingo.planning.solver import PlanSolver  # noqa: PLC0415 half of all modules

        return PlanSolver(program, **options)
    options.pop("plan_time", None)
    return LoggedSolver(lambda: ReactiveSolver(program, **options))


class WorkerMain:
    """Executes commands one after the other and replies to each.

    Its only state is caches: the history of the last command, and the solver's groundings.
    """

    def __init__(self, channel: Channel, program: Optional[ReactiveProgram] = None) -> None:
        """Use ``program``, or the one that the command ``load`` brings."""
        self._channel = channel
        self._given = program
        self._reported = time.monotonic()
        self._handlers: Dict[str, Callable[[Message], Message]] = {
            "load": self._load,
            "update": self._update,
            "improve": self._improve,
            "shorten": self._shorten,
            "inquire": self._inquire,
            "explain": self._explain,
        }

    def run(self) -> None:
        """Execute commands until the parent closes the connection, which raises EOFError."""
        while True:
            self._channel.wait()
            command = self._channel.unread.popleft()
            if command["do"] in self._handlers:  # late interrupts are ignored
                self._channel.send(self._reply_to(command))

    def _reply_to(self, command: Message) -> Message:
        self._reported = time.monotonic()
        if "history" in command:
            before = self._solver.log if command["continues"] else History()
            entries = map(entry_from_message, map(json.loads, command["history"].splitlines()))
            self._solver.restore(before.with_entries(*entries))
        try:
            return self._handlers[command["do"]](command)
        except SolverError as error:
            return {"refused": str(error), "dropped": isinstance(error, DroppedError)}

    # ---- Commands ----------------------------------------------------------------------------------------------------

    def _load(self, command: Message) -> Message:
        self._program = program = self._given or program_from_message(command["program"])
        self._solver = new_solver(program, dict(command["options"]))
        return {}

    def _update(self, command: Message) -> Message:
        """Accept an update and search; if the command says so, then shorten the plan until interrupted."""
        solver, start, text = self._solver, self._solver.log, command["update"]
        if text is None:
            result = solver.solve(self._is_interrupted, self._is_dropped)
        else:
            result = solver.update(parse_update(text), self._is_interrupted, self._is_dropped)
        reply = self._answer(result, start)
        with suppress(SolverError):  # the first plan remains valid
            while command["improves"] and result.answers and not self._is_interrupted():
                self._channel.send({**reply, "more": True})
                better = self._planner.improve(self._is_interrupted)
                if better is None:
                    break
                reply = self._answer(replace(better, warnings=result.warnings, statistics=result.statistics), start)
        return reply

    def _improve(self, _command: Message) -> Message:
        """Shorten the plan."""
        start = self._planner.log
        result = self._planner.improve(self._is_interrupted)
        return {} if result is None else self._answer(result, start)

    def _shorten(self, _command: Message) -> Message:
        """Append a checkpoint to the history."""
        start = self._planner.log
        self._planner.checkpoint()
        return self._entries_since(start)

    def _inquire(self, command: Message) -> Message:
        """Decide whether there is an answer without some facts."""
        assumable, disabled = (symbols_from_text(command[key]) for key in ("assumable", "disabled"))
        update = parse_update(command["update"])
        verdict = self._planner.inquire(update, assumable, disabled, self._is_interrupted, self._is_dropped)
        return {"satisfiable": verdict.satisfiable, "core": symbols_to_text(sorted(verdict.core))}

    def _explain(self, command: Message) -> Message:
        """Explain why there is no plan."""
        from rosoclingo.planning.explaining.explainer import explain  # noqa: PLC0415 rarely needed
        from rosoclingo.planning.explaining.questions import stream_from_message  # noqa: PLC0415
        from rosoclingo.planning.minimal_sets import UndecidedError  # noqa: PLC0415

        os.nice(NICENESS)
        try:
            found = explain(self._program, stream_from_message(command["stream"]), self._is_interrupted)
        except UndecidedError:
            raise DroppedError("stopped before anything was found") from None
        return {"why": None} if found is None else {"why": found.to_message(), "text": found.text()}

    @property
    def _planner(self) -> "PlanSolver":
        assert not isinstance(self._solver, LoggedSolver)
        return self._solver

    # ---- The parent --------------------------------------------------------------------------------------------------

    def _answer(self, result: SolveResult, start: History) -> Message:
        """Return the reply with a ``result`` and the entries that follow ``start``."""
        remarks: List[str] = []  # all of them, as earlier replies may be unread
        if not isinstance(self._solver, LoggedSolver):
            answers = tuple(map(self._solver.recent, result.answers))
            warnings = tuple(one for one in result.warnings if one not in self._solver.remarks)
            remarks, result = sorted(self._solver.remarks), replace(result, answers=answers, warnings=warnings)
        return {"result": result_to_message(result), "remarks": remarks, **self._entries_since(start)}

    def _entries_since(self, start: History) -> Message:
        """Return the part of a reply with the entries that follow ``start``."""
        return {"entries": [*map(entry_to_message, self._solver.log.entries_after(start) or ())]}

    def _is_interrupted(self) -> bool:
        """Return whether to stop the running search; reports its progress at times."""
        if time.monotonic() - self._reported >= REPORTING:
            self._reported = time.monotonic()
            self._channel.send({"reached": self._solver.reached})
        return bool(self._interrupts())

    def _is_dropped(self) -> bool:
        """Return whether to drop the running command."""
        return any(time.monotonic() >= one["drop_at"] for one in self._interrupts())

    def _interrupts(self) -> List[Message]:
        """Return the messages that interrupt the running command."""
        self._channel.wait(0.0)
        return [message for message in self._channel.unread if message["do"] == "interrupt"]


def end_with_parent(lifeline: int) -> None:
    """End this process when the other end of the pipe ``lifeline`` closes."""
    signal.signal(signal.SIGIO, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGIO])
    fcntl.fcntl(lifeline, fcntl.F_SETOWN, os.getpid())
    fcntl.fcntl(lifeline, fcntl.F_SETFL, fcntl.fcntl(lifeline, fcntl.F_GETFL) | os.O_ASYNC)
    if select.select([lifeline], [], [], 0)[0]:
        raise SystemExit(0)  # it was closed before F_SETOWN


def work(connection: socket.socket, program: Optional[ReactiveProgram] = None) -> None:
    """Execute the commands of the parent, which come by ``connection``."""
    end_with_parent(0)
    os.dup2(2, 1)  # scripts in a program can print; standard output belongs to the parent
    with suppress(EOFError):
        WorkerMain(Channel(connection), program).run()


if __name__ == "__main__":
    work(socket.socket(fileno=CONNECTION))
