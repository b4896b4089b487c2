"""What interfaces may tell the core, and what of it makes no sense."""

from typing import Optional

from clingo import Symbol

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.reasoning.dispatch import Dispatch, ReturnError
from rosoclingo.reasoning.keywords import RESERVED, RETURN, is_keyword, return_of


class FactError(ValueError):
    """A fact that no interface may state, or that the program has no use for; the text says why."""


def check_fact(atom: Symbol, program: ReactiveProgram) -> None:
    """Raises FactError when ``atom`` is one of the core's own keywords or no external of the program."""
    signature = (atom.name, len(atom.arguments))
    if signature in RESERVED:
        raise FactError("{}/{} is for the core and the program only".format(*signature))
    if not program.declares_external(*signature):
        raise FactError("the program declares no external {}/{}".format(*signature))


def take_return(atom: Symbol, dispatch: Optional[Dispatch]) -> bool:
    """Count ``atom`` as the return of an action under way; False when it is no return at all.

    Raises KeywordError when it is a malformed return, and ReturnError when no action waits for it.
    """
    if not is_keyword(atom, RETURN):
        return False
    answer = return_of(atom)
    if dispatch is None:
        raise ReturnError("no action is under way")
    dispatch.take(answer)
    return True
