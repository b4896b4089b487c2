"""Admission: it decides which goals the program has, and how long the core searches for a plan.

The oldest goals are admitted first. They are admitted in batches, because the program is reground for each batch. The
size of a batch is chosen such that the expected planning time is ``SHARE`` of the time limit of a search. Planning time
grows with the square of the number of goals. The share is large because plans for several goals share their routes.
If actions can go on while others end, goals are admitted one by one: they are added to the plan in force.

Fairness: plans could defer a goal forever while new goals arrive. Once ``overtaking_limit`` newer goals have ended
before a goal, no newer goal is admitted until it has ended. In a plan for many goals any of them can be the last.
Therefore the limit of a goal is at least the number of goals in its plan.

If no plan is found in time, the newest goals are queued again. A goal without a plan in time even alone is planned for
alone, after all others. Its time limit doubles with each attempt.
"""

import math
from typing import Callable, Container, List, Optional, Sequence

from rosoclingo.reasoning.goals import Goal
from rosoclingo.reasoning.records import PersistentPart, fields
from rosoclingo.reasoning.settings import CoreSettings

#: Maximum patience for a goal without a plan in time, a power of two.
MOST_PATIENCE = 8

#: Goals in the first batch, before a planning time is known.
FIRST = 8

#: The same if actions can go on: the robots begin soon, and further goals are added while they act.
FEW = 4

#: The target time for planning with new goals, as a part of the time limit of a search.
SHARE = 0.6

#: Maximum growth of the room for goals by one plan, before and after a search took too long.
FASTER, SLOWLY = 4.0, 1.25

#: Maximum shrinkage of the room by one plan.
FEWER = 0.5

#: Maximum number of goals that join a running plan, relative to the number of goals that the program has.
MOST_JOINING = 1.5


class Admission(PersistentPart):
    """Decides which of the ``live`` goals, oldest first, are queued. All others are with the program or being fed.

    Without ``batches``, each goal is admitted as soon as there is room for it.

    Attributes:
        stuck: the number of searches in a row without a plan in time and without a goal to defer.
        interrupted: whether an arrival has interrupted the last search.

    """

    GROUP = "queue"
    FIELDS = fields(stuck=int, _room=Optional[int], _growth=float)

    def __init__(self, live: Callable[[], List[Goal]], settings: CoreSettings, batches: bool) -> None:
        self._live, self._batches = live, batches
        self._limit, self._most = settings.overtaking_limit, settings.goals_at_once
        self._wanted = SHARE * settings.search_timeout
        first = FIRST if batches else FEW
        self._room = self._first = first if settings.search_timeout else None
        self._growth = FASTER
        self.stuck, self.interrupted = 0, False

    @property
    def size(self) -> Optional[int]:
        """The maximum number of goals that the program can have at a time, None for no limit."""
        return min((one for one in (self._room, self._most) if one), default=None)

    @property
    def waiting(self) -> List[Goal]:
        """The queued goals, oldest first."""
        return [goal for goal in self._live() if goal.waits]

    @property
    def served(self) -> List[Goal]:
        """The goals that are not queued, oldest first."""
        return [goal for goal in self._live() if not goal.waits]

    def end(self, goal: Goal) -> None:
        """Record that a live goal ends; it has overtaken the older goals unless it was queued."""
        live = self._live()
        for other in live[: live.index(goal)] if not goal.waits else ():
            other.overtaken += 1

    # -- admitted goals

    @property
    def first(self) -> Optional[Goal]:
        """The goal that has priority because it has been overtaken too often, None for none."""
        due = (goal for goal in self._live() if 0 < self._limit <= goal.overtaken >= goal.together)
        return next((goal for goal in due if not goal.cancelling), None)

    @property
    def tried(self) -> Optional[Goal]:
        """A goal of the program that had no plan in time alone, None for none; no other goal joins it."""
        return next((goal for goal in self._movable if goal.tries), None)

    def admit(self) -> List[Goal]:
        """Return the queued goals that are admitted now."""
        served, ready, first = len(self.served), self._ready, self.first
        if self.tried is not None or not ready:
            return []
        fit = [goal for goal in ready if not goal.tries or goal is first]
        if not fit and not served:
            fit = [min(ready, key=lambda goal: goal.tries)]
        room = len(fit) if self._room is None else self._room - served
        if self._room is not None and self._batches and room < min(len(fit), math.ceil(self._room / 2)):
            return []  # wait for a full batch
        if self._most:
            room = min(room, self._most - served)
        alone = next((place for place, goal in enumerate(fit, 1) if goal.tries), len(fit))
        return fit[: max(0, min(room, alone))]

    @property
    def joinable(self) -> List[Goal]:
        """The queued goals that can join a running plan, oldest first, even if there is no room."""
        served = len(self.served)
        if self.tried is not None or not served:
            return []
        fit = [goal for goal in self._ready if not goal.tries][: math.ceil(MOST_JOINING * served)]
        return fit[: max(0, self._most - served)] if self._most else fit

    @property
    def _ready(self) -> List[Goal]:
        """The queued goals, oldest first, that are not newer than a goal with priority."""
        live, first = self._live(), self.first
        older = live if first is None else live[: live.index(first) + 1]
        return [goal for goal in older if goal.waits]

    @property
    def _movable(self) -> List[Goal]:
        return [goal for goal in self.served if not goal.cancelling]

    # -- after a search

    def plan_found(self, seconds: Optional[float] = None) -> None:
        """Record a plan for the program's goals, found in ``seconds``; None if none of the goals is new."""
        planned, self.interrupted = [goal for goal in self.served if goal.fed], False
        for goal in planned:
            goal.tries, goal.together = 0, max(goal.together, len(planned))
        self.reset_patience()
        if self._room is None or seconds is None:
            return
        factor = math.sqrt(self._wanted / seconds) if self._wanted and seconds else self._growth
        if factor < 1 or len(planned) >= self._room:
            self._room = math.ceil(len(planned) * max(FEWER, min(factor, self._growth)))

    def too_many(self, fresh: Sequence[Goal]) -> List[Goal]:
        """Return the goals to defer if no plan was found in time: the newest half.

        The ``fresh`` goals are new to the program. If they are fewer than half, only they are deferred, because there
        was a plan for the others. A single fresh goal is tried alone next. If the program has only one goal, it is
        deferred if another goal can take its place.
        """
        goals, self.interrupted = self._movable, False
        if len(goals) > 1:
            new = [goal for goal in goals if goal in fresh]
            for goal in new if len(new) == 1 else ():
                goal.tries += 1
            return goals[max(len(goals) // 2, len(goals) - len(new) if new else 0) :]
        for goal in goals:
            goal.tries += 1
            goal.overtaken = 0
        return self.yielding()

    def yielding(self) -> List[Goal]:
        """Return the program's goals if they should yield to a queued goal with fewer failed searches, else none."""
        goals = self._movable
        least = min((goal.tries for goal in goals), default=0)
        rivals = any(goal.tries < least for goal in self._ready)
        return goals if rivals and not all(goal.in_hand for goal in goals) else []

    def defer(self, goals: Sequence[Goal]) -> None:
        """Queue goals again. If none is left, the room for goals is reset: one slow goal says nothing about others."""
        for goal in goals:
            goal.waits = True
        self.limit(len(self.served))
        if not self.served:
            self._room = self._first
        self.reset_patience()

    def limit(self, number: int) -> None:
        """Limit the room to ``number`` goals after a search or an update took too long."""
        self._room, self._growth = max(1, number), SLOWLY

    def keep(self, goals: Sequence[Goal]) -> None:
        """Record that no goal can be deferred, and that ``goals`` are in hand: the next search has more time."""
        self.stuck += bool(goals or not self._movable)  # the tries of a single goal are counted
        for goal in goals:
            goal.in_hand = True

    def give_time(self) -> None:
        """Record that the solver accepted no update in time: the next search has more time."""
        self.interrupted = False
        self.stuck += 1

    def reset_patience(self) -> None:
        """Record that the next search is for other goals, and reset its time limit."""
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
        """Whether a search can continue until an arrival, because there are no other goals to plan for."""
        nothing_else = any(goal.in_hand for goal in self._live()) or len(self._movable) + len(self._ready) <= 1
        return self.patience > 1 and not self.yielding() and nothing_else

    def why_interrupted(self, cancelled: Container[str], new: bool) -> str:
        """Return why an arrival interrupts the search, empty if it does not.

        Arrivals are cancels of the goals with the keys ``cancelled``, or a ``new`` goal. The cancel of an admitted goal
        interrupts the search. A new goal does so if the search is for a goal without priority that found no plan alone
        before. No arrival interrupts the next search, unless all its goals are cancelled.
        """
        unwanted = [goal for goal in self.served if goal.cancelling or goal.key in cancelled]
        if self.interrupted and len(unwanted) < len(self.served):
            return ""
        if any(goal.key in cancelled for goal in unwanted):
            return "a goal was cancelled"
        yields = self.tried is not None and self.first not in self._movable and not (self.interrupted or self.stuck)
        return "a goal has arrived" if new and yields else ""
