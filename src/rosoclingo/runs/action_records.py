"""Records of the dispatched actions, each with its return."""

from collections import defaultdict, deque
from typing import DefaultDict, Deque, Dict, List, Optional, Set, Tuple

from rosoclingo.reasoning.keywords import ACTION_LIB, CANCEL_ACTION, PREEMPTED, Return, name_of
from rosoclingo.runs.run_tables import PlannedActions, Record, Table
from rosoclingo.runs.topic_atoms import action_in

#: Limits of remembered returns that arrived before their actions, and of an interface's remembered actions.
EARLY = RECENT = 20


class ActionRecords:
    """Adds actions to ``table``, by their numbers in ``planned``, with times in seconds from the beginning."""

    def __init__(self, table: Table, planned: PlannedActions) -> None:
        self._table, self._planned = table, planned
        self.forget()

    def forget(self) -> None:
        """Forget all running actions, for another run of the core."""
        self._open: Dict[Tuple[str, int], List[int]] = {}  # numbers of records, by interface and cycle
        self._recent: DefaultDict[str, Deque[int]] = defaultdict(lambda: deque(maxlen=RECENT))  # by interface
        self._cancelled: Set[int] = set()  # numbers of records of cancelled actions
        self._early: List[Return] = []  # returns of actions that have not arrived: topics have no common order

    def dispatched(self, now: float, texts: List[str]) -> None:
        """Add actions, and mark cancelled actions."""
        for text in texts:
            if text.startswith(CANCEL_ACTION):
                self._cancel(ACTION_LIB + text[len(CANCEL_ACTION) :])
                continue
            word = self._planned.number(text)
            number = self._table.add(action=word, begun=now, ended=None, value=None, failed=False, preempted=False)
            action = self._planned[word]
            self._open.setdefault((action["interface"], action["cycle"]), []).append(number)
            self._recent[action["interface"]].append(number)
        self._early = [answer for answer in self._early if self._answered(now, answer) is None]

    def returned(self, now: float, answer: Return) -> Optional[Record]:
        """Add a return to its action, also if the action arrives later; return the record of a known action."""
        found = self._answered(now, answer)
        if found is None:
            self._early = [*self._early, answer][-EARLY:]
        return found

    def as_sent(self, answer: Return) -> Return:
        """Return a return of an update as its interface sent it: updates date those of actions that went on later."""
        value, recent = name_of(answer.value), self._recent[answer.interface_name]
        cycles = ((self._planned[self._table[number]["action"]]["cycle"], number) for number in reversed(recent))
        known = [(cycle, number) for cycle, number in cycles if cycle <= answer.cycle]
        named = [cycle for cycle, number in known if self._parameter(number) == value]
        present = [cycle for cycle, _ in known if cycle == answer.cycle]
        ended = [cycle for cycle, number in known if self._table[number]["value"] == value]
        oldest = [cycle for cycle, number in reversed(known) if self._table[number]["ended"] is None]
        # the action that the value names; else one of this cycle, one that ended so, or the oldest that runs
        return answer._replace(cycle=next(iter((*named, *present, *ended, *oldest)), answer.cycle))

    def _cancel(self, text: str) -> None:
        action = action_in(text)
        if action is not None:
            running = self._open.get((action.interface_name, action.cycle), [])
            self._cancelled.update(one for one in running if self._parameter(one) == name_of(action.parameter))

    def _answered(self, now: float, answer: Return) -> Optional[Record]:
        """Add a return to its action and return the record; None if there is no such action."""
        value = name_of(answer.value)
        running = self._open.get((answer.interface_name, answer.cycle), [])
        if not running:
            return None
        succeeded = [number for number in running if self._parameter(number) == value]
        preempted = [number for number in running if number in self._cancelled and answer.value == PREEMPTED]
        number = (succeeded or preempted or running)[0]
        running.remove(number)
        found = {"failed": not (succeeded or preempted), "preempted": bool(preempted) and not succeeded}
        record = self._table.change(number)
        record.update(ended=now, value=value, **found)
        return record

    def _parameter(self, number: int) -> str:
        return str(self._planned[self._table[number]["action"]]["parameter"])
