"""Searches that are ended: by what comes meanwhile, by time, by the loss of the solver's process."""

from core_driver import ERRANDS, Driver, FaultyDriver, Leaving, shortest
from stream_replay import check_replay

from rosoclingo.oclingo import DroppedError, NotReadyError
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.reasoning import Halt
from rosoclingo.reasoning.input_feeder import PAUSE


class Interrupted(FaultyDriver):
    """A driver whose searches end as soon as ``halt`` is set, and are dropped where ``drops`` says so."""

    def __init__(self, text=ERRANDS, start=True):
        self.halt, self.drops = None, lambda update: False
        super().__init__(text, watch=lambda: lambda: self.halt, start=start)

    def fault(self, update):
        return DroppedError("ended by the test") if self.drops(update) else None

    def once(self):
        """Advance once, with a search that is left for what comes."""
        self.halt = Halt("the test", disturbed=True)
        assert self.core.advance(self.now)
        self.halt = None
        return self


def test_a_search_that_is_left_is_made_again():
    driver = Interrupted()
    driver.core.add_goal("a", "do(walk,1)")
    driver.once()
    assert driver.states("a") == []
    assert driver.awaited == []
    assert driver.run().awaited == ["_action_lib(walk,1,2)"]
    assert [text.split()[1] for text in driver.journal.updates] == ["1.", "2."]
    assert driver.finish().states("a")[-1] == "succeeded"
    assert driver.journal.problems == ["the search was left: the test"]


def test_a_search_that_is_left_is_made_again_where_nothing_else_asks_for_it():
    driver = Interrupted().goal("a", "do(walk,1)")
    driver.core.receive("interface", ["_return(walk,failed,1)"])
    driver.once()
    assert driver.core.plan.actions == ()
    assert driver.run().awaited == ["_action_lib(walk,1,3)"]


def test_a_cancel_that_ends_a_search_is_fed_with_the_next_update():
    driver = Interrupted()
    driver.core.add_goal("a", "do(walk,1)")
    driver.once().cancel("a")
    assert driver.states("a")[-1] == "preempted"
    assert "_request(cancel(1),2)." in driver.journal.updates[-1]
    assert driver.goal("b", "do(run,2)").finish().states("b")[-1] == "succeeded"


def test_an_update_that_was_dropped_for_what_came_comes_with_the_next_one():
    driver = Interrupted().goal("a", "do(walk,1)")
    driver.core.receive("interface", ["_return(walk,1,1)", "_seen(sun)"])
    driver.core.add_goal("b", "do(run,2)")
    driver.drops = lambda update: True
    driver.once()
    driver.drops = lambda update: False
    assert len(driver.journal.updates) == 1, "what is not in force is not told"
    driver.run()
    assert [text.split()[1] for text in driver.journal.updates] == ["1.", "2."]
    assert driver.journal.updates[1].split() == [
        *["#step", "2.", ":-", "not", "_action_lib(walk,1,1).", "_request(do(run,2),3)."],
        *["_return(walk,1,1).", "_seen(sun).", "#end", "step."],
    ]
    assert driver.awaited == ["_action_lib(run,2,2)"]
    driver.finish()
    assert driver.states("a")[-1] == driver.states("b")[-1] == "succeeded"


def test_a_goal_that_is_cancelled_in_a_dropped_update_is_forgotten():
    driver = Interrupted()
    driver.core.add_goal("a", "do(walk,1)")
    driver.core.add_goal("b", "do(run,2)")
    driver.drops = lambda update: True
    driver.once()
    driver.drops = lambda update: False
    driver.cancel("a")
    assert driver.states("a") == ["recalling", "recalled"]
    assert "walk" not in driver.journal.updates[-1]
    assert driver.finish().states("b")[-1] == "succeeded"


def test_time_does_not_count_while_the_solver_is_made_ready():
    waits, looks = [], iter([Halt("too long")] * 3)

    class Late(PlanSolver):
        def update(self, update, stopped=None):
            if len(waits) < 3:
                waits.append(stopped())
                raise NotReadyError("not ready")
            return super().update(update, stopped)

    driver = Driver(solver=lambda program: shortest(program, Late), watch=lambda: lambda: next(looks, None))
    assert waits == [True] * 3
    assert driver.goal("a", "do(walk,1)").finish().states("a")[-1] == "succeeded"
    assert driver.journal.problems == []


def test_the_first_search_that_was_left_is_made_again():
    text = "#program cumulative(t).\n_action_lib(wake,up,t) :- t = 2.\n#program volatile(t).\n:- t < 2.\n"
    driver = Interrupted(text + "#external _request/2. #external _return/3.", start=False)
    driver.halt = Halt("the test", disturbed=True)
    driver.core.start()
    driver.halt = None
    assert driver.run().awaited == ["_action_lib(wake,up,2)"]


def test_the_first_search_may_be_dropped():
    driver = Interrupted(start=False)
    driver.drops = lambda update: True
    driver.core.start()
    assert driver.journal.problems == ["the program can't be solved before any request: ended by the test"]
    driver.drops = lambda update: False
    assert driver.goal("a", "do(walk,1)").finish().states("a")[-1] == "succeeded"


def test_recovery_that_is_left_is_made_again_where_nothing_else_asks_for_it():
    text = ERRANDS + "#program volatile(t).\n:- _seen(rain), not _request(cancel(1),_).\n"
    driver = Driver(text, watch=Leaving(4))
    driver.goal("a", "do(walk,1)").core.receive("interface", ["_return(walk,failed,1)", "_seen(rain)"])
    assert driver.core.advance(1.0)
    assert driver.journal.problems == ["the search was left: the test"]
    assert driver.states("a") == [], "without a plan, but not yet given up"
    assert driver.run().states("a") == ["active", "aborted"]


def test_one_that_comes_while_such_a_goal_is_tried_again_is_served_first():
    driver = Interrupted()
    driver.drops = lambda update: "run" in str(update)
    driver.goal("a", "do(run,1)")
    driver.now += 10.0
    driver.core.poll(driver.now)
    driver.once()
    assert driver.goal("b", "do(walk,2)").awaited == ["_action_lib(walk,2,2)"]
    assert driver.finish().states("b")[-1] == "succeeded"
    driver.drops = lambda update: False
    driver.now += 20.0
    assert driver.run().finish().states("a")[-1] == "succeeded"


def test_an_update_whose_look_ahead_is_dropped_is_fed_without():
    driver = Interrupted()
    driver.drops = lambda update: update.bound and "_request(do(" in str(update)
    driver.goal("a", "do(walk,1)").finish()
    assert driver.states("a")[-1] == "succeeded", "a plan needs no look ahead"
    driver.goal("b", "do(never,2)")
    assert driver.states("b")[-1] == "aborted"
    assert "_request(cancel(2)" in driver.journal.updates[-1], "the request was in force"
    assert driver.message("b") == "do(never,2) cannot be met: there is no plan of at most 8 steps", "it is proven"
    assert driver.goal("c", "do(run,3)").finish().states("c")[-1] == "succeeded"


def test_a_solver_that_drops_everything_costs_time_only():
    driver = Interrupted().goal("a", "do(walk,1)")
    driver.drops = lambda update: True
    driver.succeed()
    assert driver.core.queue.patience == 2, "the next search has more"
    driver.drops = lambda update: False
    driver.now += PAUSE - 1.0
    assert driver.run().states("a") == []
    driver.now += 1.0
    assert driver.run().states("a")[-1] == "succeeded"
    assert driver.awaited == []
    assert driver.goal("b", "do(run,2)").finish().states("b")[-1] == "succeeded"


#: Nothing can follow the first of these facts.
DOOMED = ERRANDS + ":- _seen(end).\n"


def test_mending_is_left_for_what_comes():
    watch = Leaving()
    driver = Driver(DOOMED, watch=watch).goal("a", "do(walk,1)").succeed()
    driver.core.receive("interface", ["_seen(end)"])
    watch.number = 2
    assert driver.core.advance(1.0)
    assert "_seen(end)." in driver.journal.updates[-1], "it is in force"
    driver.core.add_goal("b", "do(run,2)")
    assert driver.run().finish().states("b")[-1] == "succeeded"
    assert "#withdraw _seen(end)." in "".join(driver.journal.updates)
    check_replay(driver.program, driver.journal)
