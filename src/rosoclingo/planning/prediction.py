"""What is predicted: an answer stays one when what it plans is done with success, where its rules do not ask for that.

Let M be an answer, and R the returns of success for actions of M that are to be told. If in every ground rule in
whose body one of R stands, under ``not`` or not, some literal that is no return is false in M, then M and R together
are an answer of the program with R as facts: in both reducts the rules whose bodies M satisfies are the same. It needs
no search. M itself tells where that is so, see :mod:`~rosoclingo.oclingo.program.return_rules`.

There may be shorter ones then, if in another answer these rules come into play. That can't be where there are no such
ground rules, nor where something is false of the actions of the same cycle: all answers have the actions that were
executed in it, and no others.
"""

from functools import lru_cache
from typing import Callable, Dict, FrozenSet, Iterable, NamedTuple, Optional, Set

import clingo

from rosoclingo.oclingo.program.action_rules import RETURN
from rosoclingo.oclingo.program.return_rules import ACTS, ASKS, ReturnRules
from rosoclingo.oclingo.progression.updates import Closed, Cumulative, Over, Statement, StreamUpdate
from rosoclingo.planning.history import AcceptedUpdate, History, Plan, cycle_of


class Predicted(NamedTuple):
    """The returns of success that may be told without a search.

    Attributes:
        returns: with them the answer stays one.
        certain: those of them with which no other answer comes in, either.

    """

    returns: FrozenSet[clingo.Symbol] = frozenset()
    certain: FrozenSet[clingo.Symbol] = frozenset()


def predict(
    actions: Iterable[clingo.Symbol],
    rules: ReturnRules,
    is_open: Callable[[clingo.Symbol], bool],
    is_true: Callable[[clingo.Symbol], Optional[bool]],
) -> Predicted:
    """Return what is predicted of an answer with these ``actions``.

    ``rules`` say what returns bear on, ``is_open`` whether an external may still be told, ``is_true`` what the answer
    says of an atom: None where no ground rule defines it.
    """
    returns: Set[clingo.Symbol] = set()
    certain: Set[clingo.Symbol] = set()
    for action in actions:
        told = success_of(action)
        asking = {number: is_true(_of(ASKS, number, action)) for number in range(rules.number)}
        if is_open(told) and not any(asking.values()):
            returns.add(told)
            ground = [number for number, asks in asking.items() if asks is not None]
            if all(number in rules.acting and not is_true(_of(ACTS, number, action)) for number in ground):
                certain.add(told)
    return Predicted(frozenset(returns), frozenset(certain))


@lru_cache(maxsize=10_000)  # most answers of a search have the same actions
def _of(name: str, number: int, action: clingo.Symbol) -> clingo.Symbol:
    """Return the atom by which rule ``number`` tells something of the return of ``action``."""
    return clingo.Function(name, [clingo.Number(number), *action.arguments])


def success_of(action: clingo.Symbol) -> clingo.Symbol:
    """Return what the interface tells where ``action`` is done with success."""
    return clingo.Function(RETURN.name, action.arguments)


@lru_cache(maxsize=2)  # many updates may be asked about for one plan
def _by_cycle(plan: Plan) -> Dict[int, Set[clingo.Symbol]]:
    """Return the actions of each cycle that has any."""
    actions: Dict[int, Set[clingo.Symbol]] = {}
    for action in plan.actions:
        actions.setdefault(cycle_of(action), set()).add(action)
    return actions


def goes_on(plan: Plan, predicted: FrozenSet[clingo.Symbol], step: int, update: StreamUpdate) -> bool:
    """Whether ``update`` tells that what is planned for ``step`` was done, with success that is ``predicted``.

    And nothing else, and that something is left to do. The answer that has the ``plan`` is one after the update then.
    """
    actions = _by_cycle(plan)
    if update.step != step + 1 or plan.horizon <= step or max(actions, default=step) <= step:
        return False  # an answer's horizon is never less than the step of the last update
    due = actions.get(step, set())
    known = predicted.intersection(map(success_of, due))
    plain = all(_is_plain(item, known, step) for item in update.items)
    return plain and update.committed == due and Closed(step, step) in update.items


def log_after(
    log: History, plan: Plan, predicted: FrozenSet[clingo.Symbol], updates: Iterable[StreamUpdate]
) -> Optional[History]:
    """Return the ``log`` after ``updates`` for all of which its ``plan`` goes on, see :func:`goes_on`; else None."""
    for update in updates:
        if not goes_on(plan, predicted, log.step, update):
            return None
        log = log.then(AcceptedUpdate(update, log.horizon, predicted=True))
    return log


def _is_plain(item: object, known: FrozenSet[clingo.Symbol], step: int) -> bool:
    if isinstance(item, Statement):
        return item.is_commitment or (item.head in known and not item.body)
    return isinstance(item, (Cumulative, Over)) or item == Closed(step, step)
