"""Auxiliary rules by which an answer shows which returns can change it.

In a rule ``p(t) :- _return(A,V,t), q(V,t).`` the return matters only if ``q(V,t)`` holds. For the success returns of
executed actions, an auxiliary rule derives this condition:

    __oclingo_asks(0,A,V,t) :- _action_lib(A,V,t); q(V,t).

If the body also contains actions of the same cycle, ``__oclingo_acts(0,A,V,t)`` holds if these literals hold.
See :mod:`~rosoclingo.planning.prediction` for the use of both.
"""

from functools import lru_cache
from typing import FrozenSet, Iterable, List, NamedTuple, Optional, Sequence, Set, Tuple

import clingo
from clingo.ast import ASTType, Sign

from rosoclingo.oclingo.program.action_rules import ACTION, RETURN
from rosoclingo.oclingo.program.literals import names_in
from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.parts import Occurrence, Part
from rosoclingo.oclingo.program.patterns import FAR
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.signatures import term_signature
from rosoclingo.oclingo.progression.terms import Signature

ASKS, ACTS = "__oclingo_asks", "__oclingo_acts"

_CYCLE = 2  # the position of the cycle in actions and returns
_SIMPLE = (ASTType.Variable, ASTType.SymbolicTerm, ASTType.Function, ASTType.UnaryOperation, ASTType.BinaryOperation)


class ReturnRules(NamedTuple):
    """The auxiliary rules of a program.

    Attributes:
        texts: the name of a program part, its parameters, and the auxiliary rules to add to it.
        number: the number of rules that contain a return; they are numbered from 0.
        with_actions: the numbers of those that also contain actions of the same cycle.

    """

    texts: Tuple[Tuple[str, List[str], str], ...]
    number: int
    with_actions: FrozenSet[int]


def may_heed(parts: Sequence[Part], atoms: Iterable[clingo.Symbol]) -> bool:
    """Return whether a rule body can contain one of ``atoms`` at some step; False is certain."""
    candidates = list(atoms)
    return any(
        atom.match(one.signature.name, one.signature.arity) and one.can_match(atom, -FAR, FAR)
        for part in parts
        for one in part.atoms
        if not one.head
        for atom in candidates
    )


def is_predictable(program: ReactiveProgram) -> bool:
    """Return whether answers of ``program`` show which returns can change them.

    An answer must show its actions but no returns, and the program must not optimize: a return could then allow a
    better answer.
    """
    shows = ACTION in program.survey.shown and RETURN not in program.survey.shown
    return shows and not program.optimizes and return_rules(program) is not None


@lru_cache(maxsize=8)
def return_rules(program: ReactiveProgram) -> Optional[ReturnRules]:
    """Return the auxiliary rules of a program; None if it uses returns in other ways than as single body literals."""
    if is_opaque(program) or not _actions_are_timely(program.parts):
        return None
    texts: List[Tuple[str, List[str], str]] = []
    with_actions: Set[int] = set()
    for part in program.parts:
        for statement, found in part.found:
            returns = [one for one in found if one.signature == RETURN]
            if not _depends_on_returns(statement, returns):
                continue
            position = _position_of_return(statement, returns)
            if position is None:
                return None
            asks, acts = _auxiliary_rules(len(texts), statement, position)
            with_actions.update([len(texts)] if acts else [])
            texts.append((part.name, [part.parameter], asks + acts))
    return ReturnRules(tuple(texts), len(texts), frozenset(with_actions))


def _actions_are_timely(parts: Sequence[Part]) -> bool:
    """Return whether each step derives only actions of its own cycle."""
    actions = (one for part in parts for one in part.atoms if one.head and one.signature == ACTION)
    return all(one.offsets.get(_CYCLE) == 0 for one in actions)


def is_opaque(program: ReactiveProgram) -> bool:
    """Return whether the meaning of a program is not in its rules: it has theory atoms or edges of a graph."""
    return any(_is_opaque(statement) for part in program.parts for statement in part.statements)


def _is_opaque(statement: Node) -> bool:
    atoms = [literal.atom for literal in _body(statement) if literal.ast_type == ASTType.Literal]
    heads = [statement.head] if statement.ast_type == ASTType.Rule else []
    theory = any(one.ast_type == ASTType.TheoryAtom for one in (*atoms, *heads))
    return theory or statement.ast_type == ASTType.Edge


def _depends_on_returns(statement: Node, returns: Sequence[Occurrence]) -> bool:
    """Return whether answers can depend on ``returns`` in ``statement``; declarations and heuristics are ignored."""
    declares = statement.ast_type == ASTType.External and all(one.head for one in returns)
    return bool(returns) and not declares and statement.ast_type != ASTType.Heuristic


def _position_of_return(statement: Node, returns: Sequence[Occurrence]) -> Optional[int]:
    """Return the index of the return in a rule's body; None if the rule contains returns in any other way."""
    positions = [index for index, literal in enumerate(_body(statement)) if _is_atom(literal, RETURN)]
    if statement.ast_type != ASTType.Rule or not len(positions) == len(returns) == 1:
        return None
    simple = all(_is_simple(one) or str(one) == "_" for one in returns[0].arguments)
    offset = returns[0].offsets.get(_CYCLE)
    return positions[0] if simple and offset is not None and offset <= 0 else None


def _is_simple(term: Node) -> bool:
    return "_" not in names_in(term) and all(node.ast_type in _SIMPLE for node in term.nodes)


def _body(statement: Node) -> Sequence[Node]:
    return statement.body if hasattr(statement, "body") else ()


def _is_atom(literal: Node, signature: Signature) -> bool:
    """Return whether a body literal is an atom with ``signature``, negated or not."""
    plain = literal.ast_type == ASTType.Literal and literal.atom.ast_type == ASTType.SymbolicAtom
    return (
        plain and literal.atom.symbol.ast_type == ASTType.Function and term_signature(literal.atom.symbol) == signature
    )


def _auxiliary_rules(number: int, statement: Node, position: int) -> Tuple[str, str]:
    """Return both rules for a rule whose return is at ``position`` in its body; the second one can be empty.

    ``_`` in the return gets a name, so that heads can contain it.
    """
    rest = list(_body(statement))
    atom = rest.pop(position).atom.symbol
    texts = [str(one) for one in atom.arguments]
    arguments = ",".join(f"Any{index}__" if text == "_" else text for index, text in enumerate(texts))

    def rule(name: str, literals: Sequence[Node]) -> str:
        """Return the rule that derives the auxiliary atom ``name`` from the action and ``literals``."""
        body = [f"{ACTION.name}({arguments})", *map(str, literals)]
        return f"{name}({number},{arguments}) :- {'; '.join(body)}.\n"

    actions = [one for one in rest if _is_atom(one, ACTION) and str(one.atom.symbol.arguments[-1]) == texts[-1]]
    bound = set(names_in(atom)).union(*(names_in(one.atom) for one in actions if one.sign == Sign.NoSign))
    others = [*actions, *filter(_is_comparison, rest)]
    acts = rule(ACTS, [one for one in others if bound.issuperset(names_in(one.atom))]) if actions else ""
    return rule(ASKS, rest), acts


def _is_comparison(literal: Node) -> bool:
    return literal.ast_type == ASTType.Literal and literal.atom.ast_type == ASTType.Comparison
