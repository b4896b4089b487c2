"""The process of a worker: a solver that does the commands of its parent.

Started as ``python3 -m rosoclingo.planning.workers.worker_main SOCKET``, where SOCKET is the number of a file
descriptor. Nobody writes to its standard input: when the parent ends, however it ends, the other end is closed, and the
kernel ends this process by SIGIO, even while it grounds.
"""

import fcntl
import json
import os
import select
import signal
import socket
import sys
import time
from contextlib import suppress
from dataclasses import replace
from typing import Callable, Dict, List, Union

from rosoclingo.oclingo.errors import DroppedError, ProgramError, SolverError
from rosoclingo.oclingo.progression.parser import parse_update
from rosoclingo.oclingo.solving.reactive_solver import ReactiveSolver
from rosoclingo.oclingo.solving.results import SolveResult
from rosoclingo.planning.explaining.explainer import explain
from rosoclingo.planning.history import History, entry_from_message, entry_to_message
from rosoclingo.planning.minimal_sets import UndecidedError
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.planning.text import Message, symbols_from_text, symbols_to_text
from rosoclingo.planning.workers.channel import Channel
from rosoclingo.planning.workers.logged_solver import LoggedSolver
from rosoclingo.planning.workers.wire import (
    program_from_message,
    recent,
    result_to_message,
    stream_from_message,
)

NICENESS = 10
"""The niceness of a process that explains: other work of the machine comes first."""

REPORTING = 0.5
"""Seconds of wall time between two reports on how far a search is."""

CACHED = 100
"""Histories that are kept with their snapshots."""


class WorkerMain:
    """Does commands, one after the other, and replies to each.

    It keeps only caches: histories with their snapshots, and the solver's groundings.
    """

    def __init__(self, channel: Channel) -> None:
        self._channel = channel
        self._histories: Dict[str, History] = {}  # by their texts, as the solver's groundings belong to these objects
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
        """Serve until the parent closes its end, which raises EOFError."""
        while True:
            self._channel.wait()
            command = self._channel.unread.popleft()
            if command["do"] in self._handlers:  # an interrupt that came late is ignored
                self._channel.send(self._reply_to(command))

    def _reply_to(self, command: Message) -> Message:
        self._reported = time.monotonic()
        if "history" in command:
            self._solver.restore(self._history(command["history"], command["continues"]))
            self._cache(self._solver.log)
        try:
            return self._handlers[command["do"]](command)
        except SolverError as error:
            return {"refused": str(error), "dropped": isinstance(error, DroppedError)}

    # ---- Commands ----------------------------------------------------------------------------------------------------

    def _load(self, command: Message) -> Message:
        try:
            self._program = program = program_from_message(command["program"])
        except ProgramError as error:
            return {"faults": [vars(one) for one in error.faults]}
        options = dict(command["options"])
        self._histories.clear()
        self._solver: Union[PlanSolver, LoggedSolver]
        if options.pop("shortest", False):
            self._solver = PlanSolver(program, **options)
        else:
            options.pop("plan_time", None)
            self._solver = LoggedSolver(lambda: ReactiveSolver(program, **options))
        return {}

    def _update(self, command: Message) -> Message:
        """Accept an update, and search; then shorten the plan, if that is asked for, until interrupted."""
        solver, start, text = self._solver, self._solver.log, command["update"]
        if text is None:
            result = solver.solve(self._is_interrupted, self._is_dropped)
        else:
            result = solver.update(parse_update(text), self._is_interrupted, self._is_dropped)
        reply = self._answer(result, start)
        with suppress(SolverError):  # the plan that there is remains one
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
        """Put a checkpoint at the end of the history."""
        start = self._planner.log
        self._planner.checkpoint()
        return self._entries_since(start)

    def _inquire(self, command: Message) -> Message:
        """Find out what would be, had some facts not been asserted."""
        assumable, disabled = (symbols_from_text(command[key]) for key in ("assumable", "disabled"))
        update = parse_update(command["update"])
        verdict = self._planner.inquire(update, assumable, disabled, self._is_interrupted, self._is_dropped)
        return {"satisfiable": verdict.satisfiable, "core": symbols_to_text(sorted(verdict.core))}

    def _explain(self, command: Message) -> Message:
        """Find out why there is no plan."""
        os.nice(NICENESS)
        try:
            found = explain(self._program, stream_from_message(command["stream"]), self._is_interrupted)
        except UndecidedError:
            raise DroppedError("stopped before anything was found out") from None
        return {"why": None if found is None else found.to_message()}

    @property
    def _planner(self) -> PlanSolver:
        assert isinstance(self._solver, PlanSolver)
        return self._solver

    # ---- Histories ---------------------------------------------------------------------------------------------------

    def _history(self, text: str, continues: bool) -> History:
        """Return the history of a text: it continues the last one, or else is made from the longest in the cache."""
        lines, rest = text.splitlines(keepends=True), []
        if continues:
            return self._solver.log.with_entries(*(entry_from_message(json.loads(line)) for line in lines))
        while lines and "".join(lines) not in self._histories:
            rest.append(lines.pop())
        log = self._histories.get("".join(lines)) or History()
        return log.with_entries(*(entry_from_message(json.loads(line)) for line in reversed(rest)))

    def _cache(self, log: History) -> None:
        """Cache a history, and drop the one that was used least recently; those without checkpoints are too long."""
        if not isinstance(self._solver, PlanSolver):
            return
        text = log.text()
        self._histories.pop(text, None)
        self._histories[text] = log
        if len(self._histories) > CACHED:
            del self._histories[next(iter(self._histories))]

    # ---- The parent --------------------------------------------------------------------------------------------------

    def _answer(self, result: SolveResult, start: History) -> Message:
        """Return the reply with a ``result`` of the solver, which continued from ``start``."""
        remarks: List[str] = []  # all of them: earlier replies may not have been read
        if isinstance(self._solver, PlanSolver):
            answers = tuple(recent(one, result.step, self._program) for one in result.answers)
            warnings = tuple(one for one in result.warnings if one not in self._solver.remarks)
            remarks, result = sorted(self._solver.remarks), replace(result, answers=answers, warnings=warnings)
        return {"result": result_to_message(result), "remarks": remarks, **self._entries_since(start)}

    def _entries_since(self, start: History) -> Message:
        """Return the part of a reply with the entries that the solver has appended to ``start``."""
        self._cache(self._solver.log)
        return {"entries": [*map(entry_to_message, self._solver.log.entries_after(start) or ())]}

    def _is_interrupted(self) -> bool:
        """Return whether to end the search under way; report now and then how far it is."""
        if time.monotonic() - self._reported >= REPORTING:
            self._reported = time.monotonic()
            self._channel.send({"reached": self._solver.reached})
        return bool(self._interrupts())

    def _is_dropped(self) -> bool:
        """Return whether to drop the command under way."""
        return any(time.monotonic() >= one["drop_at"] for one in self._interrupts())

    def _interrupts(self) -> List[Message]:
        """Return the messages that interrupt the command under way."""
        self._channel.wait(0.0)
        return [message for message in self._channel.unread if message["do"] == "interrupt"]


def end_with_parent(lifeline: int) -> None:
    """End this process when the other end of the pipe ``lifeline`` is closed."""
    signal.signal(signal.SIGIO, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGIO])
    fcntl.fcntl(lifeline, fcntl.F_SETOWN, os.getpid())
    fcntl.fcntl(lifeline, fcntl.F_SETFL, fcntl.fcntl(lifeline, fcntl.F_GETFL) | os.O_ASYNC)
    if select.select([lifeline], [], [], 0)[0]:
        raise SystemExit(0)  # it was closed before the kernel was asked to signal that


def main() -> None:
    """Serve the parent."""
    end_with_parent(0)
    os.dup2(2, 1)  # scripts in a program may print; the standard output is the parent's
    with suppress(EOFError):
        WorkerMain(Channel(socket.socket(fileno=int(sys.argv[1])))).run()


if __name__ == "__main__":
    main()
