"""The goals that wait to be fed: who is next, and who has to wait again when there is no plan for all in time.

The oldest goal comes first. As a plan may put one off as long as new ones come, no goal is overtaken without end: once
so many that came later have ended, no newer goal is fed until it has ended itself. Of many goals in one plan any may be
the last: so many may end before it at least. A goal for which alone there is no plan in time lets the others go before
it, and then has more time.
"""

import math
from typing import Any, Callable, Container, List, Optional, Sequence, Set

from rosoclingo.reasoning.goals import Goal

#: A goal that was in vain may have so many times the usual time for a search, a power of two.
MOST_PATIENCE = 8

#: Goals that the program is told of before it is known how long plans for them take.
FIRST = 8

#: The part of the time for a search that a plan with new goals is to take.
SHARE = 0.6

#: So many times as many goals as before there may be at the next time, and after a search took too long.
FASTER, SLOWLY = 4.0, 1.25

#: And so many times as many at least.
FEWER = 0.5


class GoalWindow:
    """The room for goals, sought as TCP seeks its window (Jacobson 1988), lest it be too much and have to be undone.

    Few goals begin, so that the first plan is there soon. With each plan for new goals there is room for so many that
    the next one takes a ``SHARE`` of the time for a search, as it grows with the square of their number: goals times
    steps. It is a large share, since a plan for some goals sends the robot past the places of others. Goals join in
    batches, as each time the program is ground anew: once there is no room left, none joins before half of it is free,
    there is room for all, or a plan for new goals has made room for half as many again, four at least. Where no plan
    was found in time there is room for the goals that were kept. ``most`` goals have room, 0 for any number;
    ``seconds`` is the time for a search, 0 for no limit: then there is room for any number as long as a plan is found.
    """

    def __init__(self, most: int = 0, seconds: float = 0.0) -> None:
        self.most, self._wanted = most, SHARE * seconds
        self._size = FIRST if seconds else None
        self._growth = FASTER
        self._full = False
        self._before: Optional[int] = None  # the size when a plan was last found in time
        self._lost = False  # none was found since then

    @property
    def size(self) -> Optional[int]:
        """How many goals there is room for, None for any number."""
        return min((one for one in (self._size, self.most) if one), default=None)

    def has_room(self, goals: int, waiting: int) -> bool:
        """Whether there is room beside so many ``goals`` for one of those that are ``waiting``."""
        size = self._size
        few = size is None or goals <= size // 2 or goals + waiting <= size
        self._full = size is not None and (goals >= size or (self._full and not few))
        return not self._full and not 0 < self.most <= goals

    def record(self) -> List[Any]:
        """Return what :meth:`restore_from` needs, plain values."""
        return [self._size, self._growth, self._full, self._before, self._lost]

    def restore_from(self, record: Sequence[Any]) -> None:
        """Go on from a record."""
        self._size, self._growth, self._full, self._before, self._lost = record

    def found(self, goals: int, seconds: Optional[float]) -> None:
        """A plan for so many goals was found in so many ``seconds``; None where none of the goals is new."""
        self._lost = False
        if self._size is None or seconds is None:
            return
        factor = math.sqrt(self._wanted / seconds) if self._wanted and seconds else self._growth
        size = math.ceil(goals * max(FEWER, min(factor, self._growth)))
        if factor < 1 or goals >= self._size:
            self._size = size
        self._full = self._full and self._size - goals < max(FIRST, goals) // 2

    def shrink(self, kept: int) -> None:
        """No plan was found in time; so many goals are kept."""
        self._before = self._before if self._lost else self._size
        self._lost, self._growth = True, SLOWLY
        self._size = max(1, kept)

    def restore(self) -> None:
        """It was a single goal that took too long, which says nothing of how many others there is room for."""
        self._size = self._before if self._lost else self._size


class GoalQueue:
    """Knows which of the ``live`` goals, oldest first, wait; all others are with the program, or on their way to it.

    At most ``at_once`` goals (0: any number) are with the program at a time. So many goals as ``overtaking_limit`` says
    may come later than a goal and end before it, or as many as were planned for together with it; 0 for any number. A
    search has so many ``seconds``, 0 for no limit.

    Attributes:
        now: the time in seconds of whatever clock.
        window: how many goals there is room for.
        stuck: how often in a row no plan was found in time, and no goal could be taken out.
        left: whether an arrival interrupted the last search.

    """

    def __init__(
        self, live: Callable[[], List[Goal]], at_once: int = 0, overtaking_limit: int = 0, seconds: float = 0.0
    ) -> None:
        self._live = live
        self._limit = overtaking_limit
        self._waiting: Set[Goal] = set()
        self.window = GoalWindow(at_once, seconds)
        self.stuck = 0
        self.left = False
        self._held: Set[Goal] = set()  # what could not be taken out
        self.now = 0.0

    @property
    def waiting(self) -> List[Goal]:
        """The goals that wait, oldest first."""
        return [goal for goal in self._live() if goal in self._waiting]

    @property
    def served(self) -> List[Goal]:
        """The goals that do not wait, oldest first."""
        return [goal for goal in self._live() if goal not in self._waiting]

    def waits(self, goal: Goal) -> bool:
        """Whether a goal waits."""
        return goal in self._waiting

    def put(self, goal: Goal) -> None:
        """A live goal waits."""
        self._waiting.add(goal)

    def remove(self, goal: Goal) -> None:
        """A goal waits no longer."""
        self._waiting.discard(goal)

    def record_of(self, goal: Goal) -> List[bool]:
        """Return, as plain values, whether a goal waits, and whether it is known to be in hand."""
        return [goal in self._waiting, goal in self._held]

    def restore_goal(self, goal: Goal, waits: bool, held: bool) -> None:
        """Go on with a goal from :meth:`record_of`."""
        for goals in [self._waiting] * waits + [self._held] * held:
            goals.add(goal)

    def record(self) -> List[Any]:
        """Return the rest as a plain value."""
        return [self.stuck, *self.window.record()]

    def restore(self, record: Sequence[Any]) -> None:
        """Go on from a record."""
        self.stuck = record[0]
        self.window.restore_from(record[1:])

    def overtake(self, goal: Goal) -> None:
        """A live goal ends: the older ones are overtaken, if it had its turn."""
        if goal not in self._waiting:
            live = self._live()
            for other in live[: live.index(goal)]:
                other.overtaken += 1

    @property
    def first(self) -> Optional[Goal]:
        """The goal that comes first, since it has been overtaken too often."""
        if not self._limit:
            return None
        due = (goal for goal in self._live() if goal.overtaken >= max(self._limit, goal.together))
        return next((goal for goal in due if not goal.cancelling and goal.rests_until <= self.now), None)

    def next(self) -> Optional[Goal]:
        """The goal whose turn it is to be fed, None where there is none."""
        if not self._waiting or self.tried is not None:
            return None
        if not self.window.has_room(len(self.served), len(self._waiting)):
            return None
        first, ready = self.first, self._ready
        fit = (goal for goal in ready if not goal.tries or goal is first)
        alone = min(ready, key=lambda goal: goal.tries) if ready and not self.served else None
        return next(fit, alone)

    @property
    def tried(self) -> Optional[Goal]:
        """A goal with the program for which alone no plan was found in time: no other one joins it."""
        return next((goal for goal in self._movable if goal.tries), None)

    @property
    def joinable(self) -> List[Goal]:
        """The waiting goals that may join all that are with the program at once, oldest first."""
        if self.tried is not None or not self.served:
            return []
        fit = [goal for goal in self._ready if not goal.tries]
        return fit[: max(0, self.window.most - len(self.served))] if self.window.most else fit

    @property
    def _ready(self) -> List[Goal]:
        """The waiting goals that may be fed, oldest first: none that is newer than the goal that comes first."""
        live, first = self._live(), self.first
        older = live if first is None else live[: live.index(first) + 1]
        return [goal for goal in older if goal in self._waiting and goal.rests_until <= self.now]

    def in_vain(self) -> List[Goal]:
        """The goals with the program, if each of them was in vain already and one waits that was less often."""
        goals = self._movable
        least = min((goal.tries for goal in goals), default=0)
        rivals = any(goal.tries < least for goal in self._ready)
        return goals if rivals and not self._held.issuperset(goals) else []

    def too_many(self, fresh: Sequence[Goal]) -> List[Goal]:
        """The goals that are to wait since no plan was found in time for all: the newest, at least half of them.

        Where ``fresh`` goals, which are new to the program, are less than half, only as many: there was a plan for the
        others. A single one of these is then tried alone. A single goal waits if another one can have its turn.
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

    @property
    def _movable(self) -> List[Goal]:
        return [goal for goal in self.served if not goal.cancelling]

    def found(self, seconds: Optional[float] = None) -> None:
        """There is a plan for all goals that are with the program; if some are new, it took so many ``seconds``."""
        planned, self.left = [goal for goal in self.served if goal.fed], False
        for goal in planned:
            goal.tries, goal.together = 0, max(goal.together, len(planned))
        self.go_on()
        self.window.found(len(planned), seconds)

    def stay(self, goals: Sequence[Goal]) -> None:
        """No goal can be taken out, nor can these, which are in hand: the next search has more time.

        A single goal that goes on since no other one has been in vain less often is not stuck: it was counted.
        """
        if goals or not self._movable:
            self.stuck += 1
        self._held.update(goals)

    def give_time(self) -> None:
        """Nothing of an update could be taken in time: the next search has more."""
        self.left = False
        self.stuck += 1

    def go_on(self) -> None:
        """There is something else to plan for."""
        self.stuck = 0
        self._held.clear()

    @property
    def patience(self) -> int:
        """How many times the usual time a search may take."""
        tries = min((goal.tries for goal in self._movable), default=0)
        return int(max(min(2**tries, MOST_PATIENCE), 2**self.stuck))

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
        hard = any(goal.tries for goal in self._movable) and self.first not in self._movable
        yields = hard and not (self.left or self.stuck)
        return "a goal has come" if new and yields else ""

    @property
    def unhurried(self) -> bool:
        """Whether a search may even go on until something arrives, since there is nothing else to plan for.

        Where only an update came too late, goals can still be taken out once it is there.
        """
        goals = self._movable
        nothing_else = self._held or not goals or (len(goals) == 1 and not self._ready)
        return self.patience > 1 and not self.in_vain() and bool(nothing_else)
