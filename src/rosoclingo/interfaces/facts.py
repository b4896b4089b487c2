"""Facts on the two topics between the core and the interface layer: reading commands, writing returns.  No ROS."""

import enum
from typing import NamedTuple

from clingo import Function, Symbol

from rosoclingo.interfaces.values import TermError, read_atom
from rosoclingo.reasoning.keywords import (
    ACTION_LIB,
    CANCEL_ACTION,
    Action,
    KeywordError,
    Return,
    action_of,
    is_keyword,
)


class FactError(ValueError):
    """A fact that is no command; the message holds the text and what is wrong with it."""


class Verb(enum.Enum):
    """What the core asks of an interface."""

    RUN = ACTION_LIB
    CANCEL = CANCEL_ACTION


class Command(NamedTuple):
    """A fact read from out_rosoclingo: run an action, or cancel one that is running."""

    verb: Verb
    action: Action


def parse_command(text: str, interface: str) -> Command:
    """Read `_action_lib(A,P,C)` or `_cancel(A,P,C)` sent to `interface`.  Raises FactError."""
    try:
        atom = read_atom(text)
        verb = Verb.CANCEL if is_keyword(atom, CANCEL_ACTION) else Verb.RUN
        action = action_of(_renamed(atom, ACTION_LIB) if verb is Verb.CANCEL else atom)
    except (TermError, KeywordError) as error:
        raise FactError(str(error)) from error
    if action.interface_name != interface:
        raise FactError(f"'{text}' is for {action.interface_name}, but was sent to {interface}")
    return Command(verb, action)


def return_text(action: Action, value: Symbol) -> str:
    """The fact that answers an action: `_return(move_base,office2,1)`."""
    return str(Return(action.interface, value, action.cycle).atom)


def _renamed(atom: Symbol, name: str) -> Symbol:
    return Function(name, atom.arguments)
