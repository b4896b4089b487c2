"""Whether a program's answers outlive further steps."""

from typing import Optional
from weakref import WeakKeyDictionary

from rosoclingo.oclingo.errors import SolverError
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.planning.grounding import Grounding
from rosoclingo.planning.question import Question, Stop
from rosoclingo.planning.snapshot import Snapshot

_STEPS = 3
_KNOWN: "WeakKeyDictionary[ReactiveProgram, bool]" = WeakKeyDictionary()


def may_idle(program: ReactiveProgram, stopped: Stop) -> bool:
    """Whether the first answer stays one when further steps are ground; found out once for a program.

    False as well if ``stopped`` ended the trial; the next call then makes another one.
    """
    known = _KNOWN.get(program)
    if known is None:
        known = _try(program, stopped)
        if known is not None:
            _KNOWN[program] = known
    return bool(known)


def _try(program: ReactiveProgram, stopped: Stop) -> Optional[bool]:
    first = program.first_step
    question = Question(first, first, believes=False)
    try:
        grounding = Grounding(program, Snapshot(horizon=first, step=first, settled=first), first)
        found = grounding.ask(question, stopped).satisfiable
        if found:
            grounding.grow_to(first + _STEPS)
            found = grounding.ask(question, stopped).satisfiable
        return found
    except SolverError:  # the search itself tells what is wrong
        return False
