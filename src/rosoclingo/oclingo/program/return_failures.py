"""Failures as facts of their own: beside a return that is no success, ``_failed(A,V,C)`` for programs that declare it.

Success is the parameter of an action that was committed, anything else is a reason. A program could say so itself,

    failed(A,V,t) :- _return(A,V,t), not _action_lib(A,V,t).

but would be ground for every value that may come; ``_failed/3`` comes when something has failed, and costs nothing
before. Where nothing was committed for the cycle, it comes with each return: the rule above still tells.
"""

from dataclasses import replace
from typing import FrozenSet, Iterable, Iterator, List, Set

import clingo

from rosoclingo.oclingo.program.action_rules import ACTION, RETURN
from rosoclingo.oclingo.progression.terms import Signature, signature_of
from rosoclingo.oclingo.progression.updates import Closed, Cumulative, Item, Literal, Over, Statement, StreamUpdate

FAILED = Signature("_failed", 3)


def failure_of(answer: clingo.Symbol) -> clingo.Symbol:
    """Return ``_failed(A,V,C)`` for ``_return(A,V,C)``."""
    return clingo.Function(FAILED.name, answer.arguments)


def with_failures(update: StreamUpdate, before: Iterable[Statement]) -> StreamUpdate:
    """Return ``update`` with each failure behind its return, given the statements that hold for ever ``before`` it."""
    told = {one.head for one in _lasting(update) if one.head is not None and signature_of(one.head) == RETURN}
    if not told:
        return update
    done = set(_commitments(before)) | set(_commitments(_lasting(update)))
    items: List[Item] = []
    rest = told - {clingo.Function(RETURN.name, action.arguments) for action in done}
    for item in update.items:
        items.append(item)
        if isinstance(item, Statement) and item.head in rest and not item.body:
            items.append(Statement(failure_of(item.head)))
    return replace(update, items=tuple(items))


def is_foreseen(update: StreamUpdate, before: Iterable[Statement]) -> bool:
    """Tell whether ``update`` holds nothing but commitments and the returns of what was done with success.

    ``before`` are the statements that hold for ever before it.
    """
    statements = [one for _, one in update.sections()]
    lasting = list(_lasting(update))
    done = set(_commitments(before)) | set(_commitments(lasting))
    as_planned = {clingo.Function(RETURN.name, action.arguments) for action in done}
    plain = all(isinstance(item, (Statement, Cumulative, Closed, Over)) for item in update.items)
    return plain and not update.withdrawn and all(one.head in as_planned or is_commitment(one) for one in statements)


def is_commitment(statement: Statement) -> bool:
    """Tell whether ``statement`` demands an action in every plan."""
    return statement.head is None and len(statement.body) == 1 and _demands_action(statement.body[0])


def with_their_failures(facts: FrozenSet[clingo.Symbol]) -> FrozenSet[clingo.Symbol]:
    """Return ``facts`` and what was told of the returns among them."""
    return facts | {failure_of(fact) for fact in facts if signature_of(fact) == RETURN}


def _lasting(update: StreamUpdate) -> Iterator[Statement]:
    """Yield the facts and constraints of the update that hold for ever."""
    for section, statement in update.sections():
        if isinstance(section, Cumulative) and (statement.head is None or not statement.body):
            yield statement


def _commitments(statements: Iterable[Statement]) -> Set[clingo.Symbol]:
    """Return the actions that must be in every plan."""
    return {one.body[0].atom for one in statements if is_commitment(one)}


def _demands_action(literal: Literal) -> bool:
    return not literal.positive and signature_of(literal.atom) == ACTION
