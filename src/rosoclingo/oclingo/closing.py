"""Closing a cycle: the actions of a past cycle are fixed to those that were executed.

A commitment keeps an executed action in every later plan; nothing in a stream keeps actions out of a cycle that has passed
without them. The rules here do: once ``__oclingo_closed(C)`` holds, an ``_action_lib(A,P,C)`` that is not
``__oclingo_kept(A,P,C)`` is impossible, whenever it comes to be grounded. An action beyond the horizon is impossible as well where
the solver looks for shortest plans.
"""

from typing import Iterable, List, Sequence, Set, Tuple

import clingo
from clingo.ast import ASTType

from rosoclingo.oclingo.horizon import BEYOND
from rosoclingo.oclingo.progression import Statement, fact
from rosoclingo.oclingo.rewriting import Part
from rosoclingo.oclingo.signatures import Signature, occurrences
from rosoclingo.oclingo.sources import Source

ACTION = Signature("_action_lib", 3)
CLOSED, KEPT = "__oclingo_closed", "__oclingo_kept"

_RULES = """
#program {header}.
#external {closed}({cycle}){domain}.
#external {beyond}({cycle}){domain}.
#external {kept}(A__,P__,{cycle}) : _action_lib(A__,P__,{cycle}).
:- _action_lib(A__,P__,{cycle}), {closed}({cycle}), not {kept}(A__,P__,{cycle}).
:- _action_lib(A__,P__,{cycle}), {beyond}({cycle}).
"""


def closing_text(parts: Sequence[Part]) -> Source:
    """Return the rules for every way in which the heads of ``parts`` write the cycle of an action."""
    return Source("<closing>", "".join(_rules(name, parameter, cycle) for name, parameter, cycle in _cycles(parts)))


def _cycles(parts: Sequence[Part]) -> List[Tuple[str, str, str]]:
    """Return part name, parameter and the text of the cycle argument of each action in a head; C__ for one that is not simple."""
    found: Set[Tuple[str, str, str]] = set()
    for part in parts:
        for statement in part.statements:
            for one in occurrences(statement) if statement.ast_type == ASTType.Rule else ():
                if one.head and one.signature == ACTION:
                    cycle = one.term.arguments[2]
                    simple = cycle.ast_type in (ASTType.SymbolicTerm, ASTType.BinaryOperation) and not _has_variable(cycle)
                    # a volatile head is a head of its step all the same; the rules must outlast the window
                    name = "cumulative" if part.name == "volatile" else part.name
                    found.add((name, part.parameter, str(cycle) if simple else "C__"))
    return sorted(found)


def _has_variable(term: "clingo.ast.AST") -> bool:
    if term.ast_type == ASTType.BinaryOperation:
        return _has_variable(term.left) or _has_variable(term.right)
    return term.ast_type == ASTType.Variable


def _rules(name: str, parameter: str, cycle: str) -> str:
    header = "{}({})".format(name, parameter) if parameter else name
    domain = " : _action_lib(_,_,C__)" if cycle == "C__" else ""
    return _RULES.format(header=header, cycle=cycle, domain=domain, closed=CLOSED, kept=KEPT, beyond=BEYOND)


def closing_facts(cycle: int, executed: Iterable[clingo.Symbol]) -> List[Statement]:
    """Return the facts that close ``cycle`` on the ``executed`` actions."""
    kept = [fact(clingo.Function(KEPT, action.arguments)) for action in executed]
    return kept + [fact(clingo.Function(CLOSED, [clingo.Number(cycle)]))]
