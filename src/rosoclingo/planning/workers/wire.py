"""The messages between a ``WorkerPool`` and its workers: JSON, one a line.

Symbols travel as text, see :mod:`~rosoclingo.planning.text`.
"""

import json
from pathlib import Path
from typing import FrozenSet, Iterable, List

import clingo

from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.sources import Source
from rosoclingo.oclingo.progression.parser import parse_update
from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.oclingo.solving.results import SolveOutcome, SolveResult
from rosoclingo.planning.compaction import SHOWN_STEPS
from rosoclingo.planning.explaining.questions import Stream
from rosoclingo.planning.history import History, entry_from_message, entry_to_message
from rosoclingo.planning.strategies.probe import Verdict
from rosoclingo.planning.text import Message, symbols_from_text, symbols_to_text

_FUNCTION = clingo.SymbolType.Function


def encode(message: Message) -> bytes:
    """Return ``message`` as one line."""
    return json.dumps(message, separators=(",", ":")).encode("ascii") + b"\n"


class Lines:
    """Assembles lines from pieces."""

    def __init__(self) -> None:
        self._pieces: List[bytes] = []

    def feed(self, data: bytes) -> List[Message]:
        """Take ``data`` and return the messages that are complete by now."""
        *complete, rest = data.split(b"\n")
        if complete:
            complete[0] = b"".join([*self._pieces, complete[0]])
            self._pieces.clear()
        if rest:
            self._pieces.append(rest)
        return [json.loads(line) for line in complete]


def program_to_message(program: ReactiveProgram) -> Message:
    """Return the texts and constants of ``program``."""
    sources = [[one.name, one.text, None if one.folder is None else str(one.folder)] for one in program.sources]
    return {"sources": sources, "constants": {name: str(value) for name, value in program.constants.items()}}


def program_from_message(message: Message) -> ReactiveProgram:
    """Return the program of :func:`program_to_message`; raises ProgramError as that program did."""
    sources = [Source(name, text, folder and Path(folder)) for name, text, folder in message["sources"]]
    return ReactiveProgram(sources, message["constants"])


def result_to_message(result: SolveResult, program: ReactiveProgram, plans: bool = True) -> Message:
    """Return the ``result`` of a solver of ``program`` for :func:`result_from_message`.

    If answers are ``plans`` they lack the shown atoms of cycles that ended more than :data:`SHOWN_STEPS` cycles ago,
    which compaction removes later anyway. Otherwise each answer of a long run would have all its shown atoms.
    """
    first = result.step - SHOWN_STEPS

    def is_recent(atom: clingo.Symbol) -> bool:
        """Tell whether an atom has no cycle, or a recent one."""
        position = program.time_position(atom.name, len(atom.arguments)) if atom.type is _FUNCTION else None
        cycle = None if position is None else atom.arguments[position]
        return cycle is None or cycle.type is not clingo.SymbolType.Number or cycle.number >= first

    answers = [filter(is_recent, one) for one in result.answers] if plans else result.answers
    return {
        "outcome": result.outcome.value,
        "answers": [symbols_to_text(answer) for answer in answers],
        "horizon": result.horizon,
        "step": result.step,
        "warnings": result.warnings,
        "permanent": result.permanent,
        "shortest": result.shortest,
        "statistics": result.statistics,
        "foreseen": symbols_to_text(result.foreseen),
    }


def result_from_message(message: Message) -> SolveResult:
    """Return the result that :func:`result_to_message` took."""
    return SolveResult(
        outcome=SolveOutcome(message["outcome"]),
        answers=tuple(symbols_from_text(text) for text in message["answers"]),
        horizon=message["horizon"],
        step=message["step"],
        warnings=tuple(message["warnings"]),
        permanent=message["permanent"],
        shortest=message["shortest"],
        statistics=message["statistics"],
        foreseen=symbols_from_text(message["foreseen"]),
    )


def question_to_message(
    update: StreamUpdate, doubted: FrozenSet[clingo.Symbol], untold: FrozenSet[clingo.Symbol]
) -> Message:
    """Return the command to ask :meth:`~rosoclingo.planning.solver.PlanSolver.inquire` this."""
    facts = {"doubted": symbols_to_text(sorted(doubted)), "untold": symbols_to_text(sorted(untold))}
    return {"do": "inquire", "update": str(update), **facts}


def verdict_to_message(verdict: Verdict) -> Message:
    """Return ``verdict`` for :func:`verdict_from_message`."""
    return {"satisfiable": verdict.satisfiable, "core": symbols_to_text(sorted(verdict.core))}


def verdict_from_message(message: Message) -> Verdict:
    """Return the verdict that :func:`verdict_to_message` took."""
    return Verdict(message["satisfiable"], symbols_from_text(message["core"]))


def stream_to_message(stream: Stream) -> Message:
    """Return ``stream`` for :func:`stream_from_message`."""
    log = [entry_to_message(entry) for entry in stream.log.entries]
    strings = stream.oclingo_strings
    return {"log": log, "update": str(stream.update), "steps": stream.steps, "oclingo_strings": strings}


def stream_from_message(message: Message) -> Stream:
    """Return the stream that :func:`stream_to_message` took."""
    log = History().then(*map(entry_from_message, message["log"]))
    return Stream(log, parse_update(message["update"]), message["steps"], message["oclingo_strings"])


def faults_to_message(faults: Iterable[Fault]) -> Message:
    """Return ``faults`` for :func:`faults_from_message`."""
    return {"faults": [[one.file, one.line, one.column, one.message, one.mend] for one in faults]}


def faults_from_message(message: Message) -> List[Fault]:
    """Return the faults that :func:`faults_to_message` took."""
    return [Fault(*one) for one in message["faults"]]
