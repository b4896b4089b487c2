"""The mailbot encoding: plans are shortest, in every situation, and no situation leaves it without a plan."""

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mailbot_world import ENCODINGS, Mailbot, fewest_steps, neighbours

from rosoclingo.oclingo import ReactiveProgram, ReactiveSolver, parse_update

ROW = tuple((number, number + 1) for number in range(1, 6))
RING = ((1, 2), (2, 3), (3, 4), (4, 5), (5, 6), (6, 1))
FLOOR = ((1, 2), (2, 3), (3, 4), (4, 2), (4, 5), (5, 6))  # a loop between two dead ends
REASONS = ("failed", "blocked", "timeout", "server_lost", "stuck(door,1)", '"no idea"', "7")


# a run takes as long as many single plans
RUNS = settings(max_examples=max(1, settings.default.max_examples // 4))


@st.composite
def floors(draw):
    """Number of offices, corridors of a connected floor, start, capacity."""
    count = draw(st.integers(3, 6))
    corridors = {(draw(st.integers(1, number - 1)), number) for number in range(2, count + 1)}
    pairs = st.tuples(st.integers(1, count), st.integers(1, count)).filter(lambda pair: pair[0] != pair[1])
    corridors |= set(draw(st.lists(pairs, max_size=3)))
    return count, tuple(sorted(corridors)), draw(st.integers(1, count)), draw(st.integers(1, 3))


@given(st.data())
def test_plans_are_shortest(data):
    """One batch of requests, some with the same offices, some that stay where they are."""
    count, corridors, start, capacity = data.draw(floors())
    robot = Mailbot(count, corridors, start, capacity)
    offices = st.integers(1, count)
    for number, (source, target) in enumerate(data.draw(st.lists(st.tuples(offices, offices), min_size=1, max_size=4))):
        robot.request(number + 1, source, target)
    robot.plan()


@RUNS
@given(st.data())
def test_plans_are_shortest_at_any_time(data):
    """Runs with requests, cancellations, failures and idle cycles in any order; ids are used again."""
    count, corridors, start, capacity = data.draw(floors())
    robot = Mailbot(count, corridors, start, capacity)
    for _ in range(data.draw(st.integers(1, 20), label="cycles")):
        happens(robot, data, count)
        ahead = robot.plan()
        outcome = data.draw(st.sampled_from(["works", "works", "works", "fails", "skipped"]))
        if ahead and outcome != "skipped":
            robot.act(ahead[0], data.draw(st.sampled_from(REASONS)) if outcome == "fails" else None)
    for _ in range(80):
        ahead = robot.plan()
        if not ahead:
            break
        robot.act(ahead[0])
    assert not any(robot.places.values())


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


def finish(robot):
    """Let all actions work; return how many there were."""
    for done in range(200):
        ahead = robot.plan()
        if not ahead:
            return done
        robot.act(ahead[0])
    raise AssertionError("the robot never comes to rest")


@pytest.mark.parametrize("corridors", [ROW, RING, FLOOR])
@pytest.mark.parametrize("capacity", [1, 2, 3])
def test_more_packages_than_fit(corridors, capacity):
    robot = Mailbot(6, corridors, 3, capacity)
    for number in range(1, 6):
        robot.request(number, number % 2 + 1, 6 - number % 3)
    finish(robot)
    assert set(robot.ends.values()) == {"succeeded"}


def test_idle_cycles_do_no_harm():
    robot = Mailbot(6, ROW)
    robot.request(1, 4, 2)
    robot.act(robot.plan()[0])
    for _ in range(12):
        robot.plan()
    finish(robot)
    assert robot.ends == {1: "succeeded"}


def test_failures_in_a_row():
    robot = Mailbot(6, FLOOR)
    robot.request(1, 3, 6)
    for _ in range(6):
        for reason in REASONS:
            robot.act(robot.plan()[0], reason)
        robot.act(robot.plan()[0])
    assert finish(robot) == 1
    assert robot.ends == {1: "succeeded"}


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
    assert robot.ends == {1: "canceled"}


def test_a_request_replaces_a_live_one_of_the_same_id():
    robot = Mailbot(6, ROW, 1)
    robot.request(1, 6, 1)
    robot.act(robot.plan()[0])
    robot.request(1, 2, 1)
    assert len(robot.plan()) == fewest_steps(robot.graph, 3, "o2", [("waits", "o2", "o1")])


@pytest.mark.parametrize("offices", ["nowhere,office1", "office1,nowhere", "7,f(x)"])
def test_unknown_offices_are_rejected(offices):
    program = ReactiveProgram.from_files([ENCODINGS / "mailbot.lp", ENCODINGS / "office.lp"])
    solver = ReactiveSolver(program, shortest=True)
    answer = solver.update(parse_update(f"#step 1. _request(goal({offices},1),2). #endstep.")).answers[0]
    assert [str(one) for one in answer] == ["_status(1,rejected,1)"]


def test_bounds_change_no_plan(tmp_path: Path):
    """Without the search file there are exactly the same shortest plans."""
    text = (ENCODINGS / "mailbot.lp").read_text(encoding="utf-8")
    bare = tmp_path / "mailbot.lp"
    bare.write_text(text.replace('#include "mailbot_search.lp".', ""), encoding="utf-8")
    update = "#step 1. _request(goal(office3,office1,1),2). _request(goal(office2,office4,2),2). #endstep."
    found = []
    for file in (bare, ENCODINGS / "mailbot.lp"):
        solver = ReactiveSolver(ReactiveProgram.from_files([file, ENCODINGS / "office.lp"]), models=0, shortest=True)
        answers = solver.update(parse_update(update)).answers
        assert len(set(answers)) == len(answers)
        found.append(set(answers))
    assert found[0] == found[1]
    assert found[0]


def test_the_search_that_plans_are_compared_with():
    graph = neighbours([(f"o{a}", f"o{b}") for a, b in ROW])
    assert fewest_steps(graph, 3, "o1", [("waits", "o3", "o2")]) == 5
    assert fewest_steps(graph, 1, "o1", [("waits", "o1", "o2"), ("waits", "o1", "o2")]) == 7
    assert fewest_steps(graph, 2, "o1", [("waits", "o1", "o2"), ("waits", "o1", "o2")]) == 5
    assert fewest_steps(graph, 3, "o1", [("rides", "o2"), None]) == 2
