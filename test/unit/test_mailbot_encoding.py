"""The mailbot encoding: plans are shortest, in every situation, and there is one wherever there can be one."""

from pathlib import Path

import pytest
from core_driver import Driver
from hypothesis import given, settings
from hypothesis import strategies as st
from mailbot_world import ENCODINGS, Mailbot, fewest_steps, neighbours

from rosoclingo.oclingo import ReactiveProgram, ReactiveSolver, parse_update
from rosoclingo.reasoning import CoreSettings

ROW = tuple((number, number + 1) for number in range(1, 6))
RING = ((1, 2), (2, 3), (3, 4), (4, 5), (5, 6), (6, 1))
FLOOR = ((1, 2), (2, 3), (3, 4), (4, 2), (4, 5), (5, 6))  # a loop between two dead ends
COMMON = ("failed", "timeout", "server_lost", "preempted", "stuck(door,1)", '"no idea"', "77")
MOVING = (*COMMON, "blocked", "unreachable", "unknown_label")
HANDLING = (*COMMON, "not_here", "unknown_package", "not_carried", "not_at_label", "full", "blocked")


# each example loads a program of its own, and a run takes as long as many single plans
PLANS = settings(max_examples=max(1, settings.default.max_examples // 3))
RUNS = settings(max_examples=max(1, settings.default.max_examples // 8))


@st.composite
def floors(draw):
    """Number of offices, corridors of a connected floor, start, capacity."""
    count = draw(st.integers(3, 6))
    corridors = {(draw(st.integers(1, number - 1)), number) for number in range(2, count + 1)}
    pairs = st.tuples(st.integers(1, count), st.integers(1, count)).filter(lambda pair: pair[0] != pair[1])
    corridors |= set(draw(st.lists(pairs, max_size=3)))
    return count, tuple(sorted(corridors)), draw(st.integers(1, count)), draw(st.integers(1, 3))


@PLANS
@given(st.data())
def test_plans_are_shortest(data):
    """One batch of requests, some with the same offices, some that stay where they are."""
    count, corridors, start, capacity = data.draw(floors())
    robot = Mailbot(count, corridors, start, capacity)
    offices = st.integers(1, count)
    for number, (source, target) in enumerate(data.draw(st.lists(st.tuples(offices, offices), min_size=1, max_size=4))):
        robot.request(number + 1, source, target)
    assert robot.plan()


@RUNS
@given(st.data())
def test_plans_are_shortest_at_any_time(data):
    """Runs with requests, cancellations, failures and idle cycles in any order; ids are used again."""
    count, corridors, start, capacity = data.draw(floors())
    robot = Mailbot(count, corridors, start, capacity)
    for _ in range(data.draw(st.integers(1, 20), label="cycles")):
        happens(robot, data, count)
        ahead = robot.plan()
        if ahead is None:
            give_up(robot)
            ahead = robot.plan()
            assert ahead is not None
        if ahead:
            outcome = data.draw(st.sampled_from(["works", "works", "works", "fails", "skipped"]))
            reasons = MOVING if ahead[0].arguments[0].name == "move_base" else HANDLING
            if outcome != "skipped":
                robot.act(ahead[0], data.draw(st.sampled_from(reasons)) if outcome == "fails" else None)
    finish(robot)


def happens(robot, data, count):
    """A request or a cancellation arrives, or nothing."""
    free = [number for number in range(1, 5) if not robot.places.get(number)]
    taken = [number for number in range(1, 5) if robot.places.get(number)]
    event = data.draw(st.sampled_from(["nothing", "nothing", "request", "requests", "cancel", "cancel_what_is_over"]))
    if event.startswith("request"):
        for number in free[: 1 if event == "request" else 2]:
            robot.request(number, data.draw(st.integers(1, count)), data.draw(st.integers(1, count)))
    elif event == "cancel" and taken:
        robot.cancel(data.draw(st.sampled_from(taken)))
    elif event == "cancel_what_is_over" and free:
        robot.cancel(free[0])


def give_up(robot):
    """Cancel what can't be met; there has to be a plan for the rest."""
    hopeless = robot.hopeless()
    assert hopeless
    for identifier in hopeless:
        robot.cancel(identifier)


def finish(robot):
    """Let all actions work and give up what can't be met; return how many actions there were."""
    for done in range(200):
        ahead = robot.plan()
        if ahead is None:
            give_up(robot)
            continue
        if not ahead:
            return done
        robot.act(ahead[0])
    raise AssertionError("the robot never comes to rest")


def ends(robot):
    return {identifier: end for identifier, (end, _) in robot.ends.items()}


@pytest.mark.parametrize("corridors", [ROW, RING, FLOOR])
@pytest.mark.parametrize("capacity", [1, 2, 3])
def test_more_packages_than_fit(corridors, capacity):
    robot = Mailbot(6, corridors, 3, capacity)
    for number in range(1, 6):
        robot.request(number, number % 2 + 1, 6 - number % 3)
    finish(robot)
    assert set(ends(robot).values()) == {"succeeded"}


def test_idle_cycles_do_no_harm():
    robot = Mailbot(6, ROW)
    robot.request(1, 4, 2)
    robot.act(robot.plan()[0])
    for _ in range(12):
        robot.plan()
    finish(robot)
    assert ends(robot) == {1: "succeeded"}


@pytest.mark.parametrize("reason", ["failed", "timeout", "server_lost", "blocked"])
def test_no_failure_is_tried_for_ever(reason):
    """Whatever the robot tries fails: the request ends, and the next one finds the robot ready to try again."""
    robot = Mailbot(6, FLOOR)
    robot.request(1, 3, 6)
    ahead = robot.plan()
    while ahead is not None:
        assert robot.cycle < 20
        robot.act(ahead[0], reason)
        ahead = robot.plan()
    give_up(robot)
    assert robot.plan() == []
    robot.request(2, 3, 6)
    finish(robot)
    assert ends(robot) == {1: "canceled", 2: "succeeded"}


def test_a_detour_is_taken_while_a_connection_is_blocked():
    robot = Mailbot(6, RING)
    robot.request(1, 3, 1)
    assert str(robot.plan()[0].arguments[1]) == "o2"
    robot.act(robot.plan()[0], "blocked")
    assert [str(one.arguments[1]) for one in robot.plan()[:4]] == ["o6", "o5", "o4", "o3"]
    finish(robot)
    robot.request(2, 1, 2)
    assert str(robot.plan()[0].arguments[1]) == "2"
    finish(robot)
    assert ends(robot) == {1: "succeeded", 2: "succeeded"}


def test_preempted_says_nothing():
    robot = Mailbot(6, ROW)
    robot.request(1, 2, 1)
    for _ in range(5):
        robot.act(robot.plan()[0], "preempted")
    finish(robot)
    assert ends(robot) == {1: "succeeded"}


def test_cancel_and_failure_together():
    robot = Mailbot(6, ROW)
    robot.request(1, 1, 3)
    robot.act(robot.plan()[0], "failed")
    robot.cancel(1)
    assert robot.plan() == []
    robot.request(1, 1, 3)
    robot.act(robot.plan()[0])
    robot.act(robot.plan()[0])
    robot.act(robot.plan()[0], "blocked")
    robot.cancel(1)
    assert finish(robot) == 2
    assert ends(robot) == {1: "canceled"}


def test_a_package_that_cannot_be_brought_back_stays_on_the_robot():
    """Until the way is open again: then it is brought back after all."""
    robot = Mailbot(6, ROW)
    robot.request(1, 1, 3)
    for _ in range(2):
        robot.act(robot.plan()[0])
    robot.request(2, 2, 1)
    robot.act(robot.plan()[0])
    robot.cancel(1)
    robot.act(robot.plan()[0], "blocked")
    assert robot.plan() is None
    robot.cancel(2)
    finish(robot)
    assert robot.places == {1: ("rides", "o1"), 2: None}
    robot.request(3, 1, 2)
    finish(robot)
    assert robot.places == {1: None, 2: None, 3: None}
    assert ends(robot) == {1: "canceled", 2: "canceled", 3: "succeeded"}


def test_a_request_replaces_a_live_one_of_the_same_id():
    robot = Mailbot(6, ROW, 1)
    robot.request(1, 6, 1)
    robot.act(robot.plan()[0])
    robot.request(1, 2, 1)
    assert len(robot.plan()) == fewest_steps(robot.graph, 3, "o2", [("waits", "o2", "o1")])


def answers(update, *files, models=1):
    solver = ReactiveSolver(ReactiveProgram.from_files(files), models=models, shortest=True, oclingo_strings=False)
    return solver.update(parse_update(update)).answers


@pytest.mark.parametrize("offices", ["nowhere,office1", "office1,nowhere", "7,f(x)"])
def test_unknown_offices_are_rejected(offices):
    update = f"#step 1. _request(goal({offices},1),2). #endstep."
    found = answers(update, ENCODINGS / "mailbot.lp", ENCODINGS / "office.lp")[0]
    assert {str(one)[: len("_status(1,rejected(")] for one in found} == {"_status(1,rejected("}
    unknown = [one for one in offices.split(",", 1) if one != "office1"]
    assert sorted(str(one) for one in found) == sorted(
        f'_status(1,rejected(("there is no place ",{one})),1)' for one in unknown
    )


def test_an_office_without_a_way_to_it_is_rejected(tmp_path: Path):
    island = tmp_path / "island.lp"
    island.write_text("office(attic).", encoding="utf-8")
    update = "#step 1. _request(goal(office1,attic,1),2). #endstep."
    found = answers(update, ENCODINGS / "mailbot.lp", ENCODINGS / "office.lp", island)[0]
    assert [str(one) for one in found] == ['_status(1,rejected(("no way leads to ",attic)),1)']


def test_bounds_change_no_plan(tmp_path: Path):
    """Without the search file there are exactly the same shortest plans."""
    for file in ("mailbot.lp", "delivery.lp", "delivery_faults.lp"):
        text = (ENCODINGS / file).read_text(encoding="utf-8")
        (tmp_path / file).write_text(text.replace('#include "delivery_search.lp".', ""), encoding="utf-8")
    update = "#step 1. _request(goal(office3,office1,1),2). _request(goal(office2,office4,2),2). #endstep."
    found = [
        answers(update, folder / "mailbot.lp", ENCODINGS / "office.lp", models=0) for folder in (tmp_path, ENCODINGS)
    ]
    assert len(set(found[0])) == len(found[0])
    assert set(found[0]) == set(found[1])
    assert found[0]


def test_the_search_that_plans_are_compared_with():
    graph = neighbours([(f"o{a}", f"o{b}") for a, b in ROW])
    assert fewest_steps(graph, 3, "o1", [("waits", "o3", "o2")]) == 5
    assert fewest_steps(graph, 1, "o1", [("waits", "o1", "o2"), ("waits", "o1", "o2")]) == 7
    assert fewest_steps(graph, 2, "o1", [("waits", "o1", "o2"), ("waits", "o1", "o2")]) == 5
    assert fewest_steps(graph, 3, "o1", [("rides", "o2"), None]) == 2
    assert fewest_steps(graph, 3, "o1", [("rides", "o1")], astray=True) == 2
    assert fewest_steps(graph, 3, "o1", [("rides", "o2")], shut={frozenset(("o1", "o2"))}) is None
    assert fewest_steps(graph, 1, "o1", [("stuck",), ("waits", "o1", "o2")]) is None


def test_what_is_remembered_of_a_long_run_does_not_grow():
    """As long as a bound is kept (``window``), the requests of its cycle are; all else that is over is forgotten."""
    files = [ENCODINGS / "mailbot.lp", ENCODINGS / "office.lp"]
    driver = Driver(settings=CoreSettings(), program=ReactiveProgram.from_files(files, {"window": "20"}))
    number = 0
    while driver.core.cycle < 80:
        number += 1
        driver.goal(str(number), f"goal(office{number % 4 + 1},office{number % 3 + 1},{number})").finish()
    past = driver.core._planner._solver.snapshot().past
    assert past.first > 40
    times = [atom.arguments[-1].number for atom in past.facts if atom.name in ("waiting", "aim", "crossed")]
    assert min(times) >= past.first - 20
