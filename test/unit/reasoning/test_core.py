"""The cycle: batching, idling, waiting, returns, cancels, time-outs."""

from dataclasses import replace

import pytest
from core_driver import ERRANDS, Driver

from rosoclingo.oclingo import (
    SolveOutcome,
    SolverError,
    SolveResult,
    parse_atom,
)
from rosoclingo.planning.history import AcceptedUpdate, History
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.reasoning import CoreSettings, GoalProgress, Problem
from rosoclingo.reasoning.keywords import LONGEST
from rosoclingo.reasoning.returns import MOST_FACTS

#: Nothing can be done before cycle 4; goals ``wait(Id)``.
WAIT = """
#external _request/2. #external _return/3.
#program cumulative(t).
{ _action_lib(go,I,t) : _request(wait(I),_), t >= 4 } 1.
done(I,t) :- _action_lib(go,I,t).
done(I,t) :- done(I,t-1).
:- _action_lib(go,I,t), done(I,t-1).
#program volatile(t).
:- _request(wait(I),_), not done(I,t).
#program base.
#show _action_lib/3.
"""

#: Two arms work in one cycle.
ARMS = """
#external _request/2. #external _return/3.
#program cumulative(t).
_action_lib(left,I,t) :- _request(both(I),t+1).
_action_lib(right,I,t) :- _request(both(I),t+1).
#program base.
#show _action_lib/3.
"""

#: Plans by itself, without any goal: one action in cycle 2.
ALONE = """
#external _request/2. #external _return/3.
#program cumulative(t).
_action_lib(wake,up,t) :- t = 2.
#program volatile(t).
:- t < 2.
#program base.
#show _action_lib/3.
"""


#: Says of ``told(Id)`` that it is met, in the request's cycle, and of ``asked(Id)`` nothing.
WORDS_ONLY = """
#external _request/2.
#program cumulative(t).
_status(I,succeeded,t) :- _request(told(I),t).
#program volatile(t).
#program base.
#show _action_lib/3. #show _status/3.
"""

#: One errand ``go(Id)`` at every fourth cycle.
SELDOM = """
#external _request/2. #external _return/3. #external _seen/1.
#program cumulative(t).
{ _action_lib(go,I,t) : _request(go(I),_), t \\ 4 = 0 } 1.
done(I,t) :- _action_lib(go,I,t).
done(I,t) :- done(I,t-1).
done(I,t) :- _request(cancel(I),t).
:- _action_lib(go,I,t), done(I,t-1).
#program volatile(t).
:- _request(go(I),_), not done(I,t).
#program base.
#show _action_lib/3.
"""


class Procrastinator:
    """A solver whose plan always begins in the cycle after this one."""

    def __init__(self):
        self.log = History()

    def update(self, update, stopped=None):
        self.log = self.log.with_entries(AcceptedUpdate(update, update.step + 1))
        later = parse_atom(f"_action_lib(go,1,{update.step + 1})")
        seconds = {"ground": 0.0, "solve": 0.0, "needed": 0.0}
        return SolveResult(
            SolveOutcome.SATISFIABLE, (frozenset([later]),), update.step + 1, update.step, statistics=seconds
        )

    def restore(self, log):
        self.log = log


class Dawdler(Procrastinator):
    """Has something to do in every fourth cycle as well."""

    def update(self, update, stopped=None):
        result = super().update(update, stopped)
        now = parse_atom(f"_action_lib(go,1,{update.step})")
        return result if update.step % 4 else replace(result, answers=(result.answers[0] | {now},))


def test_what_arrives_while_an_action_runs_is_batched_in_order():
    driver = Driver()
    driver.goal("a", "do(walk,1)").goal("b", "do(run,2)").goal("c", "do(swim,3)")
    assert len(driver.journal.updates) == 1
    driver.facts("_seen(ball)").cancel("a").succeed()
    assert driver.journal.updates[1].split() == [
        *["#step", "2.", ":-", "not", "_action_lib(walk,1,1).", "_request(do(run,2),3).", "_request(do(swim,3),3)."],
        *["_request(cancel(1),2).", "_seen(ball).", "_return(walk,1,1).", "#end", "step."],
    ]


def test_cycle_without_actions_ends_at_once_when_something_is_planned_later():
    driver = Driver(WAIT).goal("a", "wait(1)")
    assert driver.core.cycle == 4
    assert driver.awaited == ["_action_lib(go,1,4)"]
    assert [text.split()[:2] for text in driver.journal.updates[1:]] == [
        ["#step", "2."],
        ["#step", "3."],
        ["#step", "4."],
    ]
    assert driver.finish().states("a")[-1] == "succeeded"


def test_program_that_plans_before_any_request():
    driver = Driver(ALONE)
    assert driver.awaited == ["_action_lib(wake,up,2)"]
    assert driver.journal.updates == ["#step 1.\n#end step.\n", "#step 2.\n#end step.\n"]


def test_waits_for_one_goal_do_not_count_for_the_next():
    driver = Driver(SELDOM, CoreSettings(horizon_limit=5))
    for number in range(1, 6):
        driver.goal(f"g{number}", f"go({number})").finish()
    assert [driver.states(f"g{number}")[-1] for number in range(1, 6)] == ["succeeded"] * 5
    assert not any("put off" in problem for problem in driver.journal.problems)


def test_a_plan_of_which_something_is_done_now_and_then_is_not_given_up():
    core, journal = idle_core(Dawdler, ERRANDS.replace("#external _return/3.", ""))
    core.add_goal("a", "do(walk,1)")
    while core.cycle < 20:
        if not core.advance(1.0):
            core.receive("interface", [f"_return(go,1,{core.cycle})"])
    assert not any("put off" in problem for problem in journal.problems)
    assert [goal.key for goal in core.live_goals] == ["a"]


def test_goal_that_needs_no_action_is_judged_in_its_requests_cycle():
    driver = Driver(WORDS_ONLY).goal("a", "told(1)").goal("b", "asked(2)")
    assert driver.states("a") == ["active", "succeeded"]
    assert driver.message("b") == "no rule of the program can see asked(2): rules look at told(I)"


def test_goal_that_goes_on_without_any_action_is_waited_for():
    driver = Driver(WORDS_ONLY.replace("_status(I,succeeded,t) :-", "_status(I,accepted,t) :-").replace(",t).", ",_)."))
    assert driver.goal("a", "told(1)").states("a") == ["active"]
    assert driver.awaited == []
    assert not driver.core.advance(2.0)


def test_what_is_told_of_a_goal_in_its_order():
    driver = Driver().goal("a", "do(walk,1)")
    driver.facts("_return(walk,1,1)")
    assert [(type(event).__name__, event.cycle) for event in driver.journal.events] == [
        *[("PlanMade", 1), ("StateChanged", 1)],
        *[("UpdateSent", 1), ("ActionsDispatched", 1), ("PlanMade", 1), ("StateChanged", 1), ("GoalProgress", 1)],
        *[("ReturnTaken", 1), ("UpdateSent", 2), ("PlanMade", 2), ("StateChanged", 2)],
        *[("GoalChanged", 2), ("GoalChanged", 2)],
    ]


class Picky(PlanSolver):
    """Refuses what ``refused`` says of an update."""

    refused = staticmethod(lambda _text: False)

    def update(self, update, stopped=None):
        if self.refused(str(update)):
            raise SolverError("not this one")
        return super().update(update, stopped)


def idle_core(solver, text=ERRANDS):
    """A core that may put its plan off five times, on solvers of its own, and its journal."""
    driver = Driver(text, CoreSettings(horizon_limit=5), solver=lambda _program: solver(), start=False)
    driver.core.start()
    return driver.core, driver.journal


def test_actions_of_a_cycle_go_out_together_and_are_awaited_together():
    driver = Driver(ARMS).goal("a", "both(1)")
    assert driver.awaited == ["_action_lib(left,1,1)", "_action_lib(right,1,1)"]
    driver.facts("_return(right,failed,1)")
    assert driver.core.cycle == 1
    driver.facts("_return(left,1,1)")
    assert driver.core.cycle == 2
    assert ":- not _action_lib(left,1,1).\n:- not _action_lib(right,1,1).\n" in driver.journal.updates[1]


@pytest.mark.mostly_slow
@pytest.mark.parametrize(
    ("fact", "reason"),
    [
        ("_return(walk,1,2)", "it is cycle 1 now"),
        ("_return(swim,1,1)", "no action of 'swim'"),
        ("_return(walk,1)", "not of the form"),
        ("_return(walk,1,soon)", "no positive integer"),
        ("_request(do(run,9),2)", "for the core and the program only"),
        ("_action_lib(walk,1,1)", "for the core and the program only"),
        ("_status(1,succeeded,1)", "for the core and the program only"),
        ("_explain(1,tired,1)", "for the core and the program only"),
        ("_cancel(walk,1,1)", "for the core and the program only"),
        ("_unheard(1)", "declares no external _unheard/1"),
        ("_seen(X)", "1:"),
        ("garbage(((", "1:"),
        ("", "1:"),
    ],
)
def test_facts_that_make_no_sense_are_told_and_ignored(fact, reason):
    driver = Driver().goal("a", "do(walk,1)").facts(fact, "_seen(ball)")
    assert len(driver.journal.problems) == 1
    assert reason in driver.journal.problems[0]
    assert f"'{fact}' from 'interface' is ignored" in driver.journal.problems[0]
    driver.succeed()
    assert "_seen(ball)." in driver.journal.updates[1]
    assert driver.states("a")[-1] == "succeeded"


def test_a_fact_has_a_greatest_length():
    longest = f'_seen("{"x" * (LONGEST - 9)}")'
    driver = Driver().facts(longest, longest.replace("x", "xx", 1))
    (problem,) = driver.problems
    assert f"is ignored: it is too long: write at most {LONGEST} characters" in problem
    assert len(problem) < 400
    assert f"{longest}." in driver.journal.updates[0]


def test_a_message_has_a_greatest_number_of_facts():
    driver = Driver().facts(*(f"_seen({number})" for number in range(MOST_FACTS + 7)))
    assert driver.journal.problems == [
        f"of {MOST_FACTS + 7} facts in one message from 'interface' those behind the first {MOST_FACTS} are ignored:"
        " send them in several"
    ]
    assert f"_seen({MOST_FACTS - 1})." in driver.journal.updates[0]
    assert f"_seen({MOST_FACTS})." not in driver.journal.updates[0]


def test_only_so_many_facts_wait_while_an_action_runs(monkeypatch):
    monkeypatch.setattr("rosoclingo.reasoning.returns.MOST_WAITING", 5)
    driver = Driver().goal("a", "do(walk,1)").facts(*(f"_seen({number})" for number in range(8)))
    assert driver.journal.problems == [
        f"'_seen({number})' from 'interface' is ignored: 5 facts wait for the next update already"
        for number in (5, 6, 7)
    ]
    assert driver.succeed().states("a")[-1] == "succeeded", "a return is taken whatever waits"


def test_return_while_nothing_is_under_way():
    driver = Driver().facts("_return(walk,1,1)")
    assert "no action is under way" in driver.journal.problems[0]
    assert driver.journal.updates == []


def test_action_timeout():
    driver = Driver(settings=CoreSettings(horizon_limit=8, action_timeout=10.0)).goal("a", "do(walk,1)")
    driver.now = 10.9
    driver.run()
    assert driver.core.cycle == 1
    driver.now = 11.0
    driver.run()
    assert driver.core.cycle == 2
    assert "_return(walk,timeout,1)." in driver.journal.updates[1]
    assert "10 s" in driver.journal.problems[0]
    assert driver.finish().states("a")[-1] == "succeeded"


def test_no_action_timeout():
    driver = Driver(settings=CoreSettings(action_timeout=0.0)).goal("a", "do(walk,1)")
    driver.now = 1e9
    assert driver.run().awaited == ["_action_lib(walk,1,1)"]


def test_time_that_jumps_back_starts_the_timeout_anew():
    driver = Driver(settings=CoreSettings(action_timeout=10.0))
    driver.now = 100.0
    driver.goal("a", "do(walk,1)")
    driver.now = 5.0
    driver.run()
    driver.now = 14.0
    assert driver.run().core.cycle == 1
    driver.now = 16.0
    assert driver.run().core.cycle == 2


def test_feedback_after_each_answer():
    driver = Driver().goal("a", "do(walk,1)")
    feedback = driver.journal.of(GoalProgress)
    assert [(one.key, one.cycle, len(one.actions), one.position) for one in feedback] == [("a", 1, 1, 0)]
    driver.goal("b", "do(run,2)").succeed()
    feedback = driver.journal.of(GoalProgress)[1:]
    assert [(one.key, one.cycle, len(one.actions), one.position) for one in feedback] == [
        ("a", 2, 2, 1),
        ("b", 2, 2, 1),
    ]


def test_abandon_ends_every_goal():
    driver = (
        Driver(settings=CoreSettings(horizon_limit=8, goals_at_once=1)).goal("a", "do(walk,1)").goal("b", "do(run,2)")
    )
    driver.core.abandon("is given up: the core shuts down")
    assert driver.states("a")[-1] == driver.states("b")[-1] == "aborted", "also one that waits"
    assert "shuts down" in driver.message("a")
    driver.succeed()
    assert not driver.core.advance(2.0)


def test_goal_that_the_program_declares_no_external_for():
    text = ERRANDS.replace(
        "#external _request/2.", "#external _request(do(walk,1..2),1..20). #external _request(cancel(1..2),1..20)."
    )
    driver = Driver(text).goal("bad", "do(fly,1)").goal("good", "do(walk,1)").finish()
    assert driver.states("bad") == ["rejected"]
    assert "unknown to the program" in driver.message("bad")
    assert driver.states("good")[-1] == "succeeded"


def test_malformed_actions_are_told_and_do_not_stop_anything():
    text = ERRANDS + "_action_lib(odd,x,never).\n"
    driver = Driver(text).goal("a", "do(walk,1)").finish()
    assert driver.states("a")[-1] == "succeeded"
    assert any("_action_lib(odd,x,never)" in event.message for event in driver.journal.of(Problem))


def test_a_return_that_the_program_does_not_know_ends_the_action():
    driver = Driver("#program cumulative(t).\n_action_lib(wake,up,t) :- t = 2.\n#program volatile(t).\n:- t < 2.\n")
    assert driver.awaited == ["_action_lib(wake,up,2)"]
    driver.succeed()
    assert driver.awaited == []
    assert driver.core.cycle == 3, "the next cycle begins, though there is nothing to feed"
    assert "declares no external _return/3" in driver.journal.problems[0]
