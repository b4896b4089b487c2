"""Actions and cycles: which actions an answer of a given horizon, or of a cycle that has passed, may hold.

A commitment keeps an executed action in every later plan; nothing in a stream keeps actions out of a cycle that has
passed without them, nor out of the steps beyond the horizon for which an answer was searched. The first is done by
constraints on the atoms of the closed cycle, the second by the rules that are made here.
"""

from typing import Callable, List, Sequence, Set, Tuple

import clingo
from clingo.ast import AST, ASTType

from rosoclingo.oclingo.program.parts import Part
from rosoclingo.oclingo.program.sources import Source
from rosoclingo.oclingo.progression.terms import Signature, signature_of

ACTION = Signature("_action_lib", 3)
RETURN = Signature("_return", 3)
BEYOND = "__oclingo_beyond"
"""``__oclingo_beyond(T)``: the program's name for the literal that is true for steps beyond the horizon."""

_RULES = """
#program {header}.
#external {beyond}({cycle}){domain}.
:- _action_lib(A__,P__,{cycle}), {beyond}({cycle}).
"""


def is_action(atom: clingo.Symbol) -> bool:
    """Tell whether ``atom`` is an ``_action_lib(A,P,C)``."""
    return signature_of(atom) == ACTION


def is_action_of(cycle: int) -> Callable[[clingo.Symbol], bool]:
    """Return a test for the actions of ``cycle``."""
    return lambda atom: is_action(atom) and atom.arguments[2] == clingo.Number(cycle)


def closing_text(parts: Sequence[Part]) -> Source:
    """Return the rules for every way in which the heads of ``parts`` write the cycle of an action."""
    return Source("<closing>", "".join(_rules(name, parameter, cycle) for name, parameter, cycle in _cycles(parts)))


def _cycles(parts: Sequence[Part]) -> List[Tuple[str, str, str]]:
    """Return part name, parameter and cycle argument (C__ where it is not simple) of each action in a head."""
    found: Set[Tuple[str, str, str]] = set()
    for part in parts:
        # a volatile head is a head of its step all the same; the rules must outlast the window
        name = "cumulative" if part.name == "volatile" else part.name
        for statement, one in part.atoms:
            if one.head and statement.ast_type == ASTType.Rule and one.signature == ACTION:
                cycle = one.term.arguments[2]
                simple = cycle.ast_type in (ASTType.SymbolicTerm, ASTType.BinaryOperation)
                found.add((name, part.parameter, str(cycle) if simple and not _has_variable(cycle) else "C__"))
    return sorted(found)


def _has_variable(term: AST) -> bool:
    if term.ast_type == ASTType.BinaryOperation:
        return _has_variable(term.left) or _has_variable(term.right)
    return term.ast_type == ASTType.Variable


def _rules(name: str, parameter: str, cycle: str) -> str:
    header = f"{name}({parameter})" if parameter else name
    domain = " : _action_lib(_,_,C__)" if cycle == "C__" else ""
    return _RULES.format(header=header, cycle=cycle, domain=domain, beyond=BEYOND)
