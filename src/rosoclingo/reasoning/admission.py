"""Admission: which of the live goals the program has, and how long the core searches for a plan with them.

The oldest goals are admitted first, in batches, since the program is reground each time. A batch has as many goals as
a plan is expected for within ``SHARE`` of the time limit of a search; planning time grows with the square of the
number of goals, goals times steps. The share is large since a plan for some goals passes the places of others.

Fairness: a plan can defer a goal as long as new ones come. Once ``overtaking_limit`` newer goals have ended before a
goal, no newer goal is admitted until it has ended. In a plan for many goals any can be the last, so that as many as
were planned for together may end before it.

If no plan is found in time, the newest goals wait again. A goal without a plan in time even alone is planned for
alone, after all others, with twice the time each time.
"""

import math
from typing import Callable, Container, List, Optional, Sequence

from rosoclingo.reasoning.goals import Goal
from rosoclingo.reasoning.records import Record

#: Limit of the patience for a goal without a plan in time, a power of two.
MOST_PATIENCE = 8

#: Goals in the first batch, before a planning time is known.
FIRST = 8

#: The part of the time limit of a search that a plan with new goals is to take.
SHARE = 0.6

#: Limits of the growth of the room for goals with one plan, before and after a search took too long.
FASTER, SLOWLY = 4.0, 1.25

#: Limit of the shrinkage of the room with one plan.
FEWER = 0.5

#: Limit of the goals that join a plan in force, relative to the goals that the program has.
MOST_JOINING = 1.5


class Admission:
    """Decides which of the ``live`` goals, oldest first, wait. The program has all others, or they are on their way.

    The program has at most ``at_once`` goals at a time, and a search is to take ``seconds``; 0 for no limit.

    Attributes:
        now: the time in seconds.
        stuck: the number of searches in a row without a plan in time and without a goal to defer.
        left: whether an arrival interrupted the last search.

    """

    def __init__(
        self, live: Callable[[], List[Goal]], at_once: int = 0, overtaking_limit: int = 0, seconds: float = 0.0
    ) -> None:
        self._live, self._limit, self._most, self._wanted = live, overtaking_limit, at_once, SHARE * seconds
        self._room = self._first = FIRST if seconds else None
        self._growth = FASTER
        self.now, self.stuck, self.left = 0.0, 0, False

    @property
    def size(self) -> Optional[int]:
        """The number of goals that the program can have at a time, None for no limit."""
        return min((one for one in (self._room, self._most) if one), default=None)

    @property
    def waiting(self) -> List[Goal]:
        """The goals that wait, oldest first."""
        return [goal for goal in self._live() if goal.waits]

    @property
    def served(self) -> List[Goal]:
        """The goals that do not wait, oldest first."""
        return [goal for goal in self._live() if not goal.waits]

    def end(self, goal: Goal) -> None:
        """Record that a live goal ends; it has overtaken the older ones unless it waited."""
        live = self._live()
        for other in live[: live.index(goal)] if not goal.waits else ():
            other.overtaken += 1

    # -- who is admitted

    @property
    def first(self) -> Optional[Goal]:
        """The goal that comes first, since it has been overtaken too often."""
        due = (goal for goal in self._live() if 0 < self._limit <= goal.overtaken >= goal.together)
        return next((goal for goal in due if not goal.cancelling and goal.rests_until <= self.now), None)

    @property
    def tried(self) -> Optional[Goal]:
        """A goal with the program that had no plan in time alone: no other one joins it."""
        return next((goal for goal in self._movable if goal.tries), None)

    def admit(self) -> List[Goal]:
        """Return the waiting goals whose turn it is."""
        served, ready, first = len(self.served), self._ready, self.first
        if self.tried is not None or not ready:
            return []
        fit = [goal for goal in ready if not goal.tries or goal is first]
        if not fit and not served:
            fit = [min(ready, key=lambda goal: goal.tries)]
        room = len(fit) if self._room is None else self._room - served
        if self._room is not None and room < min(len(fit), math.ceil(self._room / 2)):
            return []  # until they are a batch
        if self._most:
            room = min(room, self._most - served)
        alone = next((place for place, goal in enumerate(fit, 1) if goal.tries), len(fit))
        return fit[: max(0, min(room, alone))]

    @property
    def joinable(self) -> List[Goal]:
        """The waiting goals that can join a plan in force at once, oldest first, whatever room there is."""
        served = len(self.served)
        if self.tried is not None or not served:
            return []
        fit = [goal for goal in self._ready if not goal.tries][: math.ceil(MOST_JOINING * served)]
        return fit[: max(0, self._most - served)] if self._most else fit

    @property
    def _ready(self) -> List[Goal]:
        """The waiting goals, oldest first, that do not rest and are not newer than the goal that comes first."""
        live, first = self._live(), self.first
        older = live if first is None else live[: live.index(first) + 1]
        return [goal for goal in older if goal.waits and goal.rests_until <= self.now]

    @property
    def _movable(self) -> List[Goal]:
        return [goal for goal in self.served if not goal.cancelling]

    # -- after a search

    def found(self, seconds: Optional[float] = None) -> None:
        """Record a plan for all goals of the program; it took ``seconds``, None if none of them is new."""
        planned, self.left = [goal for goal in self.served if goal.fed], False
        for goal in planned:
            goal.tries, goal.together = 0, max(goal.together, len(planned))
        self.go_on()
        if self._room is None or seconds is None:
            return
        factor = math.sqrt(self._wanted / seconds) if self._wanted and seconds else self._growth
        if factor < 1 or len(planned) >= self._room:
            self._room = math.ceil(len(planned) * max(FEWER, min(factor, self._growth)))

    def too_many(self, fresh: Sequence[Goal]) -> List[Goal]:
        """Return the goals to defer, as no plan was found in time: the newest, at least half of them.

        If the ``fresh`` goals, which are new to the program, are fewer, only these: there was a plan for the others. A
        single fresh goal is tried alone next. A single goal is deferred if another one can have its turn.
        """
        goals, self.left = self._movable, False
        if len(goals) > 1:
            new = [goal for goal in goals if goal in fresh]
            for goal in new if len(new) == 1 else ():
                goal.tries += 1
            return goals[max(len(goals) // 2, len(goals) - len(new) if new else 0) :]
        for goal in goals:
            goal.tries += 1
            goal.overtaken = 0
        return self.in_vain()

    def in_vain(self) -> List[Goal]:
        """Return the goals of the program, if each was in vain already and one waits that was less often."""
        goals = self._movable
        least = min((goal.tries for goal in goals), default=0)
        rivals = any(goal.tries < least for goal in self._ready)
        return goals if rivals and not all(goal.in_hand for goal in goals) else []

    def defer(self, goals: Sequence[Goal]) -> None:
        """Let goals wait again; a single one that took too long says nothing of the room for others."""
        for goal in goals:
            goal.waits = True
        self.limit(len(self.served))
        if not self.served:
            self._room = self._first
        self.go_on()

    def limit(self, number: int) -> None:
        """Record that there was no plan in time, or no update; there is room for ``number`` goals."""
        self._room, self._growth = max(1, number), SLOWLY

    def stay(self, goals: Sequence[Goal]) -> None:
        """Record that no goal can be deferred, nor these, which are in hand: the next search has more time."""
        self.stuck += bool(goals or not self._movable)  # the tries of a single goal are counted
        for goal in goals:
            goal.in_hand = True

    def give_time(self) -> None:
        """Record that the solver accepted no update in time: the next search has more."""
        self.left = False
        self.stuck += 1

    def go_on(self) -> None:
        """Record that there is something else to plan for."""
        self.stuck = 0
        for goal in self._live():
            goal.in_hand = False

    # -- limits of a search

    @property
    def patience(self) -> int:
        """The factor of the time limit of a search."""
        tries = min((goal.tries for goal in self._movable), default=0)
        return int(max(min(2**tries, MOST_PATIENCE), 2**self.stuck))

    @property
    def unhurried(self) -> bool:
        """Whether a search can go on until something arrives, since there is nothing else to plan for."""
        nothing_else = any(goal.in_hand for goal in self._live()) or len(self._movable) + len(self._ready) <= 1
        return self.patience > 1 and not self.in_vain() and nothing_else

    def why_left(self, cancelled: Container[str], new: bool) -> str:
        """Return why a search is interrupted, empty if it is not: cancels of goals of these keys, or a ``new`` goal.

        The cancel of a goal that the program has, or is to have, interrupts it. So does a new goal if the search is for
        a goal that found no plan alone before, and that does not come first. No arrival interrupts the next search,
        unless all its goals are cancelled.
        """
        unwanted = [goal for goal in self.served if goal.cancelling or goal.key in cancelled]
        if self.left and len(unwanted) < len(self.served):
            return ""
        if any(goal.key in cancelled for goal in unwanted):
            return "a goal was cancelled"
        yields = self.tried is not None and self.first not in self._movable and not (self.left or self.stuck)
        return "a goal has come" if new and yields else ""

    # -- what is written down

    def record(self) -> Record:
        """Return the state as plain values."""
        return {"stuck": self.stuck, "room": self._room, "growth": self._growth}

    def restore(self, record: Record) -> None:
        """Restore from :meth:`record`."""
        self.stuck, self._room, self._growth = record["stuck"], record["room"], record["growth"]
