"""Why there is no plan, found out in a process of its own: nothing else waits for it, and it ends in time."""

import time
from typing import Callable, Optional

from rosoclingo.oclingo.errors import DroppedError, SolverError
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.planning.explaining.questions import Stream
from rosoclingo.planning.explaining.why_not import WhyNot
from rosoclingo.planning.workers.child import WorkerLostError, WorkerProcess
from rosoclingo.planning.workers.wire import program_to_message, stream_to_message

PATIENCE = (2.0, 5.0)
"""Seconds of wall time after which a process that is to stop is asked again, and ended: grounding can't be stopped."""

SLOWEST = 10
"""So many times the processor time that it may have a process may take."""


def explain_apart(
    program: ReactiveProgram, stream: Stream, seconds: float, stopped: Callable[[], bool] = lambda: False
) -> Optional[WhyNot]:
    """Return why there is no plan, with what was found in so many ``seconds``; None where there is one.

    These are of the process's processor time, and ten times as many of wall time where others have the processor.

    Raises DroppedError where nothing was found by then, or when it was ``stopped``, and SolverError where the process
    could not be started, has ended, or does not take the stream.
    """
    end = time.monotonic() + SLOWEST * seconds
    try:
        child = WorkerProcess()
    except OSError as error:
        raise SolverError(f"the process that explains could not be started: {error}") from None

    def late() -> bool:
        """Tell whether it has to end."""
        return stopped() or child.worked >= seconds or time.monotonic() >= end

    try:
        child.send({"do": "explain", "program": program_to_message(program), "stream": stream_to_message(stream)})
        reply = child.reply(late, PATIENCE)
    except WorkerLostError as error:
        if late():
            raise DroppedError(f"it was not found out in {seconds:g} s") from None
        raise SolverError(f"the process that explains was lost: {error}") from None
    finally:
        child.kill()
    if "refused" in reply:
        raise SolverError(reply["refused"])
    if "late" in reply:
        raise DroppedError(f"it was not found out in {seconds:g} s")
    return None if reply["why"] is None else WhyNot.from_message(reply["why"])
