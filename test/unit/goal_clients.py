"""Clients of a goal manager without a solver: what they ask for, what reaches the program, and what they are told."""

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.reasoning.events import GoalChanged, GoalProgress
from rosoclingo.reasoning.goal_manager import GoalManager
from rosoclingo.reasoning.goals import Outcome
from rosoclingo.reasoning.input_feeder import InputFeeder
from rosoclingo.reasoning.settings import CoreSettings

#: A program that hears every request.
HEARING = "#external _request/2. #program cumulative(t). asked(G,t) :- _request(G,t)."


class Clients:
    """A goal manager with its feeder, and what was told. Goal ``go(N)`` has the key ``gN``."""

    def __init__(self, text=HEARING, at_once=0, overtaking_limit=0, search_timeout=0.0):
        self.feeder, self.told, self.step = InputFeeder(), [], 0
        program = ReactiveProgram.from_text(text)
        settings = CoreSettings(goals_at_once=at_once, overtaking_limit=overtaking_limit, search_timeout=search_timeout)
        self.goals = GoalManager(program, self.feeder, self.told.append, lambda: 7, settings)

    def add(self, *numbers):
        for number in numbers:
            self.goals.add(f"g{number}", f"go({number})")
        return self

    def feed(self, step=None):
        """The update of a step, or of the next one, reaches the program; what it says."""
        return [str(item).rstrip(".") for item in self._taken(step).update.items]

    def leave_out(self):
        """The next update reaches the program without the new goals: the solver cannot take them in time."""
        batch = self._taken()
        self.goals.taken(batch.goals, ())
        return self

    def _taken(self, step=None):
        self.step = self.step + 1 if step is None else step
        batch = self.feeder.next_update(self.step)
        self.feeder.taken(batch)
        return batch

    def plan(self, seconds=0.0):
        """The next update reaches the program, and a plan is found for all its goals, in so many seconds."""
        self._taken()
        self.goals.plan_found(seconds)
        return self

    def no_plan(self, *fresh):
        """No plan is found in time, with these goals new: those that are to wait do, none is in hand. Their numbers."""
        chosen = self.goals.queue.too_many([self.goal(number) for number in fresh])
        if chosen:
            self.goals.defer(chosen, "too much", self.step)
        else:
            self.goals.queue.stay(chosen)
        return numbers(chosen)

    def put_off(self, *chosen):
        """These goals wait."""
        self.goals.defer([self.goal(number) for number in chosen], "too much", self.step)
        return self

    def cancel(self, *chosen):
        """These goals are cancelled."""
        for number in chosen:
            self.goals.cancel(f"g{number}")
        return self

    def end(self, *chosen):
        """These goals end by themselves."""
        for number in chosen:
            self.goal(number).end(Outcome.SUCCEEDED, "is done")
        return self

    def goal(self, number):
        return next(goal for goal in self.goals.live if goal.key == f"g{number}")

    def waits(self, number):
        """Why a goal had to wait, each time that it had."""
        return [one.waits for one in self.told if isinstance(one, GoalProgress) and one.key == f"g{number}"]

    @property
    def served(self):
        return numbers(self.goals.queue.served)

    @property
    def waiting(self):
        return numbers(self.goals.queue.waiting)

    @property
    def live(self):
        return [goal.key for goal in self.goals.live]

    @property
    def fed(self):
        return [goal.key for goal in self.goals.fed]

    def ends(self):
        return [(one.key, one.outcome) for one in self.told if isinstance(one, GoalChanged) and one.outcome is not None]


def numbers(goals):
    """The numbers of goals."""
    return [int(goal.key[1:]) for goal in goals]
