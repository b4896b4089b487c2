"""The status of goals, read from the ``_status(Id,S,C)`` atoms of an answer.

``S`` is accepted, rejected, succeeded, canceled or aborted. It can have a text as its argument, as in
``accepted("waits for the lift")`` and ``aborted(("package ",3," is not at ",office2))``.
"""

from functools import lru_cache
from typing import Dict, FrozenSet, List, NamedTuple, Optional, Tuple

from clingo import Symbol, SymbolType

from rosoclingo.reasoning.action_extractor import TaskPlan
from rosoclingo.reasoning.explanations import text_of
from rosoclingo.reasoning.goals import Goal, Outcome
from rosoclingo.reasoning.keywords import STATUS, atoms_of

#: The words of ``_status``, worst first, with the outcome of the goal (None: the goal continues).
WORDS: Dict[str, Optional[Outcome]] = {
    "aborted": Outcome.ABORTED,
    "rejected": Outcome.REJECTED,
    "canceled": Outcome.CANCELED,
    "succeeded": Outcome.SUCCEEDED,
    "accepted": None,
}


_Table = Dict[Tuple[Symbol, int], List[Symbol]]


class Status(NamedTuple):
    """The status of a goal, with the program's reason, empty for none."""

    word: str
    reason: str = ""

    @property
    def outcome(self) -> Optional[Outcome]:
        """The outcome of the goal; None if it is accepted."""
        return WORDS[self.word]


@lru_cache(maxsize=2)  # the answer stays the same while all actions succeed
def _read(answer: FrozenSet[Symbol]) -> Tuple[_Table, List[Tuple[Optional[int], str]]]:
    """Return the words by goal and cycle, and sorted messages about malformed statuses, each with its cycle if any."""
    table: _Table = {}
    faults: List[Tuple[Optional[int], str]] = []
    for atom in atoms_of(answer, STATUS):
        arguments = atom.arguments
        identifier, word, cycle = arguments if len(arguments) == 3 else (atom, atom, atom)
        number = cycle.number if cycle.type is SymbolType.Number else None
        if number is not None and word.type is SymbolType.Function and word.name in WORDS:
            table.setdefault((identifier, number), []).append(word)
        else:
            text = "'{}' is not a status: write _status(Id,S,C), where S is one of {}".format(atom, ", ".join(WORDS))
            faults.append((number, text))
    return table, sorted(faults, key=lambda fault: fault[1])


_TEXTS = {
    Outcome.SUCCEEDED: "{} is met",
    Outcome.CANCELED: "{} is cancelled",
    Outcome.REJECTED: "the program rejects {}",
    Outcome.ABORTED: "the program aborts {}",
}


class Reading(NamedTuple):
    """An answer whose statuses are read in ``cycle``.

    Attributes:
        answer: the answer.
        plan: its task plan.
        since: the first cycle whose statuses have not been read yet.
        cycle: the current cycle.
        horizon: the horizon of the answer.
        has_rules: whether the program has rules for ``_status``.

    """

    answer: FrozenSet[Symbol]
    plan: TaskPlan
    since: int
    cycle: int
    horizon: int
    has_rules: bool

    @property
    def faults(self) -> List[str]:
        """Messages about malformed actions, and about malformed statuses from the current cycle on."""
        statuses = (text for cycle, text in _read(self.answer)[1] if cycle is None or cycle >= self.cycle)
        return [*self.plan.faults, *statuses]

    def status(self, identifier: Symbol, cycle: int) -> Optional[Status]:
        """Return the worst status of a goal in a cycle, preferably with a reason; None if there is none."""
        words = _read(self.answer)[0].get((identifier, cycle), [])
        found = (Status(word.name, ", ".join(map(text_of, word.arguments))) for word in words)
        return min(found, key=lambda one: (list(WORDS).index(one.word), not one.reason, one.reason), default=None)


def update_status(goal: Goal, reading: Reading) -> None:
    """Update the state of a live goal that the program has.

    The ``_status`` of the current cycle decides, unless the program reported an end in an earlier cycle without an
    answer. Such an end takes precedence, because a program can report it only once and then reuse the identifier.

    Without a status, the goal is accepted, and it has succeeded (or is cancelled) once the plan has no actions left. If
    the program has rules for ``_status`` but never gave this goal a status, the goal is rejected.

    Before the cycle of the request, only acceptance and rejection are read, from the status in that cycle. All other
    statuses in it are predictions.
    """
    cycle = reading.cycle
    first = goal.request_cycle or cycle
    status = _missed_end(goal, reading, first) or reading.status(goal.identifier, cycle)
    if status is not None:
        goal.known = True
        _obey(goal, status)
    elif first > cycle:
        _update_early(goal, reading.status(goal.identifier, first), reading.horizon >= first and not reading.has_rules)
    elif reading.has_rules and not goal.known:
        _end(goal, Outcome.REJECTED, "it has rules for _status, but none gives this goal a status")
    else:
        goal.accept()
        if not reading.plan.remaining(cycle):
            _end(goal, Outcome.CANCELED if goal.cancelling else Outcome.SUCCEEDED)


def _missed_end(goal: Goal, reading: Reading, first: int) -> Optional[Status]:
    """Return the end that the program reported in an unread cycle; before ``first``, only a rejection counts."""
    for cycle in range(max(reading.since, first - 1), reading.cycle):
        status = reading.status(goal.identifier, cycle)
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
