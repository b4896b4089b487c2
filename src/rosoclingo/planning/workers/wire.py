"""Programs, results and streams as JSON values, for messages between a worker and its parent.

Symbols are sent as text, see :mod:`~rosoclingo.planning.text`.
"""

from pathlib import Path

import clingo

from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.sources import Source
from rosoclingo.oclingo.progression.parser import parse_update
from rosoclingo.oclingo.solving.results import Answer, SolveOutcome, SolveResult
from rosoclingo.planning.compaction import SHOWN_STEPS
from rosoclingo.planning.explaining.questions import Stream
from rosoclingo.planning.history import History, entry_from_message, entry_to_message
from rosoclingo.planning.text import Message, symbols_from_text, symbols_to_text


def program_to_message(program: ReactiveProgram) -> Message:
    """Return ``program`` for :func:`program_from_message`."""
    sources = [[one.name, one.text, None if one.folder is None else str(one.folder)] for one in program.sources]
    return {"sources": sources, "constants": {name: str(value) for name, value in program.constants.items()}}


def program_from_message(message: Message) -> ReactiveProgram:
    """Return the program of :func:`program_to_message`; raises ProgramError."""
    sources = [Source(name, text, folder and Path(folder)) for name, text, folder in message["sources"]]
    return ReactiveProgram(sources, message["constants"])


def result_to_message(result: SolveResult) -> Message:
    """Return ``result`` for :func:`result_from_message`."""
    texts = {"answers": [*map(symbols_to_text, result.answers)], "predicted": symbols_to_text(result.predicted)}
    return {**vars(result), "outcome": result.outcome.value, **texts}


def result_from_message(message: Message) -> SolveResult:
    """Return the result of :func:`result_to_message`."""
    values = {
        "outcome": SolveOutcome(message["outcome"]),
        "answers": tuple(map(symbols_from_text, message["answers"])),
        "predicted": symbols_from_text(message["predicted"]),
        "warnings": tuple(message["warnings"]),
    }
    return SolveResult(**{**message, **values})


def recent(answer: Answer, step: int, program: ReactiveProgram) -> Answer:
    """Return ``answer`` without atoms of cycles that lie more than :data:`SHOWN_STEPS` before ``step``.

    Otherwise the answers of a long run would grow until the next compaction.
    """

    def is_recent(atom: clingo.Symbol) -> bool:
        """Return whether an atom has a recent cycle or none."""
        function = atom.type is clingo.SymbolType.Function
        position = program.time_position(atom.name, len(atom.arguments)) if function else None
        if position is None or atom.arguments[position].type is not clingo.SymbolType.Number:
            return True
        return atom.arguments[position].number >= step - SHOWN_STEPS

    return frozenset(filter(is_recent, answer))


def stream_to_message(stream: Stream) -> Message:
    """Return ``stream`` for :func:`stream_from_message`."""
    return {**stream._asdict(), "log": [*map(entry_to_message, stream.log.entries)], "update": str(stream.update)}


def stream_from_message(message: Message) -> Stream:
    """Return the stream of :func:`stream_to_message`."""
    log = History().with_entries(*map(entry_from_message, message["log"]))
    return Stream(**{**message, "log": log, "update": parse_update(message["update"])})
