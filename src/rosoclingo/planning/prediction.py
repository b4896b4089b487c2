"""Prediction: an answer stays valid if its actions succeed and no rule that could change it depends on their returns.

Let M be an answer, and R the success returns of some actions of M. Consider the ground rules with an atom of R in the
body, negated or not. Suppose that each of them also has a literal that is false in M and is not a return. Then M
together with R is an answer of the program with R as facts: the rules whose bodies M satisfies are the same in both
reducts. No search is needed. Auxiliary atoms in M show whether the condition holds, see
:mod:`~rosoclingo.planning.return_rules`.

Shorter answers can appear if the condition fails for another answer. They cannot if there are no such ground rules, or
if the false literal is an action of the same cycle: all answers agree on the actions executed in that cycle.
"""

from functools import lru_cache
from typing import Callable, Dict, FrozenSet, Iterable, NamedTuple, Optional, Set

import clingo

from rosoclingo.oclingo.program.action_rules import RETURN
from rosoclingo.oclingo.progression.updates import CloseCycles, Cumulative, Expire, Statement, StreamUpdate
from rosoclingo.planning.history import Plan, cycle_of
from rosoclingo.planning.return_rules import ACTS, ASKS, ReturnRules


class PredictedReturns(NamedTuple):
    """Success returns that need no search.

    Attributes:
        returns: returns that leave the answer valid.
        certain: the subset of ``returns`` that also allows no new answer.

    """

    returns: FrozenSet[clingo.Symbol] = frozenset()
    certain: FrozenSet[clingo.Symbol] = frozenset()


def predict(
    actions: Iterable[clingo.Symbol],
    rules: ReturnRules,
    is_open: Callable[[clingo.Symbol], bool],
    is_true: Callable[[clingo.Symbol], Optional[bool]],
) -> PredictedReturns:
    """Return the predicted returns of an answer with these ``actions``.

    Args:
        actions: the actions of the answer.
        rules: the rules that depend on returns.
        is_open: whether an update can still assert an external.
        is_true: the truth value of an atom in the answer, None if no ground rule defines it.

    """
    returns: Set[clingo.Symbol] = set()
    certain: Set[clingo.Symbol] = set()
    for action in actions:
        success = success_of(action)
        asks = {number: is_true(_auxiliary(ASKS, number, action)) for number in range(rules.number)}
        if is_open(success) and not any(asks.values()):
            returns.add(success)
            ground = [number for number, holds in asks.items() if holds is not None]
            if all(number in rules.with_actions and not is_true(_auxiliary(ACTS, number, action)) for number in ground):
                certain.add(success)
    return PredictedReturns(frozenset(returns), frozenset(certain))


@lru_cache(maxsize=10_000)  # most answers of a search have the same actions
def _auxiliary(name: str, number: int, action: clingo.Symbol) -> clingo.Symbol:
    """Return the auxiliary atom of rule ``number`` for the return of ``action``."""
    return clingo.Function(name, [clingo.Number(number), *action.arguments])


def success_of(action: clingo.Symbol) -> clingo.Symbol:
    """Return the return that reports the success of ``action``."""
    return clingo.Function(RETURN.name, action.arguments)


@lru_cache(maxsize=2)  # many updates can be checked against one plan
def _actions_by_cycle(plan: Plan) -> Dict[int, Set[clingo.Symbol]]:
    actions: Dict[int, Set[clingo.Symbol]] = {}
    for action in plan.actions:
        actions.setdefault(cycle_of(action), set()).add(action)
    return actions


def is_predicted(plan: Plan, predicted: FrozenSet[clingo.Symbol], step: int, update: StreamUpdate) -> bool:
    """Return whether ``update`` reports only that the actions planned for ``step`` succeeded as ``predicted``.

    If further actions are planned, the answer with this ``plan`` is an answer after the update as well.
    """
    actions = _actions_by_cycle(plan)
    if update.step != step + 1 or plan.horizon <= step or max(actions, default=step) <= step:
        return False  # the horizon of an answer is never less than the step of the last update
    due = actions.get(step, set())
    expected = predicted.intersection(map(success_of, due))
    is_plain = all(_is_plain(item, expected, step) for item in update.items)
    return is_plain and update.committed == due and CloseCycles(step, step) in update.items


def _is_plain(item: object, expected: FrozenSet[clingo.Symbol], step: int) -> bool:
    if isinstance(item, Statement):
        return item.is_commitment or (item.head in expected and not item.body)
    return isinstance(item, (Cumulative, Expire)) or item == CloseCycles(step, step)
