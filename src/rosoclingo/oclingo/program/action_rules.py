"""Rules that exclude actions from closed cycles and from steps beyond the horizon.

A commitment keeps an executed action in every later plan. Nothing in a stream excludes further actions from a closed
cycle, or from the steps beyond the horizon of a search. Constraints on the atoms of the closed cycle do the former,
the rules of this module the latter.

A successful action returns its parameter. If a program opens all of ``_return/3``, the rules also declare these returns
step by step. Without these declarations, a return of a grounded step could require regrounding.
"""

from typing import Callable, Container, FrozenSet, Iterable, Sequence, Set, Tuple

import clingo
from clingo.ast import ASTType

from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.parts import Part
from rosoclingo.oclingo.program.sources import Source
from rosoclingo.oclingo.progression.terms import Signature

ACTION = Signature("_action_lib", 3)
RETURN = Signature("_return", 3)
FAILED = Signature("_failed", 3)
RUNNING = Signature("_running", 3)
TAKES = Signature("_takes", 3)
ANY = clingo.Function("any")
"""Stands for all parameters of an interface in ``_takes(A,any,S)``."""
STEPS = Signature("_steps", 2)
"""``_steps(N,C)``: the program claims that a plan from cycle C on has at least N steps; #sup: there is none."""
BEYOND = Signature("__oclingo_beyond", 1)
"""``__oclingo_beyond(T)``: an external that is true for steps beyond the horizon."""

_RULES = """
#program {header}.
#external {beyond}({cycle}){domain}.
:- _action_lib(A__,P__,{cycle}), {beyond}({cycle}).
"""
_SUCCESS = "#external _return(A__,P__,{cycle}) : _action_lib(A__,P__,{cycle}).\n"
_VARIABLE = "C__"


def is_action(atom: clingo.Symbol) -> bool:
    """Return whether ``atom`` is an ``_action_lib(A,P,C)``; any symbol of an answer can be passed."""
    return atom.match(*ACTION)


def dated_actions(symbols: Iterable[clingo.Symbol]) -> FrozenSet[clingo.Symbol]:
    """Return the ``_action_lib(A,P,C)`` among the symbols of an answer whose C is a number."""
    return frozenset(one for one in filter(is_action, symbols) if one.arguments[2].type is clingo.SymbolType.Number)


def steps_claimed(claim: clingo.Symbol, cycle: int) -> int:
    """Return N if ``claim`` is ``_steps(N,cycle)`` for a number N, else 0."""
    steps, of = claim.arguments
    return steps.number if steps.type is clingo.SymbolType.Number and of == clingo.Number(cycle) else 0


def no_plan_from(cycle: int) -> clingo.Symbol:
    """Return the claim that there is no plan from ``cycle`` on, of any length."""
    return clingo.Function(STEPS.name, [clingo.Supremum, clingo.Number(cycle)])


def is_action_of(cycle: int) -> Callable[[clingo.Symbol], bool]:
    """Return a test for the actions of ``cycle``."""
    return lambda atom: is_action(atom) and atom.arguments[2] == clingo.Number(cycle)


def closing_text(parts: Sequence[Part], opened: Container[Signature]) -> Source:
    """Return rules for each form in which heads of ``parts`` write the cycle of an action.

    ``opened`` lists the predicates that the program declares external as a whole.
    """
    forms: Set[Tuple[str, str, str]] = set()  # name and parameter of the part, and the cycle
    for part in parts:
        # the rules must outlast the window of a volatile rule
        name = "cumulative" if part.name == "volatile" else part.name
        for one in part.atoms:
            if one.defines and one.signature == ACTION:
                cycle = one.term.arguments[2]
                forms.add((name, part.parameter, str(cycle) if _has_one_value(cycle) else _VARIABLE))
    return Source("<program>", "".join(_rules(*form, RETURN in opened) for form in sorted(forms)))


def _has_one_value(term: Node) -> bool:
    """Return whether ``term`` has exactly one value at a step, independent of the rest of its rule."""
    if term.ast_type == ASTType.BinaryOperation:
        return _has_one_value(term.left) and _has_one_value(term.right)
    return bool(term.ast_type == ASTType.SymbolicTerm)


def _rules(name: str, parameter: str, cycle: str, returns: bool) -> str:
    header = f"{name}({parameter})" if parameter else name
    domain = f" : _action_lib(_,_,{_VARIABLE})" if cycle == _VARIABLE else ""
    # with a variable cycle clingo would instantiate the actions of all steps at each step
    success = _SUCCESS.format(cycle=cycle) if returns and cycle != _VARIABLE else ""
    return _RULES.format(header=header, cycle=cycle, domain=domain, beyond=BEYOND.name) + success
