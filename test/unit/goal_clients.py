"""Clients of a goal manager without a solver: their requests, the updates to the program, and the replies."""

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.reasoning.events import Announcer, GoalProgress
from rosoclingo.reasoning.goal_manager import GoalManager
from rosoclingo.reasoning.goals import Outcome
from rosoclingo.reasoning.input_feeder import InputFeeder
from rosoclingo.reasoning.settings import CoreSettings

#: A program that reads every request.
HEARING = "#external _request/2. #program cumulative(t). asked(G,t) :- _request(G,t)."


class Clients:
    """A goal manager with its feeder, and its reports. Goal ``go(N)`` has the key ``gN``."""

    def __init__(self, text=HEARING, at_once=0, overtaking_limit=0, search_timeout=0.0):
        self.feeder, self.reports, self.step = InputFeeder(), [], 0
        program = ReactiveProgram.from_text(text)
        settings = CoreSettings(goals_at_once=at_once, overtaking_limit=overtaking_limit, search_timeout=search_timeout)
        announce = Announcer(self.reports.append, lambda: 7, program.time_position)
        self.goals = GoalManager(program, self.feeder, announce, settings)

    # -- events, as words of a script; goals are numbers, or ranges such as 3-8

    def add(self, *goals):
        for number in numbers_of(goals):
            self.goals.add(f"g{number}", f"go({number})")
        return self

    def feed(self, step=None):
        """Accept the update of a step, or of the next one; return its text."""
        return [str(item).rstrip(".") for item in self._taken(step).update.items]

    def leave_out(self):
        """Accept the next update without the new goals, for which the solver has no time."""
        self.goals.update_accepted(self._taken().goals, ())
        return self

    def _taken(self, step=None):
        self.step = self.step + 1 if step is None else step
        batch = self.feeder.next_update(self.step)
        self.feeder.update_accepted(batch)
        return batch

    def plan(self, seconds=0.0):
        """Accept the next update and find a plan for all its goals, within a number of seconds."""
        self._taken()
        self.goals.plan_found(None if seconds == "old" else float(seconds))
        return self

    def no_plan(self, *words):
        """Find no plan in time if the goals after ``new`` are new; expect the goals before it to be queued."""
        place = words.index("new") if "new" in words else len(words)
        chosen = self.goals.queue.too_many([self.goal(number) for number in numbers_of(words[place + 1 :])])
        assert numbers(chosen) == numbers_of(words[:place])
        if chosen:
            self.goals.defer(chosen, "too much", self.step)
        else:
            self.goals.queue.keep(chosen)

    def put_off(self, *goals):
        """Defer these goals."""
        self.goals.defer([self.goal(number) for number in numbers_of(goals)], "too much", self.step)
        return self

    def cancel(self, *goals):
        """Cancel these goals."""
        for number in numbers_of(goals):
            self.goals.cancel(f"g{number}")
        return self

    def end(self, *goals):
        """End these goals by themselves."""
        for number in numbers_of(goals):
            self.goal(number).end(Outcome.SUCCEEDED, "is done")
        return self

    def tick(self, now):
        self.goals.tick(float(now))
        self.feeder.tick(float(now))

    def stay(self, *goals):
        """Bar these goals, or all, from deferral."""
        self.goals.queue.keep([self.goal(number) for number in numbers_of(goals)] if goals else self.goals.live)

    # -- expectations, as words of a script

    def has(self, *goals):
        """Expect the program to have these goals."""
        assert self.served == numbers_of(goals)

    def lacks(self, *goals):
        """Expect these goals to be queued."""
        assert self.waiting == numbers_of(goals)

    def patience(self, factor, unhurried=None):
        """Expect this factor of a search's time, and ``unhurried`` or ``hurried``."""
        queue = self.goals.queue
        assert queue.patience == int(factor)
        assert unhurried is None or queue.unhurried == (unhurried == "unhurried")

    def pauses(self, answer):
        """Expect the feeder to pause although goals wait to be fed: ``yes`` or ``no``."""
        assert self.feeder.pending == (answer == "no")

    def in_vain(self, *goals):
        """Expect these goals to give way to another."""
        assert numbers(self.goals.queue.yielding()) == numbers_of(goals)

    def tells(self, number, *words):
        """Expect one report, in these words, of why a goal is queued; none without words."""
        assert self.waits(int(number)) == ([" ".join(words)] if words else [])

    def goal(self, number):
        return next(goal for goal in self.goals.live if goal.key == f"g{number}")

    def waits(self, number):
        """Return the reasons for which a goal was queued, each time that it was."""
        return [one.waits for one in self.reports if isinstance(one, GoalProgress) and one.key == f"g{number}"]

    @property
    def served(self):
        return numbers(self.goals.queue.served)

    @property
    def waiting(self):
        return numbers(self.goals.queue.waiting)


def crowd(goals, **limits):
    """Return clients of goals 1, 2 and so on, which the program knows as far as the window permits."""
    clients = Clients(**limits).add(*range(1, goals + 1))
    clients.feed()
    return clients


def numbers(goals):
    """Return the numbers of goals."""
    return [int(goal.key[1:]) for goal in goals]


def numbers_of(words):
    """Return the numbers of words such as 3 and 5-8."""
    ends = [list(map(int, str(word).split("-"))) for word in words]
    return [number for end in ends for number in range(end[0], end[-1] + 1)]
