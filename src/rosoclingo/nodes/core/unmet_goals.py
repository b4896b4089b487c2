"""The service ``~explain``: explains in a separate process why a goal was aborted, while the core continues."""

import json
import threading

import rospy

from rosoclingo.common.worker import Worker, ending
from rosoclingo.oclingo import ReactiveProgram, SolverError
from rosoclingo.planning.workers.explanation import explain_in_worker
from rosoclingo.reasoning.aborted_goals import AbortedGoals
from rosoclingo.reasoning.events import GoalUnmet
from rosoclingo.srv import Explain, ExplainResponse

#: Limit in seconds of processor time for one explanation.
EXPLAINING = 30.0

#: Limit in seconds of wall time that a request waits for earlier requests.
PATIENCE = 60.0


class UnmetGoals:
    """Explains aborted goals on request; ``goals`` are the remembered goals, which belong to the worker.

    The callback asks the worker for a goal's stream, which takes no time. Then it waits for the process in the thread
    of the call, so that the core continues. Goals are explained one at a time.
    """

    def __init__(self, program: ReactiveProgram, worker: Worker, goals: AbortedGoals) -> None:
        self._program, self._worker, self._goals = program, worker, goals
        self._turn = threading.Lock()
        self._service = rospy.Service("~explain", Explain, lambda request: self._on_explain(request.goal))

    def _on_explain(self, goal: str) -> ExplainResponse:
        event = self._worker.ask(lambda: self._goals.find(goal))
        if event is None:
            known = ", ".join(map(str, self._worker.ask(lambda: self._goals.terms)))
            text = f"no goal '{goal}' was aborted for lack of a plan; aborted goals: {known or 'none'}"
            return ExplainResponse(success=False, message=text)
        if not self._turn.acquire(timeout=PATIENCE):
            return ExplainResponse(success=False, message="busy with explanations of other goals: try again")
        try:
            return _explained(self._program, event)
        finally:
            self._turn.release()


def _explained(program: ReactiveProgram, event: GoalUnmet) -> ExplainResponse:
    try:
        why = explain_in_worker(program, event.stream, EXPLAINING, ending)
    except SolverError as error:
        return ExplainResponse(success=False, message=f"{event.term}: {error}")
    if why is None:
        return ExplainResponse(success=False, message=f"{event.term}: a plan exists, but it was not found in time")
    return ExplainResponse(True, f"{event.term}: {why.text}", json.dumps(why.message))
