"""Programs and results as JSON values, for messages between a worker and its parent.

Symbols are sent as text, see :mod:`~rosoclingo.planning.text`.
"""

from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.sources import Source
from rosoclingo.oclingo.solving.results import SolveOutcome, SolveResult
from rosoclingo.planning.text import Message, symbols_from_text, symbols_to_text


def program_to_message(program: ReactiveProgram) -> Message:
    """Return ``program`` for :func:`program_from_message`."""
    sources = [[one.name, one.text] for one in program.texts]
    return {"sources": sources, "constants": {name: str(value) for name, value in program.constants.items()}}


def program_from_message(message: Message) -> ReactiveProgram:
    """Return the program of :func:`program_to_message`; no file is read."""
    sources = [Source(name, text) for name, text in message["sources"]]
    return ReactiveProgram(sources, message["constants"], whole=True)


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
