"""Tests whether the answers of a program stay valid when further steps are grounded."""

from typing import Optional
from weakref import WeakKeyDictionary

from rosoclingo.oclingo.errors import SolverError
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.planning.grounding import Grounding
from rosoclingo.planning.question import Question, Stop
from rosoclingo.planning.snapshot import Snapshot

_STEPS = 3
_RESULTS: "WeakKeyDictionary[ReactiveProgram, bool]" = WeakKeyDictionary()


def may_idle(program: ReactiveProgram, stopped: Stop) -> bool:
    """Return whether the first answer stays valid when further steps are grounded; cached by program.

    A stopped test returns False; the next call repeats it.
    """
    if program not in _RESULTS:
        result = _test(program, stopped)
        if result is None:
            return False
        _RESULTS[program] = result
    return _RESULTS[program]


def _test(program: ReactiveProgram, stopped: Stop) -> Optional[bool]:
    first = program.first_step
    question = Question(first, first, believes=False)
    try:
        grounding = Grounding(program, Snapshot(horizon=first, step=first, min_horizon=first), first)
        result = grounding.ask(question, stopped).satisfiable
        if result:
            grounding.grow_to(first + _STEPS)
            result = grounding.ask(question, stopped).satisfiable
        return result
    except SolverError:  # the search reports the error
        return False
