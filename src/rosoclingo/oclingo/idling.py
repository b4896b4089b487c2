"""Programs whose steps may be idle: for them many steps can be grounded at once without a plan getting longer.

A program that demands an action at every step has no answer whose horizon lies before the last grounded step; it has
to grow step by step.
"""

from typing import Callable

from rosoclingo.oclingo.engine import Engine
from rosoclingo.oclingo.program import ReactiveProgram

_TRIAL_STEPS = 3


def may_idle(program: ReactiveProgram, halt: Callable[[], bool]) -> bool:
    """Tell whether the first answer stays one when further steps are grounded; found out once for a program."""
    if program.may_idle is None:
        program.may_idle = _try(program, halt)
    return program.may_idle


def _try(program: ReactiveProgram, halt: Callable[[], bool]) -> bool:
    engine = Engine(program, (), set(), shortest=True)
    first = program.first_step
    try:
        engine.ground_to(first)
        if not engine.search(1, halt, first, first).satisfiable:
            return False
        engine.ground_to(first + _TRIAL_STEPS)
        return bool(engine.search(1, halt, first, first).satisfiable)
    except RuntimeError:  # the search itself tells what is wrong
        return False
