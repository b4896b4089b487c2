"""The service ``~explain``: why a goal was given up, found by a process of its own while the core goes on."""

import json
import threading

import rospy

from rosoclingo.common.worker import Worker, ending
from rosoclingo.oclingo import ReactiveProgram, SolverError
from rosoclingo.planning.workers.explanation import explain_in_worker
from rosoclingo.reasoning.events import GoalUnmet
from rosoclingo.reasoning.given_up import GivenUpGoals
from rosoclingo.srv import Explain, ExplainResponse

#: Seconds of processor time for the reasons.
EXPLAINING = 30.0

#: Seconds of wall time that one waits for those who asked before.
PATIENCE = 60.0


class UnmetGoals:
    """Explains goals that were given up when asked; ``goals`` are those that are remembered, the worker's own.

    The callback asks the worker for a goal's stream, which takes no time; then it waits for the process in the thread
    that ROS has for each call, so that the core goes on. One goal is explained at a time.
    """

    def __init__(self, program: ReactiveProgram, worker: Worker, goals: GivenUpGoals) -> None:
        self._program, self._worker, self._goals = program, worker, goals
        self._turn = threading.Lock()
        self._service = rospy.Service("~explain", Explain, lambda request: self._on_explain(request.goal))

    def _on_explain(self, goal: str) -> ExplainResponse:
        event = self._worker.ask(lambda: self._goals.find(goal))
        if event is None:
            known = ", ".join(map(str, self._worker.ask(lambda: self._goals.terms)))
            text = f"no goal '{goal}' was given up for want of a plan; those that were: {known or 'none'}"
            return ExplainResponse(success=False, message=text)
        if not self._turn.acquire(timeout=PATIENCE):
            return ExplainResponse(success=False, message="other goals are being explained: ask again")
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
        return ExplainResponse(success=False, message=f"{event.term}: there is a plan, but none was found in time then")
    return ExplainResponse(True, f"{event.term}: {why.text}", json.dumps(why.message))
