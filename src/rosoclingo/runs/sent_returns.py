"""The returns of stream updates, as interfaces sent them: updates date the return of an action that went on later."""

from typing import List, Optional

from clingo import SymbolType

from rosoclingo.oclingo import Statement, StreamUpdate
from rosoclingo.reasoning.keywords import RETURN, RUNNING, Action, Return, is_keyword, return_of


class SentReturns:
    """Follows the updates of a run, which state ``_running(A,P,C)`` for each cycle in which an action goes on."""

    def __init__(self) -> None:
        self._running: List[Action] = []  # actions that go on, as they were sent

    def of(self, update: StreamUpdate) -> List[Return]:
        """Return the returns of the next update, with the cycles in which their actions were sent."""
        heads = [item.head for item in update.items if isinstance(item, Statement) and item.head is not None]
        terms = [one.arguments for one in heads if is_keyword(one, RUNNING)]
        stated = [Action(interface, parameter, cycle.number) for interface, parameter, cycle in terms]
        first = {one.name: one for one in reversed(stated)}
        known = {one.name: one for one in self._running}
        ended = [one for one in self._running if one.name not in first]
        self._running = [known.get(name, one) for name, one in first.items()]
        return [_as_sent(return_of(one), ended) for one in heads if is_keyword(one, RETURN)]


def _as_sent(answer: Return, ended: List[Action]) -> Return:
    """Return a return with the cycle of one of the ``ended`` actions that had gone on, if it is about one."""
    same = [one for one in ended if one.interface == answer.interface]
    named: Optional[Action] = next((one for one in same if _names(answer, one)), None)
    found = named or next(iter(same), None)
    if found is None:
        return answer
    ended.remove(found)
    return answer._replace(cycle=found.cycle)


def _names(answer: Return, action: Action) -> bool:
    value = answer.value
    return action.parameter in (value, *(value.arguments[-1:] if value.type is SymbolType.Function else ()))
