"""Drives a core whose searches time out above a number of goals, or at random."""

from random import Random

from core_driver import Driver

from rosoclingo.oclingo.progression.updates import Volatile
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.reasoning.settings import CoreSettings
from rosoclingo.reasoning.stream_planner import Halt

#: Errands do(What,Id), one a cycle, the oldest first except that far ones come last; never is impossible. Known while
#: open.
ERRANDS = """
#external _request/2. #external _return/3.
#program cumulative(t).
open(W,I,t) :- _request(do(W,I),t+1).
open(W,I,t) :- open(W,I,t-1), not done(I,t-1), not _request(cancel(I),t).
{ _action_lib(W,I,t) : open(W,I,t), W != never } 1.
:- _action_lib(walk,I,t), open(walk,J,t), J < I.
:- _action_lib(far,I,t), open(walk,J,t).
failed(I,t) :- _action_lib(W,I,t), _return(W,V,t), V != I.
done(I,t) :- _action_lib(W,I,t), not failed(I,t).
_status(I,accepted,t) :- open(W,I,t).
_status(I,succeeded,t) :- done(I,t-1).
_status(I,canceled,t) :- _request(cancel(I),t).
#program volatile(t).
:- open(W,I,t), not done(I,t).
#program base.
#show _action_lib/3. #show _status/3.
"""


class BusySolver(PlanSolver):
    """Searches until ``ends`` says stop for an update: True ends the search at once."""

    ends = staticmethod(lambda update: False)
    needed = staticmethod(lambda: 0.0)

    def update(self, update, stopped=None):
        """Accept the update; it is in force, whether or not there is time for a search."""
        if self.ends(update) and not stopped():
            raise AssertionError("nobody ends the search")
        result = super().update(update, stopped)
        result.statistics["needed"] = self.needed()
        return result


class BusyDriver(Driver):
    """A driver of a core that can plan in time for at most ``most`` goals, and sometimes for none at all.

    The validity of the last plan is known at once. ``seconds`` gives the duration of planning by the number of goals.
    """

    def __init__(self, text=ERRANDS, settings=None, program=None, most=3, chance=0.0, plan_time=None):
        self.most, self.chance, self.random = most, chance, Random(1)
        self.plan_time = plan_time
        self.searches, self.cut, self.seconds = [], False, lambda goals: 0.0
        settings = settings or CoreSettings(horizon_limit=30)
        super().__init__(text, settings, program, self.make_solver, lambda: self.look, start=False, events=10**6)
        self.begin()

    def make_solver(self, program):
        """Make a solver that asks this driver."""
        solver = BusySolver(program, plan_time=self.plan_time)
        solver.ends, solver.needed = self.ends, lambda: self.seconds(len(self.core.queue.served))
        return solver

    def look(self):
        """End the search if it has too many goals."""
        return Halt("the test") if self.cut else None

    def ends(self, update):
        """Return whether the search has too many goals, not counting those that the update withdraws."""
        text = str(update)
        goals = [goal for goal in self.core.queue.served if not self.left_out(goal, text)]
        self.searches.append(len(goals))
        patience = self.core.queue.patience
        much = len(goals) > self.most * patience or self.random.random() < self.chance
        self.cut = much and bool(goals) and not any(isinstance(item, Volatile) for item in update.items)
        return self.cut

    @staticmethod
    def left_out(goal, text):
        """Return whether an update cancels a goal or withdraws its request."""
        return f"_request(cancel({goal.identifier})," in text or f"#withdraw _request({goal.term}," in text

    def run(self):
        """Advance until the core waits."""
        for _ in range(2000):
            self.core.poll(self.now)
            if not self.core.advance(self.now):
                return self
        raise AssertionError("the core does not come to rest")

    def waits(self, key):
        """Return the reasons for which a goal was queued, each time that it was."""
        return [one.waits for one in self.feedback(key) if one.waits]

    def order(self):
        """Return the keys of all goals in the order in which they ended."""
        return [one.key for one in self.journal.events if getattr(one, "outcome", None) is not None]
