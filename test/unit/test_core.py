"""The cycle: batching, idling, waiting, returns, cancels, time-outs."""

import pytest
from core_driver import ERRANDS, Driver

from rosoclingo.oclingo import (
    ReactiveProgram,
    ReactiveSolver,
    SolveOutcome,
    SolverError,
    SolveResult,
    parse_atom,
)
from rosoclingo.reasoning import Core, CoreSettings, GoalProgress, Problem
from rosoclingo.reasoning.journal import Journal

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


class Procrastinator:
    """A solver whose plan always begins in the cycle after this one."""

    def update(self, update, stopped=None):
        later = parse_atom(f"_action_lib(go,1,{update.step + 1})")
        seconds = {"ground": 0.0, "solve": 0.0}
        return SolveResult(
            SolveOutcome.SATISFIABLE, (frozenset([later]),), update.step + 1, update.step, statistics=seconds
        )

    def close_cycle(self, cycle, executed):
        pass

    def forget_before(self, step):
        pass

    def snapshot(self):
        return None


def test_idle_core_sends_no_update():
    driver = Driver()
    assert not driver.core.advance(5.0)
    assert driver.journal.updates == []


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


def test_plan_that_is_put_off_for_ever_is_given_up():
    journal = Journal()
    program = ReactiveProgram.from_text(ERRANDS)
    core = Core(program, Procrastinator, journal, CoreSettings(horizon_limit=5))
    core.start()
    core.add_goal("a", "do(walk,1)")
    cycles = 0
    while core.advance(1.0):
        cycles += 1
    assert cycles < 20
    assert "put off" in journal.problems[0]
    assert journal.states_of("a")[-1] == "aborted"
    core.receive("interface", ["_seen(ball)"])
    assert core.advance(1.0)


class Picky(ReactiveSolver):
    """Refuses what ``refused`` says of an update."""

    refused = staticmethod(lambda _text: False)

    def update(self, update, stopped=None):
        if self.refused(str(update)):
            raise SolverError("not this one")
        return super().update(update, stopped)


def picky_core(journal):
    program = ReactiveProgram.from_text(ERRANDS)
    core = Core(program, lambda: Picky(program, shortest=True), journal, CoreSettings(horizon_limit=8))
    core.start()
    return core


def test_refused_update_costs_the_new_goals_and_no_other(monkeypatch):
    journal = Journal()
    core = picky_core(journal)
    monkeypatch.setattr(Picky, "refused", staticmethod(lambda text: "fly" in text))
    core.add_goal("good", "do(walk,1)")
    assert core.advance(1.0)
    core.add_goal("bad", "do(fly,2)")
    core.receive("interface", ["_return(walk,1,1)"])
    assert core.advance(2.0)
    assert journal.states_of("bad") == ["rejected"]
    assert "not this one" in journal.problems[0]
    assert [str(action.atom) for action in core.plan.actions] == ["_action_lib(walk,1,1)"]
    assert journal.states_of("good")[-1] == "succeeded"


def test_solver_that_takes_nothing_any_more_ends_every_goal(monkeypatch):
    journal = Journal()
    core = picky_core(journal)
    core.add_goal("good", "do(walk,1)")
    assert core.advance(1.0)
    monkeypatch.setattr(Picky, "refused", staticmethod(lambda _text: True))
    core.receive("interface", ["_return(walk,1,1)"])
    assert core.advance(2.0)
    assert journal.states_of("good")[-1] == "aborted"
    assert not core.advance(3.0)


def test_the_past_is_closed():
    driver = Driver(ERRANDS.replace("t >= 4", "t >= 1"))
    driver.goal("a", "do(walk,1)").finish()  # cycle 2 is idle
    driver.goal("b", "do(run,2)")  # starts cycle 3
    assert driver.core.cycle == 3
    assert [str(action.atom) for action in driver.core.plan.actions] == [
        "_action_lib(walk,1,1)",
        "_action_lib(run,2,3)",
    ]


def test_actions_of_a_cycle_go_out_together_and_are_awaited_together():
    driver = Driver(ARMS).goal("a", "both(1)")
    assert driver.awaited == ["_action_lib(left,1,1)", "_action_lib(right,1,1)"]
    driver.facts("_return(right,failed,1)")
    assert driver.core.cycle == 1
    driver.facts("_return(left,1,1)")
    assert driver.core.cycle == 2
    assert ":- not _action_lib(left,1,1).\n:- not _action_lib(right,1,1).\n" in driver.journal.updates[1]


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


def test_return_while_nothing_is_under_way():
    driver = Driver().facts("_return(walk,1,1)")
    assert "no action is under way" in driver.journal.problems[0]
    assert driver.journal.updates == []


def test_fact_wakes_the_idle_core():
    driver = Driver().facts("_seen(ball)")
    assert driver.journal.updates == ["#step 1.\n_seen(ball).\n#end step.\n"]


def test_late_return_does_not_count_for_the_next_action():
    driver = Driver().goal("a", "do(walk,1)").facts("_return(walk,failed,1)")
    assert driver.awaited == ["_action_lib(walk,1,2)"]
    driver.facts("_return(walk,1,1)")
    assert driver.awaited == ["_action_lib(walk,1,2)"]
    assert "cycle 2 now" in driver.journal.problems[0]


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


def test_action_timeout_of_a_program_without_returns():
    text = ERRANDS.replace("#external _return/3.", "")
    driver = Driver(text, CoreSettings(horizon_limit=8, action_timeout=10.0)).goal("a", "do(walk,1)")
    driver.now = 11.0
    assert driver.run().awaited == []
    assert any("no external _return/3" in problem for problem in driver.journal.problems)
    assert driver.states("a")[-1] == "succeeded", "the program is told of no failure"


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


def test_cancel_before_it_was_fed():
    driver = Driver().goal("a", "do(walk,1)").goal("b", "do(run,2)").cancel("b")
    assert driver.states("b") == ["recalling", "recalled"]
    assert "do(run,2)" not in "".join(driver.finish().journal.updates)


def test_cancel_twice_and_after_the_end_and_of_unknown_goals():
    driver = Driver().goal("a", "do(walk,1)").cancel("a").cancel("a").cancel("nobody").finish().cancel("a")
    assert sum(text.count("cancel") for text in driver.journal.updates) == 1
    assert driver.states("a")[-1] in ("preempted", "recalled")


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
    driver = Driver().goal("a", "do(walk,1)").goal("b", "do(run,2)")
    driver.core.abandon("is given up: the core shuts down")
    assert driver.states("a")[-1] == driver.states("b")[-1] == "aborted"
    assert "shuts down" in driver.message("a")


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
    assert "declares no external _return/3" in driver.journal.problems[0]


def test_goals_beyond_the_number_at_once_wait_for_their_turn():
    driver = Driver(settings=CoreSettings(horizon_limit=8, goals_at_once=2))
    for number in range(1, 6):
        driver.core.add_goal(f"g{number}", f"do(walk,{number})")
    driver.run()
    told = "".join(update for update in driver.journal.updates)
    assert [number for number in range(1, 6) if f"do(walk,{number})" in told] == [1, 2]
    assert driver.states("g3") == []
    driver.cancel("g4")
    assert driver.states("g4") == ["recalling", "recalled"]
    driver.finish()
    assert [driver.states(f"g{number}")[-1] for number in (1, 2, 3, 5)] == ["succeeded"] * 4
    told = "".join(update for update in driver.journal.updates)
    assert "do(walk,4)" not in told
    assert told.index("do(walk,3)") < told.index("do(walk,5)")


def test_a_core_that_goes_away_ends_goals_that_wait_as_well():
    driver = Driver(settings=CoreSettings(horizon_limit=8, goals_at_once=1))
    for number in (1, 2, 3):
        driver.core.add_goal(f"g{number}", f"do(walk,{number})")
    driver.core.abandon("is given up")
    assert [driver.states(f"g{number}")[-1] for number in (1, 2, 3)] == ["aborted"] * 3
    assert not driver.core.advance(2.0)
