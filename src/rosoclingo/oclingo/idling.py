"""Programs whose steps may be idle: for them many steps can be grounded at once without a plan getting longer.

A program that demands an action at every step has no answer whose horizon lies before the last grounded step; it has
to grow step by step.
"""

from typing import Callable, Optional

from rosoclingo.oclingo.engine import Engine
from rosoclingo.oclingo.program import ReactiveProgram

_TRIAL_STEPS = 3


def may_idle(program: ReactiveProgram, halt: Callable[[], bool]) -> bool:
    """Tell whether the first answer stays one when further steps are grounded; found out once for a program.

    False as well where ``halt`` ended the trial; the next call then makes another one.
    """
    if program.may_idle is None:
        program.may_idle = _try(program, halt)
    return bool(program.may_idle)


def _try(program: ReactiveProgram, halt: Callable[[], bool]) -> Optional[bool]:
    first = program.first_step
    try:
        engine = Engine(program, (), set(), shortest=True)
        engine.ground_to(first)
        found = engine.search(1, halt, first, first).satisfiable
        if found:
            engine.ground_to(first + _TRIAL_STEPS)
            found = engine.search(1, halt, first, first).satisfiable
        return found
    except RuntimeError:  # the search itself tells what is wrong
        return False
