"""Facts between the core and the interfaces: parse commands, write returns.  No ROS."""

from typing import Callable, NamedTuple, Optional

from clingo import Function, Symbol

from rosoclingo.interfaces.values import read_atom
from rosoclingo.reasoning.keywords import (
    ACTION_LIB,
    CANCEL_ACTION,
    Action,
    KeywordError,
    Return,
    action_of,
    failure_value,
    is_keyword,
)

REMEMBERED = 1000  # limit of remembered actions; those of the present cycle always fit


class InterfaceCommand(NamedTuple):
    """A command from out_rosoclingo: run an action, or cancel a running action."""

    action: Action
    cancels: bool = False


def parse_command(text: str, interface: str) -> InterfaceCommand:
    """Parse `_action_lib(A,P,C)` or `_cancel(A,P,C)` sent to `interface`.  Raises TermError, KeywordError."""
    atom = read_atom(text)
    cancels = is_keyword(atom, CANCEL_ACTION)
    action = action_of(Function(ACTION_LIB, atom.arguments) if cancels else atom)
    if action.interface_name != interface:
        raise KeywordError(f"'{text}' is for {action.interface_name}, but was sent to {interface}")
    return InterfaceCommand(action, cancels)


class Sender(NamedTuple):
    """The sender of a message: the node's name, and the run announced by the same connection, if any."""

    node: str
    run: Optional[str]

    def can_cancel(self, owner: "Sender") -> bool:
        """Return whether this sender can cancel actions of ``owner``: a core that the owner has replaced cannot.

        A replaced core has another run, or the owner's name and another connection.
        """
        if owner.run is None or self.run == owner.run:
            return True
        return self.run is None and self.node != owner.node


def return_value(action: Action, value: Symbol, succeeded: bool, was_sent: Callable[[Action], bool]) -> Symbol:
    """Return the value of an action's return: its own parameter only for a success, never another action's.

    ``was_sent`` returns whether the core has sent an action in this run.
    """
    if succeeded and value == action.parameter:
        return value
    return failure_value(value, action.parameter, lambda term: was_sent(action._replace(parameter=term)))


def return_text(action: Action, value: Symbol) -> str:
    """Return the fact that answers an action: `_return(move_base,office2,1)`."""
    return str(Return(action.interface, value, action.cycle).atom)
