"""Keywords: the predicates that the core and a reactive program exchange (the paper's Fig. 5, extended).

All atoms and terms are of type ``clingo.Symbol``; cycles are integers from 1.
"""

from functools import lru_cache
from typing import Callable, Dict, FrozenSet, List, NamedTuple, Optional, Sequence, Tuple

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
RUNNING = "_running"
TAKES = "_takes"
RUN = "_run"
LOST = "_lost"
BACK = "_back"

#: The origin of the core's own facts for all interfaces.
CORE = "rosoclingo"

#: Keywords that interfaces must not state, as ``(name, arity)``: they belong to the core and the program.
RESERVED = frozenset(
    {(one, 3) for one in (ACTION_LIB, FAILED, STATUS, EXPLAIN, REFUSE, CANCEL_ACTION, RUNNING, TAKES)}
    | {(REQUEST, 2), (NEVER, 2)}
)

#: The constant for the current cycle, in facts and in reported beliefs.
NOW = Function("now")

#: The return value of an action that did not return in time.
TIMEOUT = Function("timeout")

#: The return value of an action whose interface was lost.
INTERFACE_LOST = Function("lost")

#: The return value of a failed action without a reason.
FAILURE = Function("failed")

#: The return value of a preempted action.
PREEMPTED = Function("preempted")

#: Maximum number of characters of a goal or a fact.
LONGEST = 65536

#: Maximum number of characters of a text quoted in a message; longer texts are shortened in the middle.
SHOWN = 200


class KeywordError(ValueError):
    """An atom has the name of a keyword, but not its form."""


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
        """The fact ``_cancel(A,P,C)``, by which the core cancels the action."""
        return Function(CANCEL_ACTION, [self.interface, self.parameter, Number(self.cycle)])

    @property
    def running(self) -> Symbol:
        """The fact ``_running(A,P,C)``: the action has not returned at the end of the cycle."""
        return Function(RUNNING, [self.interface, self.parameter, Number(self.cycle)])

    @property
    def name(self) -> Tuple[Symbol, Symbol]:
        """The interface and the parameter; at most one action of this name runs at a time."""
        return self.interface, self.parameter

    @property
    def interface_name(self) -> str:
        """The name of the interface as used in messages."""
        return name_of(self.interface)


class Return(NamedTuple):
    """The result of an action of ``cycle``, reported by ``interface``."""

    interface: Symbol
    value: Symbol
    cycle: int

    @property
    def interface_name(self) -> str:
        """The name of the interface as used in messages."""
        return name_of(self.interface)

    @property
    def atom(self) -> Symbol:
        """The return as ``_return(A,V,C)``."""
        return Function(RETURN, [self.interface, self.value, Number(self.cycle)])

    @property
    def failure(self) -> Symbol:
        """The atom that the solver adds to a failure return: ``_failed(A,V,C)``."""
        return Function(FAILED, self.atom.arguments)


def success_of(action: Action) -> Symbol:
    """Return the success return of an action: its value is the action's parameter."""
    return Return(action.interface, action.parameter, action.cycle).atom


def failure_value(reason: Symbol, parameter: Symbol, is_parameter: Callable[[Symbol], bool]) -> Symbol:
    """Return the failure value of an action with ``parameter``: the ``reason``, unless it looks like a success.

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
    """``_run("identity")``: the run of the core that actions and cycles belong to; a resumed core keeps it."""
    return Function(RUN, [String(identity)])


def action_of(atom: Symbol) -> Action:
    """Convert an atom ``_action_lib(A,P,C)`` to an action; raises KeywordError."""
    interface, parameter, cycle = _arguments(atom, ACTION_LIB, "_action_lib(A,P,C)")
    return Action(interface, parameter, cycle)


def return_of(atom: Symbol) -> Return:
    """Convert an atom ``_return(A,V,C)`` to a return; raises KeywordError."""
    interface, value, cycle = _arguments(atom, RETURN, "_return(A,V,C)")
    return Return(interface, value, cycle)


def is_keyword(atom: Symbol, name: str) -> bool:
    """Return whether ``atom`` has the name of a keyword, with any arity."""
    return atom.type is SymbolType.Function and atom.name == name


def atoms_of(answer: FrozenSet[Symbol], name: str) -> Sequence[Symbol]:
    """Return the atoms of an answer that have the name of a keyword, with any arity and in any order."""
    return _by_name(answer).get(name, ())


@lru_cache(maxsize=2)  # the answer stays the same while all actions succeed
def _by_name(answer: FrozenSet[Symbol]) -> Dict[str, List[Symbol]]:
    found: Dict[str, List[Symbol]] = {}
    for atom in answer:
        if atom.type is SymbolType.Function:
            found.setdefault(atom.name, []).append(atom)
    return found


def identifier_of(goal: Symbol) -> Optional[Symbol]:
    """Return the identifier of a goal term, its last argument; None for a term without arguments."""
    if goal.type is not SymbolType.Function or not goal.name or not goal.arguments:
        return None
    return goal.arguments[-1]


def name_of(term: Symbol) -> str:
    """Return the content of a string, or the text of any other term."""
    return term.string if term.type is SymbolType.String else str(term)


def shortened(text: str, shown: int = SHOWN) -> str:
    """Return a text, shortened in the middle to ``shown`` characters if it is longer, with its length."""
    if len(text) <= shown:
        return text
    return f"{text[: shown // 2]} ... {text[-(shown // 2) :]} ({len(text)} characters)"


def _arguments(atom: Symbol, name: str, form: str) -> Tuple[Symbol, Symbol, int]:
    if not is_keyword(atom, name) or len(atom.arguments) != 3 or not atom.positive:
        raise KeywordError(f"'{atom}' is not of the form {form}")
    first, second, cycle = atom.arguments
    if cycle.type is not SymbolType.Number or cycle.number < 1:
        raise KeywordError(f"'{atom}': the cycle '{cycle}' is not a positive integer")
    return first, second, cycle.number
