"""The core before its first update, between two cycles, and at each limit: what is told, and what is not."""

import re
from dataclasses import replace

import pytest
from core_driver import ERRANDS, Driver, shortest
from test_core import Picky, Procrastinator
from test_core_interrupted import Leaving
from test_late_facts import BATTERY

from rosoclingo.oclingo import DroppedError, SolveOutcome
from rosoclingo.oclingo.progression.updates import Anew, Volatile
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.reasoning import ActionsDispatched, CoreSettings, GoalProgress, PlanMade, UpdateSent, stream_planner

#: A goal ``told(Id)`` is under way as long as nothing ends it, and needs no action.
UNDER_WAY = """
#external _request/2.
#program cumulative(t).
_status(I,accepted,t) :- _request(told(I),_).
#program volatile(t).
#program base.
#show _action_lib/3. #show _status/3.
"""


class Relenting(Procrastinator):
    """Puts its plan off until the fifth cycle, where there is nothing left to do."""

    def update(self, update, stopped=None):
        result = super().update(update, stopped)
        return result if update.step < 5 else replace(result, answers=(frozenset(),))


class Undecided(Driver):
    """A driver whose searches are over before they come to a result while ``halts`` says so of their updates.

    Updates that it ``drops`` are not taken at all.
    """

    halts = drops = staticmethod(lambda _update: False)
    asked = None  # the solver that took the latest update

    def __init__(self, **others):
        super().__init__(solver=self._make, **others)

    def _make(self, program):
        driver = self

        class Halting(PlanSolver):
            def update(self, update, stopped=None):
                if driver.drops(update):
                    raise DroppedError("ended by the test")
                result, driver.asked = super().update(update, stopped), self
                return replace(result, outcome=SolveOutcome.INTERRUPTED, answers=()) if driver.halts(update) else result

        return shortest(program, Halting)


def putting_off(solver):
    """A driver, which has not begun, whose plan begins in a later cycle; it may be put off for five."""
    return Driver(settings=CoreSettings(horizon_limit=5), solver=lambda _program: solver(), start=False)


class Replaceable(Driver):
    """A driver that knows the solver in use, by which ``refused`` updates can be refused; a further one takes all."""

    def __init__(self, text=ERRANDS, settings=None):
        super().__init__(text, settings, solver=self._make)

    def _make(self, program):
        self.solver = shortest(program, Picky)
        return self.solver


def test_a_core_that_has_not_begun_has_no_plan():
    driver = putting_off(Procrastinator)
    core = driver.core
    assert (core.cycle, core.plan.actions, core.live_goals, core.awaited) == (1, (), [], ())
    assert not core.improve(lambda: False), "nor is there one to improve"
    assert not driver.journal.events


def test_an_update_that_nothing_was_taken_of_is_not_told():
    driver = Replaceable()
    driver.solver.refused = lambda _text: True
    assert driver.goal("a", "do(walk,1)").states("a") == ["rejected"]
    assert driver.journal.updates == []


def test_the_goals_of_a_solver_that_takes_nothing_any_more_are_over_for_the_program_too():
    driver = Replaceable(settings=CoreSettings(horizon_limit=8, goals_at_once=1)).goal("a", "do(walk,1)")
    driver.core.add_goal("b", "do(walk,2)")
    driver.solver.refused = lambda _text: True
    driver.succeed()
    assert driver.message("a") == "do(walk,1) is given up: the solver accepts no more updates"
    assert driver.message("b") == "do(walk,2) is given up: the solver accepts no more updates", "though it waited"
    driver.goal("c", "do(run,3)")
    assert "_request(cancel(1),2)." in driver.journal.updates[-1]


def test_a_fact_that_was_not_taken_is_new_when_it_is_told_again():
    driver = Replaceable(BATTERY)
    driver.solver.refused = lambda text: "_battery" in text
    driver.facts("_battery(high,9)")
    assert driver.journal.updates == ["#step 1.\n#end step.\n"]
    driver.solver.refused = lambda _text: False
    driver.facts("_battery(high,9)").facts("_battery(high,9)")
    assert driver.journal.updates[1:] == ["#step 2.\n_battery(high,9).\n#end step.\n"]


def test_a_plan_is_put_off_for_so_many_cycles_after_what_has_come():
    driver = putting_off(Procrastinator).begin().facts("_seen(ball)")
    assert driver.core.cycle == 5 + 1 + 5
    assert driver.problems == ["the plan was put off 5 times in a row: it is given up"] * 2


def test_a_plan_that_comes_to_nothing_at_the_limit_is_not_given_up():
    driver = putting_off(Relenting).begin()
    assert driver.core.cycle == 5
    assert driver.journal.problems == []


def test_the_first_update_says_nothing_of_the_past():
    assert Driver().facts("_seen(ball)").journal.stream == "#step 1 : 8.\n_seen(ball).\n#end step.\n"


def test_nothing_is_fed_once_a_request_has_been_seen():
    driver = Driver(UNDER_WAY).goal("a", "told(1)")
    assert [text.split()[1] for text in driver.journal.updates] == ["1.", "2."], "the request's own cycle is the second"
    assert driver.states("a") == ["active"]


def test_what_an_open_request_saw_is_not_over():
    driver = Driver(UNDER_WAY + "#external _seen/1.")
    for number in range(40):
        if number in (12, 20):
            driver.goal(f"g{number}", f"told({number})")
        driver.facts(f"_seen({number})")
    over = [int(number) for number in re.findall(r"#over (\d+)", driver.journal.stream)]
    assert over == [*range(1, 14)]
    assert "#step 13.\n_request(told(12),14)." in "".join(driver.journal.updates)


def test_an_update_without_an_answer_has_no_plan_but_what_is_done():
    driver = Driver()
    driver.core.add_goal("a", "do(walk,1)")
    driver.goal("b", "do(run,2)").goal("c", "do(never,3)").succeed()
    told = [(event.cycle, len(event.actions)) for event in driver.journal.of(PlanMade)]
    assert told == [(1, 0), (1, 2), (2, 1), (3, 2)]


def test_what_the_solver_has_ignored_is_told():
    driver = Driver(ERRANDS.replace("#external _seen/1.", "#external _seen(1..2).")).facts("_seen(3)")
    assert driver.problems == ["Head _seen(3) has not been declared external. The entire rule will be ignored."]


def test_the_program_hears_with_the_next_update_that_a_goal_which_it_rejects_is_over():
    text = UNDER_WAY.replace("accepted", "rejected") + "#external _seen/1."
    driver = Driver(text).goal("a", "told(1)")
    assert driver.states("a") == ["rejected"]
    driver.facts("_seen(ball)")
    assert driver.journal.updates[-1].split()[2:4] == ["_request(cancel(1),2).", "_seen(ball)."]


NOT_FOUND = "no plan was found before the search was ended"


def test_where_it_stays_open_whether_there_is_an_answer_nothing_is_given_up_nor_begins_anew():
    driver = Undecided().goal("a", "do(walk,1)").finish()
    driver.halts = lambda update: not any(isinstance(item, Anew) for item in update.items)
    driver.core.add_goal("b", "do(run,2)")
    for _ in range(10):
        assert driver.core.advance(1.0)
    assert set(driver.problems) == {f"{NOT_FOUND}: the search goes on"}
    driver.halts = lambda _update: False
    assert driver.run().finish().states("b")[-1] == "succeeded"
    assert driver.goal("c", "do(walk,3)").finish().states("c")[-1] == "succeeded"


def test_a_plan_that_is_kept_is_put_off_by_the_cycles_in_which_nothing_was_done():
    watch = Leaving()
    driver = Undecided(watch=watch)
    for number in (1, 2, 3):
        driver.core.add_goal(str(number), f"do(walk,{number})")
    *_, one, last = [str(action.parameter) for action in driver.run().core.plan.actions]
    watch.number = 1
    driver.core.receive("interface", [f"_return(walk,{driver.core.awaited[0].parameter},1)", "_seen(ball)"])
    assert driver.core.advance(1.0)
    assert (driver.core.cycle, driver.core.plan.actions) == (2, ()), "the search was left"
    driver.halts = lambda update: not any(isinstance(item, Volatile) for item in update.items)
    driver.run()
    later = [str(action.atom) for action in driver.core.plan.remaining(3)]
    assert later == [f"_action_lib(walk,{one},3)", f"_action_lib(walk,{last},4)"]
    assert driver.awaited == [f"_action_lib(walk,{one},3)"]
    told = [type(event) for event in driver.journal.events if event.cycle == 3]
    assert told.index(UpdateSent) < told.index(ActionsDispatched) < told.index(GoalProgress)


def test_only_how_long_a_plan_with_new_goals_takes_tells_how_many_goals_there_is_room_for():
    needed = [90.0]

    class Timed(PlanSolver):
        def update(self, update, stopped=None):
            result = super().update(update, stopped)
            return replace(result, statistics={**result.statistics, "needed": needed[0]})

    settings = CoreSettings(horizon_limit=8, search_timeout=10.0)
    driver = Driver(settings=settings, solver=lambda program: shortest(program, Timed))
    for number in range(1, 7):
        driver.core.add_goal(str(number), f"do(walk,{number})")
    assert driver.run().core.queue.size == 3, "half as many as before"
    needed[0] = 0.001
    assert driver.fail("failed").core.queue.size == 3


#: Only these requests are declared.
DECLARED = ERRANDS.replace(
    "#external _request/2.", "#external _request(do(walk,1..3),1..9). #external _request(cancel(1..3),1..9)."
)


@pytest.mark.parametrize(("text", "state"), [(ERRANDS, "succeeded"), (DECLARED, "rejected")])
def test_a_goal_that_the_solver_cannot_take_is_no_reason_to_let_others_wait(text, state):
    driver = Undecided(text=text)
    for number in (1, 2, 3):
        driver.core.add_goal(str(number), f"do(walk,{number})")
    first, *later = [str(action.parameter) for action in driver.run().core.plan.actions]
    driver.halts = lambda update: not any(isinstance(item, Volatile) for item in update.items)
    driver.drops = lambda update: text is ERRANDS and "do(run" in str(update)
    driver.core.add_goal("9", "do(run,9)")
    driver.facts(f"_return(walk,{first},1)")
    assert driver.awaited == [f"_action_lib(walk,{later[0]},2)"], "the last plan is kept"
    assert [goal.key for goal in driver.core.queue.waiting] == (["9"] if state == "succeeded" else [])
    assert not any("the search goes on" in problem for problem in driver.problems)
    driver.halts = driver.drops = lambda _update: False
    assert driver.finish().states("9")[-1] == state


def test_a_proof_that_comes_late_is_one():
    driver = Undecided()
    for number in (1, 2, 3):
        driver.halts = lambda _update: True
        driver.core.add_goal(str(number), f"do(never,{number})")
        assert driver.core.advance(1.0)
        assert driver.states(str(number)) == []
        driver.halts = lambda _update: False
        assert driver.run().states(str(number))[-1] == "aborted"
        assert driver.message(str(number)).endswith("cannot be met: there is no plan of at most 8 steps")
    assert driver.problems == 3 * [f"{NOT_FOUND}: the search goes on"]


#: What was done in cycle 1 cannot be any more in cycle 3.
IMPOSSIBLE = BATTERY + ":- _action_lib(walk,1,t-2).\n"


def contradicted(driver):
    """Goal c is under way, and goal b and two facts come with the update that has no answer whatever is given up."""
    driver.goal("a", "do(walk,1)").core.add_goal("c", "do(rest,9)")
    driver.succeed()
    driver.core.add_goal("b", "do(run,2)")
    return driver.facts("_battery(high,9)", "_return(rest,failed,2)")


def test_what_begins_anew_keeps_the_new_goals_only():
    driver = contradicted(Driver(IMPOSSIBLE))
    assert driver.message("c") == "do(rest,9) is given up: the program begins anew"
    assert driver.states("b") == []
    assert sum(text.startswith("ERROR: ") for text in driver.problems) == 1
    assert driver.awaited == ["_action_lib(run,2,4)"]
    assert [" ".join(text.split()[1:-2]) for text in driver.journal.updates[2:]] == [
        "3. #anew.",
        "4. _request(do(run,2),5).",
    ]
    assert [event.cycle for event in driver.journal.of(PlanMade)] == [1, 1, 2, 3, 3, 4]
    driver.facts("_battery(high,9)", "_return(run,2,4)")
    assert "_battery(high,9)." in driver.journal.updates[-1], "what was told before is new"
    assert driver.states("b")[-1] == "succeeded"


def test_where_it_cannot_begin_anew_the_goals_are_given_up():
    old = type("Old", (Picky,), {"refused": staticmethod(lambda text: "#anew" in text)})
    driver = contradicted(Driver(IMPOSSIBLE, solver=lambda program: shortest(program, old)))
    assert driver.states("b")[-1] == driver.states("c")[-1] == "aborted"
    why = "there is no plan of at most 10 steps"
    assert driver.message("b") == f"do(run,2) cannot be met: {why}"
    assert driver.problems[0] == f"no answer was found, whatever goals are given up: {why}"
    assert not any("begins anew" in text for text in driver.problems)
    assert not driver.core.awaited


def test_of_many_cycles_each_update_by_which_the_program_begins_anew_is_told(monkeypatch):
    monkeypatch.setattr(stream_planner, "MANY_STEPS", 20)
    driver = Driver(IMPOSSIBLE + "#external _tick/1.", settings=CoreSettings(horizon_limit=4))
    for number in range(20):
        driver.facts(f"_tick({number})")
    driver.goal("a", "do(walk,1)").succeed().core.add_goal("b", "do(run,2)")
    driver.succeed()
    assert driver.awaited == ["_action_lib(run,2,24)"]
    begun = driver.journal.stream.index("#anew")
    assert driver.journal.stream[begun:].replace("\n", " ").split("#step ")[1:] == [
        "23 : 4. #closed 20..22. #over 13. #end step. ",
        "24 : 4. #closed 23. _request(do(run,2),25). #end step. ",
    ]


@pytest.mark.parametrize("how", ["halts", "drops"])
def test_nothing_is_forgotten_where_it_is_not_found_out_in_time_whether_that_helps(how):
    driver = Undecided(text=IMPOSSIBLE)
    driver.goal("a", "do(walk,1)").core.add_goal("c", "do(rest,9)")
    driver.succeed()
    setattr(driver, how, lambda update: any(isinstance(item, Anew) for item in update.items))
    driver.core.receive("interface", ["_return(rest,failed,2)"])
    assert driver.core.advance(1.0)
    assert driver.states("c") == []
    assert driver.problems == [
        "there is no plan of at most 9 steps, and it was not found out in time which goals cannot be met: "
        "the search goes on"
    ]
    setattr(driver, how, lambda _update: False)
    driver.run()
    assert driver.message("c") == "do(rest,9) is given up: the program begins anew"
