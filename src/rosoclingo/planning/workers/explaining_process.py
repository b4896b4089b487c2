"""Why there is no plan, found out in a process of its own: nothing else waits for it, and it ends in time."""

from typing import Callable, Optional

from rosoclingo.oclingo.errors import DroppedError, SolverError
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.planning.explaining.questions import Stream
from rosoclingo.planning.explaining.why_not import WhyNot
from rosoclingo.planning.workers.pool import WorkerPool
from rosoclingo.planning.workers.wire import stream_to_message

GRACE, PATIENCE = 2.0, 5.0
"""As for :class:`~rosoclingo.planning.workers.pool.WorkerPool`; what is found by a stop is still put together."""


def explain_apart(
    program: ReactiveProgram, stream: Stream, seconds: float, stopped: Callable[[], bool] = lambda: False
) -> Optional[WhyNot]:
    """Return why there is no plan, as far as that is found out in ``seconds`` of processor time; None if there is one.

    Raises DroppedError if nothing was found by then, or before it was ``stopped``, and SolverError if the process could
    not be started, has crashed, or refuses the stream.
    """
    with WorkerPool(program, patience=PATIENCE, grace=GRACE, shortest=True) as pool:
        elapsed = pool.stopwatch()

        def is_late() -> bool:
            """Return whether to end it."""
            return stopped() or elapsed() >= seconds

        try:
            reply = pool.ask({"do": "explain", "stream": stream_to_message(stream)}, None, is_late)
        except DroppedError as error:
            if is_late():
                raise DroppedError(f"it was not found out in {seconds:g} s") from None
            raise SolverError(f"the process that explains was lost: {error}") from None
    return None if reply["why"] is None else WhyNot.from_message(reply["why"])
