"""The deliveries that benches measure: instances, the rules; checked by the mailbot's world."""

import sys
from pathlib import Path

import pytest
from mailbot_world import fewest_steps, neighbours

from rosoclingo.oclingo import ReactiveProgram, StreamUpdate, fact, parse_term
from rosoclingo.oclingo.program.sources import Source
from rosoclingo.planning.history import Plan
from rosoclingo.planning.solver import PlanSolver

ROOT = Path(__file__).resolve().parents[3]
sys.path.append(str(ROOT / "bench"))

import deliveries  # noqa: E402
from deliveries import Request, RuleError, World  # noqa: E402

FLOORS = [deliveries.row(4), deliveries.row(7), deliveries.loops()]


def world(*requests, floor=FLOORS[0]):
    made = World(floor)
    made.ask(requests)
    return made


def test_the_floor_with_loops_has_two():
    floor = deliveries.loops()
    assert len(floor.corridors) - floor.offices + 1 == 2


def test_requests_are_between_two_offices_and_the_same_for_the_same_seed():
    requests = deliveries.random_requests(FLOORS[0], 50, seed=1)
    assert [request.number for request in requests] == list(range(1, 51))
    assert all(request.start != request.end for request in requests)
    assert {one for request in requests for one in request[1:]} == {1, 2, 3, 4}
    assert requests == deliveries.random_requests(FLOORS[0], 50, seed=1)
    assert requests != deliveries.random_requests(FLOORS[0], 50, seed=2)


@pytest.mark.parametrize("name", ["1", "0", "-3", "ring", ""])
def test_a_floor_that_is_none_is_told(name):
    with pytest.raises(ValueError, match="a floor is"):
        deliveries.floor_named(name)


def test_floors_by_name():
    assert deliveries.floor_named("7") == deliveries.row(7)
    assert deliveries.floor_named("loops") == deliveries.loops()


@pytest.mark.parametrize(
    ("before", "action", "told"),
    [
        ([], ("move_base", "office3"), "no corridor leads from office 1 to 3"),
        ([], ("move_base", "office1"), "no corridor"),
        ([], ("move_base", "office9"), "no corridor"),
        ([], ("pickup", "2"), "package 2 does not wait at office 1"),
        ([], ("pickup", "9"), "package 9 does not wait"),
        ([("pickup", "1")], ("pickup", "1"), "package 1 does not wait"),
        ([("pickup", "1"), ("pickup", "3"), ("pickup", "4")], ("pickup", "5"), "one too many"),
        ([("pickup", "1")], ("deliver", "1"), "does not belong to office 1"),
        ([("move_base", "office2")], ("deliver", "1"), "package 1 is not on the robot"),
        (
            [("pickup", "1"), ("move_base", "office2"), ("deliver", "1")],
            ("deliver", "1"),
            "package 1 is not on the robot",
        ),
        ([], ("fly", "office2"), "no action fly"),
    ],
)
def test_what_is_against_the_rules_is_refused_and_changes_nothing(before, action, told):
    here = world(Request(1, 1, 2), Request(2, 2, 1), Request(3, 1, 4), Request(4, 1, 4), Request(5, 1, 4))
    for one in before:
        here.do(*one)
    left = here.copy()
    with pytest.raises(RuleError, match=told):
        here.do(*action)
    assert vars(here) == vars(left)


def test_a_copy_goes_its_own_way():
    here = world(Request(1, 1, 2))
    there = here.copy()
    there.do("pickup", "1")
    assert (here.actions, len(here.waiting), here.carried) == (0, 1, {})
    assert (there.actions, there.waiting, len(there.carried)) == (1, {}, 1)


@pytest.mark.parametrize(
    "floor",
    [FLOORS[0], *(pytest.param(one, marks=[pytest.mark.slow, pytest.mark.once]) for one in FLOORS[1:])],
    ids=lambda floor: floor.name,
)
def test_shortest_plans_keep_the_rules_and_none_is_shorter(floor):
    requests = deliveries.random_requests(floor, 3, seed=1)
    program = ReactiveProgram([Source.from_file(ROOT / "encodings" / "mailbot.lp"), Source(floor.name, floor.instance)])
    told = tuple(fact(parse_term(f"_request({request.goal},2)")) for request in requests)
    result = PlanSolver(program, horizon_limit=200).update(StreamUpdate(1, None, told))
    actions = sorted((one.arguments for one in Plan.from_result(result).actions), key=lambda action: action[2].number)
    here = world(*requests, floor=floor)
    for interface, parameter, _ in actions:
        here.do(str(interface), str(parameter))
    assert here.open == 0
    waiting = [("waits", request.start, request.end) for request in requests]
    assert here.actions == fewest_steps(neighbours(floor.corridors), deliveries.CAPACITY, 1, waiting)
