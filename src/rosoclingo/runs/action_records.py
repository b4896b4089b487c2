"""Records of the dispatched actions, each with its return."""

from typing import Dict, List, Set, Tuple

from rosoclingo.reasoning.keywords import ACTION_LIB, CANCEL_ACTION, PREEMPTED, Return, name_of
from rosoclingo.runs.run_tables import Table, Words
from rosoclingo.runs.topic_atoms import action_in

__all__ = ["ActionRecords"]

#: Limit of remembered returns that arrived before their actions.
EARLY = 20


class ActionRecords:
    """Adds actions to ``table``, by their numbers in ``words``, with times in seconds from the beginning."""

    def __init__(self, table: Table, words: Words) -> None:
        self._table, self._words = table, words
        self.forget()

    def forget(self) -> None:
        """Forget all running actions, for another run of the core."""
        self._open: Dict[Tuple[str, int], List[int]] = {}  # numbers of records, by interface and cycle
        self._cancelled: Set[int] = set()  # numbers of records of cancelled actions
        self._early: List[Return] = []  # returns of actions that have not arrived: topics have no common order

    def dispatched(self, now: float, texts: List[str]) -> None:
        """Add actions, and mark cancelled actions."""
        for text in texts:
            if text.startswith(CANCEL_ACTION):
                self._cancel(ACTION_LIB + text[len(CANCEL_ACTION) :])
                continue
            word = self._words.number(text)
            number = self._table.add(action=word, begun=now, ended=None, value=None, failed=False, preempted=False)
            action = self._words.entries[word]
            self._open.setdefault((action["interface"], action["cycle"]), []).append(number)
        self._early = [answer for answer in self._early if not self._answered(now, answer)]

    def returned(self, now: float, answer: Return) -> None:
        """Add a return to its action, also if the action arrives later."""
        if not self._answered(now, answer):
            self._early = [*self._early, answer][-EARLY:]

    def _cancel(self, text: str) -> None:
        action = action_in(text)
        if action is not None:
            running = self._open.get((action.interface_name, action.cycle), [])
            self._cancelled.update(one for one in running if self._parameter(one) == name_of(action.parameter))

    def _answered(self, now: float, answer: Return) -> bool:
        """Add a return to its action; return whether the action exists."""
        value = name_of(answer.value)
        running = self._open.get((answer.interface_name, answer.cycle), [])
        if not running:
            return False
        succeeded = [number for number in running if self._parameter(number) == value]
        preempted = [number for number in running if number in self._cancelled and answer.value == PREEMPTED]
        number = (succeeded or preempted or running)[0]
        running.remove(number)
        found = {"failed": not (succeeded or preempted), "preempted": bool(preempted) and not succeeded}
        self._table.change(number).update(ended=now, value=value, **found)
        return True

    def _parameter(self, number: int) -> str:
        return str(self._words.entries[self._table[number]["action"]]["parameter"])
