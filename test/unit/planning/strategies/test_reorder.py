"""Candidates for shorter plans: tasks in another order, by transitions that the plan itself contains."""

import re
from itertools import accumulate
from random import Random

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from mailbot_world import neighbours
from office_world import Office

from rosoclingo.oclingo import parse_atom
from rosoclingo.planning.history import Plan, cycle_of
from rosoclingo.planning.strategies.reorder import reordered, time_cost
from rosoclingo.planning.strategies.tour_actions import durations_of, moving_kinds, tour_actions
from rosoclingo.reasoning.keywords import action_of

#: Twice from a over b to c and back; 7 steps suffice.
TO_AND_FRO = "go a; go b; go c; water fern; go b; go a; water rose; go b; go c; water lily; go b; go a; water ivy"

CAPACITY = 2

NO_DURATIONS = {}


def plan_of(acts, first=1):
    """Return the plan with these acts in sequence, such as "go a; take b"."""
    texts = [one.split(" ", 1) for one in acts.split("; ") if one]
    actions = [f"_action_lib({kind},{what},{cycle})" for cycle, (kind, what) in enumerate(texts, first)]
    return Plan(frozenset(map(parse_atom, actions)), first + len(texts) - 1)


def acts_of(plan):
    return [f"{one.arguments[0]} {one.arguments[1]}" for one in sorted(plan.actions, key=cycle_of)]


def candidate(plan, step=0, stopped=lambda: False, seed=1, possible=(), durations=NO_DURATIONS):
    """Return a candidate; ``possible`` are acts that were possible before the plan."""
    first = sorted(plan_of("; ".join(possible)).actions)
    return reordered(
        plan, step, Random(seed), stopped, first, durations, lambda other: time_cost(other, plan, step, durations)
    )


@pytest.mark.parametrize("first", [1, 40])
def test_reordered_joins_tasks_at_one_place(first):
    found = candidate(plan_of(TO_AND_FRO, first), first)
    assert found.horizon == first + 6
    assert sorted(map(cycle_of, found.actions)) == [*range(first + 1, first + 7)]
    assert acts_of(found)[2:4] == ["go b", "go c"]
    back = [candidate(plan_of(TO_AND_FRO + "; go b"), 1, seed=seed) for seed in range(8)]
    assert {one.horizon - (acts_of(one)[-1] == "go b") for one in back} == {7}
    assert len({one.horizon for one in back}) == 2, "the last move can be needed or superfluous"


def do(office, acts):
    """Execute acts in an office; AssertionError if one is impossible."""
    for act in acts:
        office.do(action_of(parse_atom("_action_lib({},{},1)".format(*act.split()))))


def some_plan(office, draw):
    """Return a random plan as acts that move all packages, and execute it."""
    acts = []
    while any(office.packages.values()):
        ready = [("deliver", one) for one, place in office.packages.items() if place and place[0] == "rides"]
        if len(ready) < CAPACITY:
            ready += [("pickup", one) for one, place in office.packages.items() if place and place[0] == "waits"]
        kind, number = draw.choice(ready)
        here, there = (int(place[1:]) for place in (office.robot, office.packages[number][1]))
        way = range(here + 1, there + 1) if there > here else range(here - 1, there - 1, -1)
        acts += (new := [*(f"move_base o{one}" for one in way), f"{kind} {number}"])
        do(office, new)
    return acts


@pytest.mark.slow
@given(
    st.lists(st.tuples(st.integers(0, 5), st.integers(0, 5)), min_size=2, max_size=6), st.integers(0, 2), st.randoms()
)
def test_reordered_plans_are_shorter_and_obey_the_rules(ends, carried, draw):
    """They carry no more at once than the plan before."""
    corridor = neighbours([(f"o{one}", f"o{one + 1}") for one in range(5)])
    packages = {
        one: ("waits", f"o{a}", f"o{b}") if one >= carried else ("rides", f"o{b}") for one, (a, b) in enumerate(ends)
    }
    acts = some_plan(Office(corridor, CAPACITY, "o0", packages), draw)
    step = draw.randrange(len(acts))
    found = candidate(plan_of("; ".join(acts)), step, possible=["move_base o1"])
    if found is not None:
        loads = accumulate([carried, *(("pickup" in act) - ("deliver" in act) for act in acts)])
        office = Office(corridor, max(loads), "o0", packages)
        do(office, acts[:step] + acts_of(found))
        assert not any(office.packages.values())
        assert found.horizon == step + len(found.actions) < len(acts)


# ---- Several robots --------------------------------------------------------------------------------------------------


def fleet_plan(tours):
    """Return the plan in which each robot, the argument of its interfaces, does its acts without waiting."""
    plans = [plan_of(re.sub(r"(\w+) (\w+)", rf"\1({robot}) \2", acts)) for robot, acts in tours.items()]
    return Plan(frozenset().union(*(one.actions for one in plans)), max(one.horizon for one in plans))


def tours_of(plan, step):
    """Return the acts of each robot from ``step + 1`` on; AssertionError if a robot waits."""
    tours = {}
    for one in sorted(plan.actions, key=cycle_of):
        kind = one.arguments[0]
        acts = tours.setdefault(str(kind.arguments[0]), [])
        acts.append(f"{kind.name} {one.arguments[1]}")
        assert cycle_of(one) == step + len(acts)
    return tours


def test_reordered_gives_tasks_to_the_robot_with_less_to_do():
    busy = "go a; go b; go c; take 1; go b; go a; put 1; go b; go c; take 2; go b; go a; put 2"
    found = candidate(fleet_plan({"r1": busy, "r2": "go b; go a"}), 1)
    tours = tours_of(found, 1)
    assert found.horizon == 1 + max(map(len, tours.values())) == 7
    assert all(len([act for act in tours[robot] if act.startswith("take")]) == 1 for robot in ("r1", "r2"))


def test_reordered_uses_idle_robots_in_some_searches():
    busy = "go a; go b; go c; take 1; go b; go a; put 1; go b; go c; take 2; go b; go a; put 2"
    found = [candidate(fleet_plan({"r1": busy, "r2": "go b"}), 1, seed=seed) for seed in range(8)]
    assert {one is None for one in found} == {True, False}, "r2 can be out of service"


def test_reordered_gives_tasks_to_an_idle_robot_that_does_them_sooner():
    """Robot r1 can do all tasks before r3 ends; with r2, one of them is done earlier."""
    long = "go b; go c; go d; go e; go f; take 9; go e; go d; go c; go b; put 9"
    plan = fleet_plan({"r1": "go a; go b; take 1; go c; put 1; go b; take 2; go c; put 2", "r2": "go b", "r3": long})
    found = [one for one in (candidate(plan, 1, seed=seed) for seed in range(8)) if one is not None]
    assert any("take 2" in tours_of(one, 1).get("r2", ()) for one in found)
    assert all(one.horizon == plan.horizon for one in found)


def test_reordered_uses_the_ways_of_earlier_moves():
    """The plan has no move of r2 left, but r2 came from b."""
    busy = "go b; go c; go d; go c; take 1; go b; put 1; go c; take 2; go b; put 2"
    found = [candidate(fleet_plan({"r1": busy, "r2": "go b; go a; go x"}), 3, seed=seed) for seed in range(8)]
    tours = [tours_of(one, 3).get("r2", ["-"]) for one in found if one is not None]
    assert any(one[0] == "go a" and "take 2" in one for one in tours)


def test_reordered_leaves_packages_with_the_robots_that_carry_them():
    """No pickup is left in the plan, which could tell that the packages are on board."""
    busy = "go a; take 1; take 2; go b; go c; go d; put 1; go c; go b; put 2"
    found = [candidate(fleet_plan({"r1": busy, "r2": "go a; go b; go c"}), 3, seed=seed) for seed in range(8)]
    assert any(found)
    assert all({"put 1", "put 2"}.issubset(tours_of(one, 3)["r1"]) for one in found if one is not None)


def test_reordered_saves_time_with_more_steps():
    plan = fleet_plan({"r1": "go b; take 1; take 2", "r2": "go c; go b; take 3"})
    slow = durations_of(map(parse_atom, ["_takes(go(r1),any,8)", "_takes(take(r1),any,1)", "_takes(take(r1),pen,9)"]))
    assert [candidate(plan, seed=seed) for seed in range(5)] == [None] * 5
    found = candidate(plan, durations=slow)
    assert tours_of(found, 0).keys() == {"r1"}
    assert found.horizon == plan.horizon + 1


def test_durations_of_facts_are_means_of_robots():
    facts = ["_takes(go(r1),any,8)", "_takes(go(r2),any,4)", "_takes(go(r2),b,99)", "_takes(put,any,0)"]
    unusable = ["_takes(go(r1),any,long)", "_takes(go(r1),any,-1)", "_takes(1,any,5)"]
    found = durations_of(map(parse_atom, [*facts, *unusable]))
    assert {str(kind): seconds for kind, seconds in found.items()} == {"go": 6, "put": 0}
    plan = fleet_plan({"r1": "put 1; put 2", "r2": "go a"})
    assert time_cost(plan, plan, 0, durations_of([parse_atom("_takes(put(r1),any,0)")])) > (0.0, 0)


def test_reordered_uses_other_first_moves():
    """The plan begins with a detour; the robot has not moved before, so nothing but the program knows its place."""
    plan = plan_of("go a; go b; take 1; go a; go b; put 1; take 2; put 2")
    assert {acts_of(candidate(plan, seed=seed))[0] for seed in range(8)} == {"go a"}
    assert {acts_of(candidate(plan, seed=seed, possible=["go b"]))[0] for seed in range(8)} == {"go b"}


@pytest.mark.slow
@given(
    st.lists(st.tuples(st.integers(0, 5), st.integers(0, 5)), min_size=2, max_size=8), st.integers(2, 3), st.randoms()
)
def test_reordered_plans_of_several_robots_take_less_time_and_obey_the_rules(ends, robots, draw):
    """Each package is moved by one robot, and stays with it once it is on board; no robot carries more than it can."""
    corridor, packages, tours, offices = neighbours([(f"o{one}", f"o{one + 1}") for one in range(5)]), {}, {}, {}
    for number, (a, b) in enumerate(ends):
        packages.setdefault(f"r{draw.randint(1, robots)}", {})[number] = ("waits", f"o{a}", f"o{b}")
    for robot, own in packages.items():
        tours[robot] = some_plan(Office(corridor, CAPACITY, "o0", own), draw)
    plan = fleet_plan({robot: "; ".join(acts) for robot, acts in tours.items()})
    assume(moving_kinds([], tour_actions(plan.actions, by_robot=True)))  # a move repeats
    step = draw.randrange(plan.horizon)
    found = candidate(plan, step, possible=[f"move_base({robot}) o1" for robot in packages])
    if found is None:
        return
    waiting = {}
    for robot, own in packages.items():
        office = offices[robot] = Office(corridor, CAPACITY, "o0", own)
        do(office, tours[robot][:step])
        waiting.update({number: one for number, one in office.packages.items() if one and one[0] == "waits"})
    left, found_tours = dict(waiting), tours_of(found, step)
    for robot, office in offices.items():
        aboard = {number: one for number, one in office.packages.items() if one and one[0] == "rides"}
        office.packages = {**aboard, **left}
        do(office, found_tours.get(robot, []))
        left = {number: one for number, one in office.packages.items() if one}
    assert not left
    assert time_cost(found, plan, step, NO_DURATIONS) < time_cost(plan, plan, step, NO_DURATIONS)
