"""The examples of the literature: their programs do what the papers say."""

import pytest
from core_driver import Driver
from golog_programs import ENCODINGS

from rosoclingo.oclingo import ReactiveProgram, parse_update
from rosoclingo.oclingo.program.sources import Source
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.reasoning.settings import CoreSettings

GOLOG = ENCODINGS / "golog"


def program_of(name, facts):
    return ReactiveProgram([Source.from_file(GOLOG / f"{name}.golog"), Source("facts.lp", f"#program base. {facts}")])


def plans(program, request):
    """All shortest plans for a request."""
    solver = PlanSolver(program, models=0)
    result = solver.update(parse_update(f"#step 1 : 30. _request(run({request},1),2). #endstep."))
    found = []
    for answer in result.answers:
        steps = {one.arguments[2].number: one.arguments[:2] for one in answer if one.name == "_action_lib"}
        found.append(" ".join("{}({})".format(*steps[step]) for step in sorted(steps)))
    return found


SERVE = "turnoff({0}) door(open) door(close)"


def test_the_elevator_has_the_two_plans_of_the_paper():
    """At floor 4, with calls from 3 and 5: either goes first, and the elevator is parked at floor 0."""
    third, fifth = SERVE.format(3), SERVE.format(5)
    wanted = [
        f"down(3) {third} up(5) {fifth} down(0) door(open)",
        f"up(5) {fifth} down(3) {third} down(0) door(open)",
    ]
    assert sorted(plans(program_of("elevator", "calls(3). calls(5)."), "control")) == wanted


@pytest.mark.slow
def test_the_elevator_is_parked_where_nobody_has_called():
    assert plans(program_of("elevator", ""), "control") == ["down(0) door(open)"]
    assert plans(ReactiveProgram([*program_of("elevator", "").sources], {"first": "0"}), "control") == ["door(open)"]


@pytest.mark.slow
def test_the_elevator_may_go_to_a_floor_that_is_nearest():
    third, fifth = SERVE.format(3), SERVE.format(5)
    assert sorted(plans(program_of("elevator", "calls(2). calls(3). calls(5)."), "nearest")) == [
        f"down(3) {third} down(2) {SERVE.format(2)} up(5) {fifth} down(0) door(open)",
        f"up(5) {fifth} down(3) {third} down(2) {SERVE.format(2)} down(0) door(open)",
    ]


@pytest.mark.slow
def test_the_elevator_serves_who_calls_while_it_runs():
    driver = Driver(settings=CoreSettings(), program=program_of("elevator", "calls(3).")).goal("g", "run(control,1)")
    assert driver.awaited == ["_action_lib(down,3,1)"]
    driver.facts("_pressed(6,now)")
    found = []
    while driver.core.awaited:
        found += driver.awaited
        driver.succeed()
    assert "_action_lib(turnoff,6,6)" in found
    assert driver.states("g")[-1] == "succeeded"


def doing(driver):
    """What is under way."""
    return [f"{action.interface} {action.parameter}" for action in driver.core.awaited]


@pytest.mark.slow
def test_mail_is_acknowledged_first_and_goes_on_when_the_service_is_resumed():
    driver = Driver(settings=CoreSettings(), program=program_of("mail", "customer(a;b;c). start(a)."))
    assert doing(driver.goal("g", "run(control)")) == []
    assert doing(driver.facts("_order(1,b,c,now)")) == ["ack 1"]
    assert doing(driver.succeed()) == ["go b"]
    assert doing(driver.facts("_order(2,b,a,now)").succeed()) == ["ack 2"]
    assert doing(driver.facts("_suspend(now)").succeed()) == []
    driver.facts("_resume(now)")
    done = []
    while driver.core.awaited:
        done += doing(driver)
        driver.succeed()
    assert sorted(done[:2]) == ["take 1", "take 2"]
    assert done[2:] in (["go c", "hand 1", "go a", "hand 2"], ["go a", "hand 2", "go c", "hand 1"])
    assert driver.states("g")[-1] == "active"
    assert driver.cancel("g").states("g")[-1] == "preempted"
