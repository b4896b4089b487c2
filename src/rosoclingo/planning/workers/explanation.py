"""Explanations of infeasibility, computed in a separate process."""

from typing import NamedTuple, Optional

from rosoclingo.oclingo.errors import DroppedError, SolverError
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.planning.explaining.questions import Stream
from rosoclingo.planning.question import Stop, never
from rosoclingo.planning.text import Message
from rosoclingo.planning.workers.pool import WorkerPool
from rosoclingo.planning.workers.worker import WorkerRequest

PATIENCE = 5.0
"""Seconds of wall time from a stop until the worker is killed; it needs some to assemble its results."""


class Explanation(NamedTuple):
    """Why there is no plan, in words and as a value for JSON, see :class:`WhyNot`."""

    text: str
    message: Message


def explain_in_worker(
    program: ReactiveProgram, stream: Stream, seconds: float, stopped: Stop = never
) -> Optional[Explanation]:
    """Explain in a separate process why there is no plan; return None if there is one.

    The process searches for at most ``seconds`` of processor time. Raises DroppedError if it finds nothing in this
    time or before a stop, and SolverError if it cannot be started, crashes or refuses the stream.
    """
    with WorkerPool(program, patience=PATIENCE, shortest=True) as pool:
        elapsed = pool.stopwatch()

        def is_over() -> bool:
            """Return whether to stop."""
            return stopped() or elapsed() >= seconds

        try:
            reply = pool.ask(WorkerRequest("explain", (stream.update, stream.steps), stream.log), is_over)
        except DroppedError as error:
            if is_over():
                raise DroppedError(f"no explanation was found in {seconds:g} s") from None
            raise SolverError(f"the explaining process was lost: {error}") from None
    return Explanation(*reply.value) if reply.value else None
