"""Preparation of stream updates for a program: failure facts, closed cycles, and updates that report only success.

If a program declares ``_failed(A,V,C)``, each return that does not report success adds such a fact. A return is a
success if its value is the parameter of a committed action; any other value is a reason. A program could define
failures itself,

    failed(A,V,t) :- _return(A,V,t), not _action_lib(A,V,t).

but this rule would be grounded for every possible value. ``_failed/3`` costs nothing until an action fails. Without any
commitment for the cycle, each return adds it; then programs can still use the rule above.
"""

from dataclasses import replace
from typing import Dict, FrozenSet, Iterable, Iterator, List, Set

import clingo

from rosoclingo.oclingo.program.action_rules import FAILED, RETURN, is_action, is_action_of
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.terms import signature_of
from rosoclingo.oclingo.progression.updates import CloseCycles, Cumulative, Expire, Item, Statement, StreamUpdate


def with_failures(program: ReactiveProgram, update: StreamUpdate, before: Iterable[Statement]) -> StreamUpdate:
    """Return the update with ``_failed`` facts if ``program`` uses them; ``before``: earlier permanent statements."""
    if FAILED not in program.open_signatures:
        return update
    returns = {one.head for one in _lasting(update) if one.head is not None and signature_of(one.head) == RETURN}
    failed = returns - _successes(update, before) if returns else returns
    if not failed:
        return update
    items: List[Item] = []
    for item in update.items:
        items.append(item)
        if isinstance(item, Statement) and item.head in failed and not item.body:
            items.append(Statement(_failure_of(item.head)))
    return replace(update, items=tuple(items))


def closed_cycles(update: StreamUpdate, first: int, step: int) -> Dict[int, FrozenSet[clingo.Symbol]]:
    """Return the cycles from ``first`` on that ``update`` closes, with their executed actions.

    It can close cycles up to its step, or up to the present ``step`` if it has none.
    """
    last = step if update.step is None else update.step
    cycles = (
        cycle
        for item in update.items
        if isinstance(item, CloseCycles)
        for cycle in range(max(item.first, first), min(item.last, last) + 1)
    )
    return {cycle: frozenset(filter(is_action_of(cycle), update.committed)) for cycle in cycles}


def reports_only_success(update: StreamUpdate, before: Iterable[Statement]) -> bool:
    """Return whether ``update`` contains only commitments and returns that report success.

    ``before`` are the earlier permanent statements.
    """
    as_planned = _successes(update, before)
    plain = all(isinstance(item, (Statement, Cumulative, CloseCycles, Expire)) for item in update.items)
    statements = [one for _, one in update.sections()]
    return plain and all(one.head in as_planned or _demands_action(one) for one in statements)


def with_their_failures(facts: FrozenSet[clingo.Symbol]) -> FrozenSet[clingo.Symbol]:
    """Return ``facts`` and the ``_failed`` facts of the returns among them."""
    return facts | {_failure_of(fact) for fact in facts if signature_of(fact) == RETURN}


def _failure_of(answer: clingo.Symbol) -> clingo.Symbol:
    """Return ``_failed(A,V,C)`` for ``_return(A,V,C)``."""
    return clingo.Function(FAILED.name, answer.arguments)


def _successes(update: StreamUpdate, before: Iterable[Statement]) -> Set[clingo.Symbol]:
    """Return the returns that report success: those of committed actions."""
    actions = (one.body[0].atom for one in (*before, *_lasting(update)) if _demands_action(one))
    return {clingo.Function(RETURN.name, action.arguments) for action in actions}


def _lasting(update: StreamUpdate) -> Iterator[Statement]:
    """Yield the permanent facts and constraints of the update."""
    for section, statement in update.sections():
        if isinstance(section, Cumulative) and (statement.head is None or not statement.body):
            yield statement


def _demands_action(statement: Statement) -> bool:
    return statement.is_commitment and is_action(statement.body[0].atom)
