"""A recorded run solved again: agreement, differences with a reason, and errors."""

import re
from dataclasses import replace

import pytest
from core_driver import Driver
from stream_replay import recorded

from rosoclingo.oclingo import ReactiveProgram, parse_atom
from rosoclingo.planning.history import Plan, cycle_of
from rosoclingo.runs.recorded_run import RecordingError, RunCollector, RunProgram
from rosoclingo.runs.replay import CycleVerdict, Replay, summary

#: Goal do(Id): press one of two buttons, any number of times, in any cycles.
BUTTONS = """
#program cumulative(t).
#external _request/2.
#external _return/3.
open(Id,t) :- _request(do(Id),t+1).
open(Id,t) :- open(Id,t-1), not pressed(t-1).
{ _action_lib(press,(left;right),t) } 1 :- open(Id,t).
pressed(t) :- _action_lib(press,B,t), not failed(t).
failed(t)  :- _action_lib(press,B,t), _return(press,V,t), V != B.
#show _action_lib/3.
#program volatile(t).
:- open(Id,t), not pressed(t).
"""


def pressed():
    """A run in which one of two buttons is pressed, its program, and the plan of its first cycle."""
    driver = Driver(BUTTONS).goal("key", "do(1)").finish()
    run = recorded(driver.journal)
    (action,) = run.cycles[0].plans[-1].actions
    return driver.program, run, str(action)


def plan(horizon, *actions):
    return Plan(frozenset(map(parse_atom, actions)), horizon)


def other(action):
    return action.replace("left", "RIGHT").replace("right", "left").replace("RIGHT", "right")


def first(run, program, **options):
    """Return the verdict of the first cycle."""
    return next(Replay(run, program, **options).reports())


def test_replay_accepts_another_plan_of_equal_length():
    program, run, action = pressed()
    run.cycles[0].plans = [plan(1, other(action))]
    run.cycles[0].dispatched = [other(action)]
    report = first(run, program)
    assert (report.verdict, report.explained) == (CycleVerdict.AS_SHORT, True)
    assert [str(atom) for atom in report.published.atoms] == [other(action)]
    assert [str(atom) for atom in report.found.atoms] == [action]


def test_replay_checks_a_plan_that_it_does_not_find_in_time():
    driver = Driver.of_shipped("mailbot.lp", "office.lp").goal("key", "goal(office1,office2,1)").finish()
    reports = [*Replay(recorded(driver.journal), driver.program, 1.0, search_time=1e-9).reports()]
    assert reports[0].verdict is CycleVerdict.SHORTER
    assert len(reports) > 2
    assert all(one.explained for one in reports), [one.line() for one in reports]


@pytest.mark.slow
def test_replay_answers_end_with_the_horizon():
    driver = Driver.of_shipped("mailbot.lp", "office.lp").goal("key", "goal(office1,office2,1)").finish()
    report = first(recorded(driver.journal), driver.program)
    places = {str(atom) for atom in report.published.atoms if atom.match("robot_at", 2)}
    assert (report.published.horizon, places) == (
        3,
        {"robot_at(office1,1)", "robot_at(office1,2)", "robot_at(office2,3)"},
    )


@pytest.mark.parametrize(("plan_time", "explained"), [(1.0, True), (None, False)])
def test_replay_reports_a_longer_plan(plan_time, explained):
    program, run, action = pressed()
    later = action.replace(",1)", ",3)")
    run.cycles[0].plans, run.cycles[0].dispatched = [plan(3, later)], None
    report = first(run, program, plan_time=plan_time)
    assert (report.verdict, report.explained) == (CycleVerdict.LONGER, explained)
    assert re.search("3 steps.* the replay finds 1", report.line())
    assert ("UNEXPLAINED" in report.line()) is not explained


@pytest.mark.parametrize(
    ("actions", "why"),
    [
        (["_action_lib(press,lever,1)"], "none has _action_lib(press,lever,1)"),
        (["_action_lib(press,left,1)", "_action_lib(press,right,1)"], "none has _action_lib(press,right,1) after"),
        (["_action_lib(press,left,1)", "_action_lib(press,left,2)"], "none has _action_lib(press,left,2) after"),
    ],
)
def test_replay_refuses_an_invalid_plan(actions, why):
    program, run, _ = pressed()
    run.cycles[0].plans, run.cycles[0].dispatched = [plan(2, *actions)], None
    report = first(run, program)
    assert (report.verdict, report.explained) == (CycleVerdict.WRONG, False)
    assert why in report.line()


@pytest.mark.slow
def test_replay_refuses_a_plan_that_is_incomplete():
    driver = Driver.of_shipped("mailbot.lp", "office.lp").goal("key", "goal(office2,office3,1)")
    run = recorded(driver.journal)
    (published,) = run.cycles[0].plans[1:]
    *begin, _ = sorted(published.actions, key=cycle_of)
    run.cycles[0].plans = [published._replace(actions=frozenset(begin))]
    report = first(run, driver.program)
    assert (report.verdict, report.explained, "it is incomplete" in report.why) == (CycleVerdict.WRONG, False, True)


def test_replay_refuses_actions_that_were_not_planned():
    program, run, action = pressed()
    run.cycles[0].dispatched = [other(action)]
    report = first(run, program)
    assert (report.verdict, report.explained) == (CycleVerdict.SENT, False)
    assert f"{other(action)} in place of {action}" in report.line()
    run.cycles[0].plans = []
    assert first(run, program).verdict is CycleVerdict.SENT


@pytest.mark.parametrize(
    ("plans", "problems", "explained", "reason"),
    [
        ([plan(1)], [], False, ""),
        ([plan(1)], ["no plan was found before the search was ended: it took longer than 10 s"], True, "10 s"),
        ([plan(1)], ["the search was interrupted: a goal was cancelled"], True, "a goal was cancelled"),
        ([plan(1)], ["the robot sings"], False, ""),
        ([], [], True, "the search was ended"),
    ],
)
def test_replay_reports_a_missed_plan(plans, problems, explained, reason):
    program, run, _ = pressed()
    run.cycles[0].plans, run.cycles[0].dispatched, run.cycles[0].problems = plans, None, problems
    report = first(run, program)
    assert (report.verdict, report.explained) == (CycleVerdict.MISSED, explained)
    assert reason in report.line()


def test_replay_ends_at_a_refused_update():
    collector = RunCollector()
    for step in range(1, 7):
        collector.update(0.0, f"#step {step} : 0. #end step.")
    program = ReactiveProgram.from_text(
        "#program cumulative(t). { m(1..2,t) }. :- #sum { 250000000*t,X : m(X,t) } > 300000000*t."
    )
    reports = list(Replay(collector.runs()[0], program).reports())
    assert [report.cycle for report in reports] == [1, 2, 3, 4, 5]
    assert (reports[-1].verdict, reports[-1].explained) == (CycleVerdict.REFUSED, False)
    assert "overflow" in reports[-1].line()
    assert summary(reports)[-1] == "1 unexplained: cycles 5"


def test_replay_stops_a_search_that_takes_too_long():
    program, run, _ = pressed()
    run.cycles[0].plans, run.cycles[0].dispatched = [], None
    assert first(run, program, search_time=1e-9).verdict is CycleVerdict.NONE


def test_replay_refuses_a_changed_program_text():
    kept = RunProgram.of("run", ReactiveProgram.from_text("a."), {})
    with pytest.raises(RecordingError, match="was changed after the run"):
        replace(kept, files=(kept.files[0]._replace(text="b."),)).load()
    with pytest.raises(RecordingError, match="cannot be used"):
        replace(kept, files=(kept.files[0]._replace(text="b"),)).load()
    for text in ("", "{}", "[]", '{"format": 1}', '{"format": "x"}'):
        with pytest.raises(RecordingError, match="damaged"):
            RunProgram.parse(text)
    with pytest.raises(RecordingError, match="a later version"):
        RunProgram.parse('{"format": 2}')
