"""The service ``~explain``: why a goal was given up, found out beside the core, in a process of its own."""

import json
import threading
from typing import Dict, Optional

import rospy
from clingo import Symbol

from rosoclingo.common.worker import Worker, ending
from rosoclingo.oclingo import ReactiveProgram, SolverError
from rosoclingo.oclingo.remote.explaining_process import explain_apart
from rosoclingo.reasoning import GoalUnmet
from rosoclingo.reasoning.keywords import identifier_of
from rosoclingo.srv import Explain, ExplainResponse

#: So many goals that were given up are remembered, the latest ones.
KEPT = 20

#: Seconds of processor time for the reasons.
EXPLAINING = 30.0

#: Seconds of wall time that one waits for those who asked before.
PATIENCE = 60.0


class UnmetGoals:
    """Remembers the goals that were given up, with the stream of that moment, and explains them when asked.

    The callback asks the worker for a goal's stream, which takes no time; then it waits for the process in the thread
    that ROS has for each call, so that the core goes on. One goal is explained at a time.
    """

    def __init__(self, program: ReactiveProgram, worker: Worker) -> None:
        self._program, self._worker = program, worker
        self._unmet: Dict[str, GoalUnmet] = {}
        self._turn = threading.Lock()
        self._service = rospy.Service("~explain", Explain, lambda request: self._on_explain(request.goal))

    def unmet(self, event: GoalUnmet) -> None:
        """Remember a goal; on the worker's thread."""
        self._unmet.pop(event.key, None)
        self._unmet[event.key] = event
        while len(self._unmet) > KEPT:
            del self._unmet[next(iter(self._unmet))]

    def _on_explain(self, goal: str) -> ExplainResponse:
        event = self._worker.ask(lambda: self._find(goal))
        if event is None:
            known = ", ".join(str(one.term) for one in self._worker.ask(lambda: list(self._unmet.values())))
            text = f"no goal '{goal}' was given up for want of a plan; those that were: {known or 'none'}"
            return ExplainResponse(success=False, message=text)
        if not self._turn.acquire(timeout=PATIENCE):
            return ExplainResponse(success=False, message="other goals are being explained: ask again")
        try:
            return _explained(self._program, event)
        finally:
            self._turn.release()

    def _find(self, goal: str) -> Optional[GoalUnmet]:
        """Return the goal of that id, text or identifier that was given up last; on the worker's thread."""
        if goal in self._unmet:
            return self._unmet[goal]
        named = (one for one in reversed(list(self._unmet.values())) if _is_named(one.term, goal.replace(" ", "")))
        return next(named, None)


def _is_named(term: Symbol, text: str) -> bool:
    return text in (str(term), str(identifier_of(term)))


def _explained(program: ReactiveProgram, event: GoalUnmet) -> ExplainResponse:
    try:
        why = explain_apart(program, event.stream, EXPLAINING, ending)
    except SolverError as error:
        return ExplainResponse(success=False, message=f"{event.term}: {error}")
    if why is None:
        return ExplainResponse(success=False, message=f"{event.term}: there is a plan, but none was found in time then")
    return ExplainResponse(True, f"{event.term}: {why.text()}", json.dumps(why.to_message()))
