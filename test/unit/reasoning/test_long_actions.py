"""Programs with ``_running``: a cycle ends with the first return or arrival, and the other actions go on."""

import pytest
from core_driver import Driver, FaultyDriver
from core_scripts import play, scripts
from lint_programs import block
from team_programs import FREE, TEAM

from rosoclingo.reasoning.settings import CoreSettings

#: The documented program with durations: goals make(Kind,Steps,Id) of a workshop with a saw and a paint shop.
WORKSHOP = block("long_actions.md", "workshop.lp")

#: The name of each course, and its script.
COURSES = {
    "the first return ends the cycle": """
        add a job(saw,1); goal b job(drill,2); does drill,2,1 saw,1,1
        facts _return(saw,1,1); does drill,2,1; cycle 2; is a succeeded; is b active
        sends :- not _action_lib(drill,2,1). :- not _action_lib(saw,1,1). _running(drill,2,1). _return(saw,1,1).
        facts _return(drill,2,1); does; cycle 3; is b succeeded
        sends :- not _action_lib(drill,2,2). _return(drill,2,2).; done drill,2,1 saw,1,1; problems 0""",
    "a failed action is sent again": """
        add a job(saw,1); goal b job(drill,2); facts _return(saw,worn,1); does drill,2,1 saw,1,2
        sends ..._running(drill,2,1). _return(saw,worn,1).; facts _return(saw,1,1); problem ...has returned already...
        facts _return(drill,2,1); does saw,1,2; is b succeeded; is a active; facts _return(saw,1,2); is a succeeded
        done drill,2,1 saw,1,1 saw,1,2""",
    "time limits count from the dispatch": """
        goal a job(saw,1); pass 30; goal b job(drill,2); wait 19; cycle 2; wait 1; does drill,2,2 saw,1,3
        sends ..._running(drill,2,2). _return(saw,timeout,2).; wait 30; does saw,1,3 drill,2,4
        sends ..._running(saw,1,3). _return(drill,timeout,3).; problems 2""",
    "goals without a plan are aborted while actions run": """
        goal a job(saw,1); goal b job(broken,2); is b aborted; says b ...cannot be met...; does saw,1,1; is a active
        sends :- not _action_lib(saw,1,2). _running(saw,1,2). _request(cancel(2),3).
        facts _return(saw,1,1); is a succeeded; sends :- not _action_lib(saw,1,3). _return(saw,1,3).; done saw,1,1""",
    "a failure that names no action waits for the others of its interface": """
        add a job(saw,1); add b job(saw,2); goal c job(drill,3); facts _return(saw,worn,1); cycle 1
        facts _return(drill,3,1)
        sends ..._running(saw,1,1). _running(saw,2,1). _return(drill,3,1).; facts _return(saw,2,1); does saw,1,3
        sends :- not _action_lib(saw,1,2). :- not _action_lib(saw,2,2). _return(saw,worn,2). _return(saw,2,2).
        is b succeeded; is a active""",
    "a forgotten history keeps the running actions": """
        goal a job(saw,9); facts _seen(owl); facts _seen(cup); problem ERROR: ...forgets its history...; is a aborted
        does saw,9,1; sent #anew. _running(saw,9,2).; facts _return(saw,9,1); does
        sends :- not _action_lib(saw,9,3). _return(saw,9,3).; goal b job(drill,2); does drill,2,5""",
}


@scripts(COURSES)
def test_long_actions_follow_the_course(row):
    play(FaultyDriver(TEAM, CoreSettings(horizon_limit=8, action_timeout=50.0)), row)


def test_long_actions_wait_in_programs_without_running():
    text = TEAM.replace("#external _running/3.", "#defined _running/3.")
    play(
        Driver(text),
        """add a job(saw,1); goal b job(drill,2); facts _return(saw,1,1); cycle 1; does drill,2,1; goal c job(saw,3)
        facts _return(drill,2,1); cycle 2; does saw,3,2; unsent ..._running...
        sends :- not _action_lib(drill,2,1). :- not _action_lib(saw,1,1). _request(job(saw,3),3). ...""",
    )


LEFT_OUT = """goal a job(saw,1); goal b job(drill,2); cancel a; is a preempted; does saw,1,1 drill,2,2
    sent ..._running(saw,1,2). _running(drill,2,2). _request(cancel(1),3).; """


@pytest.mark.parametrize(
    ("preempt", "declared", "script"),
    [
        (
            False,
            False,
            "ends; facts _seen(owl); sends :- not _action_lib(drill,2,3). _running(saw,1,3). _running(drill,2,3). ...",
        ),
        (
            True,
            False,
            "ends saw,1,1; cycle 3; facts _return(saw,preempted,1); does drill,2,2; sends ..._return(saw,preempted,3).",
        ),
        (True, True, "ends saw,1,1; cycle 4; sends ..._running(saw,1,3). _running(drill,2,3). _cancel(saw,1,3)."),
    ],
)
def test_long_actions_that_a_plan_leaves_out(preempt, declared, script):
    text = FREE + "#external _cancel/3.\n" * declared
    play(Driver(text, CoreSettings(horizon_limit=8, preempt=preempt)), LEFT_OUT + script)


def workshop():
    """Return a driver of the documented program."""
    return Driver(WORKSHOP, CoreSettings(horizon_limit=20))


def planned(driver):
    """Return the plan from the present cycle on, as MACHINE ID CYCLE."""
    cycle, plan = driver.core.cycle, driver.core.plan
    return [f"{one.interface} {one.parameter} {one.cycle}" for one in plan.remaining(cycle)]


def test_durations_are_learned_and_planned():
    driver = play(
        workshop(), "goal a make(box,9,1); does saw,1,1; unsent ..._takes...; pass 25; facts _return(saw,1,1)"
    )
    play(
        driver,
        "sends :- not _action_lib(saw,1,1). _return(saw,1,1). _takes(saw,any,25).; pass 7; finish; is a succeeded",
    )
    play(driver, "add b make(box,9,2); add c make(sign,9,3); run; does paint,3,4 saw,2,4")
    assert planned(driver) == ["paint 3 4", "saw 2 4", "saw 2 5", "saw 2 6", "paint 2 7"]
    play(driver, "pass 12; facts _return(paint,3,4); sends ..._takes(paint,any,10).; does saw,2,4")
    play(driver, "pass 10; facts _return(saw,2,4); does paint,2,6; wait 10; finish; is b succeeded; problems 0")


def test_deadlines_that_cannot_be_kept_abort_the_goal():
    play(
        workshop(),
        """goal a make(box,1,1); is a aborted; says a ...cannot be met...; goal b make(box,3,2); does saw,2,...
        facts _return(saw,worn,3); facts _return(saw,worn,4); is b aborted; says b ...cannot be met...""",
    )


#: Durations of the saw in seconds, and the facts of the updates in which its return arrives.
MEASURED = {
    "the first one is that of the interface": ([3.2], ["..._takes(saw,any,4)."]),
    "the second one is that of the parameter": ([3.0, 3.0], ["..._takes(saw,any,3).", "..._takes(saw,7,3)."]),
    "another one replaces the last": (
        [10.0, 30.0],
        ["..._takes(saw,any,10).", "#withdraw _takes(saw,any,10). ..._takes(saw,7,20). _takes(saw,any,20)."],
    ),
    "one that lasts no time counts as a second": ([0.0], ["..._takes(saw,any,1)."]),
}


@scripts(MEASURED)
@pytest.mark.parametrize("learns", [True, False])
def test_durations_are_stated_as_medians(row, learns):
    driver = Driver(TEAM + "#external _takes/3.\n", CoreSettings(horizon_limit=8, learn_durations=learns))
    for seconds, stated in zip(*row):
        play(driver, f"goal key{driver.now} job(saw,7); pass {seconds}; succeed; problems 0")
        play(driver, f"sends {stated if learns and stated else f'..._return(saw,7,{driver.core.cycle - 1}).'}")
