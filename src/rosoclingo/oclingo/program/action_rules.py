"""Actions and cycles: which actions an answer of a given horizon, or of a cycle that has passed, may hold.

A commitment keeps an executed action in every later plan; nothing in a stream keeps actions out of a cycle that has
passed without them, nor out of the steps beyond the horizon for which an answer was searched. The first is done by
constraints on the atoms of the closed cycle, the second by the rules that are made here.

What an action returns is its parameter, when all goes well. Where a program opens all of ``_return/3``, these returns
are declared step by step as well: an atom that steps which are ground could have seen means to ground them anew.
"""

from typing import Callable, Container, FrozenSet, Iterable, List, Sequence, Set, Tuple

import clingo
from clingo.ast import ASTType

from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.parts import Part
from rosoclingo.oclingo.program.sources import Source
from rosoclingo.oclingo.progression.terms import Signature

ACTION = Signature("_action_lib", 3)
RETURN = Signature("_return", 3)
FAILED = Signature("_failed", 3)
STEPS = Signature("_steps", 2)
"""``_steps(N,C)``: the program claims that a plan from cycle C on takes N steps at least; #sup: that there is none."""
BEYOND = Signature("__oclingo_beyond", 1)
"""``__oclingo_beyond(T)``: the program's name for the literal that is true for steps beyond the horizon."""

_RULES = """
#program {header}.
#external {beyond}({cycle}){domain}.
:- _action_lib(A__,P__,{cycle}), {beyond}({cycle}).
"""
_SUCCESS = "#external _return(A__,P__,{cycle}) : _action_lib(A__,P__,{cycle}).\n"
_VARIABLE = "C__"


def is_action(atom: clingo.Symbol) -> bool:
    """Tell whether ``atom``, or any other symbol of an answer, is an ``_action_lib(A,P,C)``."""
    return atom.match(*ACTION)


class DatedActions:
    """Extract from the symbols of answers each ``_action_lib(A,P,C)`` whose C is a number.

    Most symbols of an answer were in the previous one, so its other symbols are cached and tested once.
    """

    def __init__(self) -> None:
        self._others: FrozenSet[clingo.Symbol] = frozenset()

    def __call__(self, symbols: Iterable[clingo.Symbol]) -> FrozenSet[clingo.Symbol]:
        """Return the actions of an answer."""
        answer = frozenset(symbols)
        found = frozenset(filter(_is_dated_action, answer - self._others))
        self._others = answer - found
        return found


def _is_dated_action(atom: clingo.Symbol) -> bool:
    return is_action(atom) and atom.arguments[2].type is clingo.SymbolType.Number


def steps_claimed(claim: clingo.Symbol, cycle: int) -> int:
    """Return N where ``claim`` is ``_steps(N,cycle)`` for a number N, else 0."""
    steps, of = claim.arguments
    return steps.number if steps.type is clingo.SymbolType.Number and of == clingo.Number(cycle) else 0


def no_plan_from(cycle: int) -> clingo.Symbol:
    """Return the claim that from ``cycle`` on there is no plan, however many steps it may have."""
    return clingo.Function(STEPS.name, [clingo.Supremum, clingo.Number(cycle)])


def is_action_of(cycle: int) -> Callable[[clingo.Symbol], bool]:
    """Return a test for the actions of ``cycle``."""
    return lambda atom: is_action(atom) and atom.arguments[2] == clingo.Number(cycle)


def cycle_alone(term: Node) -> Node:
    """Return the term of an ``_action_lib(A,P,C)`` with C as its only argument."""
    return term.update(arguments=list(term.arguments)[2:])


def closing_text(parts: Sequence[Part], opened: Container[Signature] = ()) -> Source:
    """Return the rules for every way in which the heads of ``parts`` write the cycle of an action.

    ``opened`` are the predicates that the program declares external as a whole.
    """
    returns = RETURN in opened
    return Source("<program>", "".join(_rules(*place, returns) for place in _cycles(parts)))


def _cycles(parts: Sequence[Part]) -> List[Tuple[str, str, str]]:
    """Return part name, parameter and cycle argument (_VARIABLE where it is not simple) of each action in a head."""
    found: Set[Tuple[str, str, str]] = set()
    for part in parts:
        # a volatile head is a head of its step all the same; the rules must outlast the window
        name = "cumulative" if part.name == "volatile" else part.name
        for statement, one in part.atoms:
            if one.head and statement.ast_type == ASTType.Rule and one.signature == ACTION:
                cycle = one.term.arguments[2]
                found.add((name, part.parameter, str(cycle) if _is_one(cycle) else _VARIABLE))
    return sorted(found)


def _is_one(term: Node) -> bool:
    """Tell whether ``term`` has one value at a step, whatever else its rule says."""
    if term.ast_type == ASTType.BinaryOperation:
        return _is_one(term.left) and _is_one(term.right)
    return bool(term.ast_type == ASTType.SymbolicTerm)


def _rules(name: str, parameter: str, cycle: str, returns: bool) -> str:
    header = f"{name}({parameter})" if parameter else name
    domain = f" : _action_lib(_,_,{_VARIABLE})" if cycle == _VARIABLE else ""
    # clingo would go through the actions of all steps at each step where the cycle is a variable
    success = _SUCCESS.format(cycle=cycle) if returns and cycle != _VARIABLE else ""
    return _RULES.format(header=header, cycle=cycle, domain=domain, beyond=BEYOND.name) + success
