"""The predicates by which the core and a reactive program talk (the paper's Fig. 5, and more).

Atoms and terms are ``clingo.Symbol`` throughout; cycles are integers from 1.
"""

from typing import Callable, NamedTuple, Optional

from clingo import Function, Number, String, Symbol, SymbolType

REQUEST = "_request"
ACTION_LIB = "_action_lib"
RETURN = "_return"
FAILED = "_failed"
STATUS = "_status"
EXPLAIN = "_explain"
REFUSE = "_refuse"
NEVER = "_never"
CANCEL_ACTION = "_cancel"
CANCEL = "cancel"
RUN = "_run"

#: The name under which the core itself speaks to all interfaces.
CORE = "rosoclingo"

#: Keywords that only the core itself or the program may state: ``(name, arity)``.
RESERVED = frozenset(
    {(REQUEST, 2), (ACTION_LIB, 3), (FAILED, 3), (STATUS, 3), (EXPLAIN, 3), (REFUSE, 3), (CANCEL_ACTION, 3), (NEVER, 2)}
)

#: What stands for the present cycle in facts and in what is told of the state.
NOW = Function("now")

#: The return value of an action that did not answer in time.
TIMEOUT = Function("timeout")

#: The return value of an action that failed, where nothing else is told.
FAILURE = Function("failed")

#: The return value of an action that was ended since nobody wants it any more.
PREEMPTED = Function("preempted")

#: Characters of one goal or one fact.
LONGEST = 65536

#: Characters of a text that a message repeats, half of them from each end.
SHOWN = 200


class KeywordError(ValueError):
    """An atom with a keyword's name that is not of the keyword's form."""


class Action(NamedTuple):
    """One action of a plan: run ``interface`` with ``parameter`` in ``cycle``."""

    interface: Symbol
    parameter: Symbol
    cycle: int

    @property
    def atom(self) -> Symbol:
        """The action as ``_action_lib(A,P,C)``."""
        return Function(ACTION_LIB, [self.interface, self.parameter, Number(self.cycle)])

    @property
    def cancellation(self) -> Symbol:
        """What tells the interface to end the action: ``_cancel(A,P,C)``."""
        return Function(CANCEL_ACTION, [self.interface, self.parameter, Number(self.cycle)])

    @property
    def interface_name(self) -> str:
        """The interface's name as messages carry it."""
        return name_of(self.interface)


class Return(NamedTuple):
    """What came back from ``interface`` for an action of ``cycle``."""

    interface: Symbol
    value: Symbol
    cycle: int

    @property
    def interface_name(self) -> str:
        """The interface's name as messages carry it."""
        return name_of(self.interface)

    @property
    def atom(self) -> Symbol:
        """The return as ``_return(A,V,C)``."""
        return Function(RETURN, [self.interface, self.value, Number(self.cycle)])

    @property
    def failure(self) -> Symbol:
        """The atom that the solver adds to a return of failure: ``_failed(A,V,C)``."""
        return Function(FAILED, self.atom.arguments)


def success_of(action: Action) -> Symbol:
    """The return that says that an action has succeeded: its parameter."""
    return Return(action.interface, action.parameter, action.cycle).atom


def failure_value(reason: Symbol, parameter: Symbol, is_parameter: Callable[[Symbol], bool]) -> Symbol:
    """Return the failure value of the action of ``parameter``: the ``reason``, unless that reads as a success.

    A reason that equals the parameter becomes ``failed(P)``. One that equals the parameter of another action of the
    interface in the same cycle (``is_parameter``), or has it as its last argument, becomes ``failed(Reason,P)``.
    """
    value = reason
    while value == parameter or is_parameter(value) or _names_another(value, parameter, is_parameter):
        value = Function(FAILURE.name, [value] if value == parameter else [value, parameter])
    return value


def _names_another(value: Symbol, parameter: Symbol, is_parameter: Callable[[Symbol], bool]) -> bool:
    arguments = value.arguments if value.type is SymbolType.Function else []
    return bool(arguments) and arguments[-1] != parameter and is_parameter(arguments[-1])


def request(goal: Symbol, cycle: int) -> Symbol:
    """``_request(goal,cycle)``."""
    return Function(REQUEST, [goal, Number(cycle)])


def cancellation(identifier: Symbol, cycle: int) -> Symbol:
    """``_request(cancel(identifier),cycle)``."""
    return request(Function(CANCEL, [identifier]), cycle)


def run_of(identity: str) -> Symbol:
    """``_run("identity")``: which run of the core actions and cycles are of; a core that resumes has the same."""
    return Function(RUN, [String(identity)])


def action_of(atom: Symbol) -> Action:
    """Read an ``_action_lib(A,P,C)`` atom; raises KeywordError."""
    interface, parameter, cycle = _arguments(atom, ACTION_LIB, "_action_lib(A,P,C)")
    return Action(interface, parameter, cycle)


def return_of(atom: Symbol) -> Return:
    """Read a ``_return(A,V,C)`` atom; raises KeywordError."""
    interface, value, cycle = _arguments(atom, RETURN, "_return(A,V,C)")
    return Return(interface, value, cycle)


def is_keyword(atom: Symbol, name: str) -> bool:
    """Whether ``atom`` has the keyword's name, of whatever arity."""
    return atom.type is SymbolType.Function and atom.name == name


def identifier_of(goal: Symbol) -> Optional[Symbol]:
    """The identity of a goal term, its last argument; None for a term without arguments."""
    if goal.type is not SymbolType.Function or not goal.name or not goal.arguments:
        return None
    return goal.arguments[-1]


def name_of(term: Symbol) -> str:
    """A term as a name: a string's content, else the term's text."""
    return term.string if term.type is SymbolType.String else str(term)


def shortened(text: str, shown: int = SHOWN) -> str:
    """The text without its middle, if it is long: whoever has sent a megabyte need not read it again."""
    if len(text) <= shown:
        return text
    return f"{text[: shown // 2]} ... {text[-(shown // 2) :]} ({len(text)} characters)"


def _arguments(atom: Symbol, name: str, form: str) -> "tuple[Symbol, Symbol, int]":
    if not is_keyword(atom, name) or len(atom.arguments) != 3 or not atom.positive:
        raise KeywordError(f"'{atom}' is not of the form {form}")
    first, second, cycle = atom.arguments
    if cycle.type is not SymbolType.Number or cycle.number < 1:
        raise KeywordError(f"'{atom}': the cycle '{cycle}' is no positive integer")
    return first, second, cycle.number
