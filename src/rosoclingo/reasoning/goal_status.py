"""What has become of goals: what a program says of them, the ``_status(Id,S,C)`` atoms of an answer, and what it means.

``S`` is accepted, rejected, succeeded, canceled or aborted, or one of these words around a text,
``accepted("waits for the lift")``, ``aborted(("package ",3," is not at ",office2))``.
"""

from functools import lru_cache
from typing import Dict, FrozenSet, List, NamedTuple, Optional, Tuple

from clingo import Symbol, SymbolType

from rosoclingo.reasoning.action_extractor import TaskPlan
from rosoclingo.reasoning.explanations import text_of
from rosoclingo.reasoning.goals import Goal, Outcome
from rosoclingo.reasoning.keywords import STATUS, is_keyword

#: The words of ``_status``, worst first, and how they end a goal (None: it goes on).
WORDS: Dict[str, Optional[Outcome]] = {
    "aborted": Outcome.ABORTED,
    "rejected": Outcome.REJECTED,
    "canceled": Outcome.CANCELED,
    "succeeded": Outcome.SUCCEEDED,
    "accepted": None,
}


_Table = Dict[Tuple[Symbol, int], List[Symbol]]


class Status(NamedTuple):
    """One word about one goal, with the program's reason (empty when it gives none)."""

    word: str
    reason: str = ""

    @property
    def outcome(self) -> Optional[Outcome]:
        """How the word ends a goal; None for accepted."""
        return WORDS[self.word]


class GoalStatuses:
    """The statuses of an answer from the cycle ``since`` on; ``faults`` holds what was no status."""

    def __init__(self, answer: FrozenSet[Symbol], since: int = 0) -> None:
        self._table, faults = _read(answer)
        self.faults = [text for cycle, text in faults if cycle is None or cycle >= since]

    def read(self, identifier: Symbol, cycle: int) -> Optional[Status]:
        """The goal's status in a cycle; of several the worst, with a reason. None if the program gives none."""
        found = map(_status_of, self._table.get((identifier, cycle), []))
        return min(found, key=lambda one: (list(WORDS).index(one.word), not one.reason, one.reason), default=None)


@lru_cache(maxsize=2)  # the same answer comes again and again while things go as planned
def _read(answer: FrozenSet[Symbol]) -> Tuple[_Table, List[Tuple[Optional[int], str]]]:
    """The words about each goal in each cycle, and what is no status, in order, with its cycle if it has one."""
    table: _Table = {}
    faults: List[Tuple[Optional[int], str]] = []
    for atom in answer:
        if not is_keyword(atom, STATUS):
            continue
        arguments = atom.arguments
        identifier, word, cycle = arguments if len(arguments) == 3 else (atom, atom, atom)
        number = cycle.number if cycle.type is SymbolType.Number else None
        if number is not None and word.type is SymbolType.Function and word.name in WORDS:
            table.setdefault((identifier, number), []).append(word)
        else:
            text = "'{}' is no status: write _status(Id,S,C), S one of {}".format(atom, ", ".join(WORDS))
            faults.append((number, text))
    return table, sorted(faults, key=lambda fault: fault[1])


def _status_of(word: Symbol) -> Status:
    return Status(word.name, ", ".join(text_of(argument) for argument in word.arguments))


_TEXTS = {
    Outcome.SUCCEEDED: "{} is met",
    Outcome.CANCELED: "{} is cancelled",
    Outcome.REJECTED: "the program rejects {}",
    Outcome.ABORTED: "the program gives {} up",
}


class Reading(NamedTuple):
    """An answer from which statuses are read in ``cycle``; those of the cycles from ``since`` on are not read yet.

    ``horizon`` is the answer's; ``speaks`` tells that the program has rules for ``_status``.
    """

    statuses: GoalStatuses
    plan: TaskPlan
    since: int
    cycle: int
    horizon: int
    speaks: bool


def update_status(goal: Goal, reading: Reading) -> None:
    """Bring a fed, live goal to the state that an answer gives it.

    The program's ``_status`` of the cycle decides, but for an end that it has told in a cycle whose answer was not
    read, as none was found then: a program may tell of an end only once, and of another request of the Id later. Where
    it says nothing of a goal, the goal is accepted, and met (or its cancellation done) as soon as no action is left in
    the plan; but a program that ``speaks`` of its goals, as it has rules for ``_status``, and has never said a word of
    this one does not know it, and the goal is rejected. Before the request's own cycle a program may say nothing yet:
    then acceptance and rejection are read at that cycle, as all else would be a prediction.
    """
    statuses, cycle = reading.statuses, reading.cycle
    first = goal.request_cycle or cycle
    status = _missed_end(goal, reading, first) or statuses.read(goal.identifier, cycle)
    if status is not None:
        goal.known = True
        _obey(goal, status)
    elif first > cycle:
        _update_early(goal, statuses.read(goal.identifier, first), reading.horizon >= first and not reading.speaks)
    elif reading.speaks and not goal.known:
        _end(goal, Outcome.REJECTED, "it has rules for _status, but none gives this goal a status")
    else:
        goal.accept()
        if not reading.plan.remaining(cycle):
            _end(goal, Outcome.CANCELED if goal.cancelling else Outcome.SUCCEEDED)


def _missed_end(goal: Goal, reading: Reading, first: int) -> Optional[Status]:
    """Return the end that was told in a cycle that was not read; before ``first`` it can only be a rejection."""
    for cycle in range(max(reading.since, first - 1), reading.cycle):
        status = reading.statuses.read(goal.identifier, cycle)
        outcome = None if status is None else status.outcome
        if outcome is Outcome.REJECTED or (outcome is not None and cycle >= first):
            return status
    return None


def _update_early(goal: Goal, status: Optional[Status], seen: bool) -> None:
    if status is None:
        if seen:
            goal.accept()
    elif status.outcome is Outcome.REJECTED:
        _obey(goal, status)
    elif status.outcome in (None, Outcome.SUCCEEDED):
        goal.remark = status.reason if status.outcome is None else ""
        goal.accept()


def _obey(goal: Goal, status: Status) -> None:
    if status.outcome is None:
        goal.remark = status.reason
        goal.accept()
    else:
        goal.refused = status.outcome is Outcome.REJECTED
        _end(goal, status.outcome, status.reason)


def _end(goal: Goal, outcome: Outcome, reason: str = "") -> None:
    text = _TEXTS[outcome].format(goal)
    goal.end(outcome, f"{text}: {reason}" if reason else text)
