"""The mailbot encoding: plans are shortest, in every situation, and there is one wherever there can be one."""

import shutil
from pathlib import Path

import pytest
from core_driver import Driver, shortest
from hypothesis import given, settings
from hypothesis import strategies as st
from mailbot_world import Mailbot, fewest_steps, neighbours
from shipped import ENCODINGS, shipped
from workloads import sized

from rosoclingo.oclingo import ReactiveProgram, parse_update
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.reasoning.explanations import text_of
from rosoclingo.reasoning.settings import CoreSettings

ROW = tuple((number, number + 1) for number in range(1, 6))
RING = ((1, 2), (2, 3), (3, 4), (4, 5), (5, 6), (6, 1))
FLOOR = ((1, 2), (2, 3), (3, 4), (4, 2), (4, 5), (5, 6))  # a loop between two dead ends
COMMON = ("failed", "timeout", "server_lost", "preempted", "stuck(door,1)", '"no idea"', "77", "move_base", '"o2"')
OTHERS = ("o1", "o2", "o3", "1", "2", "3")  # what other actions are about
MOVING = (*COMMON, "blocked", "unreachable", "unknown_label")
HANDLING = (*COMMON, "not_here", "unknown_package", "not_carried", "not_at_label", "full", "blocked")


# each example loads a program of its own, and a run takes as long as many single plans
PLANS = settings(max_examples=max(1, settings.default.max_examples // 5))
RUNS = settings(max_examples=max(1, settings.default.max_examples // 12))


RARE = [pytest.mark.slow, pytest.mark.once]


@st.composite
def floors(draw):
    """Number of offices, corridors of a connected floor, start, capacity."""
    count = draw(st.integers(3, 6))
    corridors = {(draw(st.integers(1, number - 1)), number) for number in range(2, count + 1)}
    pairs = st.tuples(st.integers(1, count), st.integers(1, count)).filter(lambda pair: pair[0] != pair[1])
    corridors |= set(draw(st.lists(pairs, max_size=3)))
    return count, tuple(sorted(corridors)), draw(st.integers(1, count)), draw(st.integers(1, 3))


@pytest.mark.slow
@pytest.mark.once
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


@pytest.mark.slow
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
                reason = data.draw(st.sampled_from([one for one in (*reasons, *OTHERS) if one != what(ahead[0])]))
                robot.act(ahead[0], reason if outcome == "fails" else None)
    finish(robot)


def what(action):
    return str(action.arguments[1])


def happens(robot, data, count):
    """A request or a cancellation arrives, or nothing."""
    free = [number for number in range(1, 5) if robot.places.get(number) in (None, ("stuck",))]
    taken = [number for number in range(1, 5) if robot.places.get(number)]
    event = data.draw(st.sampled_from(["nothing", "nothing", "request", "requests", "cancel", "cancel_what_is_over"]))
    if event.startswith("request"):
        for number in free[: 1 if event == "request" else 2]:
            origin = int(robot.origins.get(number, "o1")[1:])
            robot.request(
                number, data.draw(st.sampled_from([origin, *range(1, count + 1)])), data.draw(st.integers(1, count))
            )
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


@pytest.mark.slow
@pytest.mark.once
@pytest.mark.parametrize(("corridors", "capacity"), [(ROW, 3), (RING, 1), (FLOOR, 3)])
def test_more_packages_than_fit(corridors, capacity):
    robot = Mailbot(6, corridors, 3, capacity)
    for number in range(1, capacity + 3):
        robot.request(number, number % 2 + 1, 6 - number % 3)
    finish(robot)
    assert set(ends(robot).values()) == {"succeeded"}


@pytest.mark.slow
@pytest.mark.once
def test_idle_cycles_do_no_harm():
    robot = Mailbot(6, ROW)
    robot.request(1, 4, 2)
    robot.act(robot.plan()[0])
    for _ in range(12):
        robot.plan()
    finish(robot)
    assert ends(robot) == {1: "succeeded"}


@pytest.mark.slow
@pytest.mark.once
@pytest.mark.parametrize("reason", ["failed", "blocked"])
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


@pytest.mark.slow
@pytest.mark.once
def test_a_place_that_was_unknown_is_tried_again_when_somebody_asks_for_it():
    robot = Mailbot(3, ROW[:2])
    robot.request(1, 1, 3)
    robot.act(robot.plan()[0])
    robot.act(robot.plan()[0])
    robot.act(robot.plan()[0], "unknown_label")
    assert robot.plan() is None, "nobody has asked since"
    give_up(robot)
    finish(robot)
    for identifier in (2, 3):
        robot.request(identifier, 2, 3)
        finish(robot)
    assert ends(robot) == {1: "canceled", 2: "succeeded", 3: "succeeded"}


@pytest.mark.slow
@pytest.mark.once
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


@pytest.mark.slow
@pytest.mark.once
@pytest.mark.parametrize("first", [1, pytest.param(2, marks=RARE)])
def test_who_is_driven_by_somebody_else_gives_up_until_somebody_asks(first):
    robot = Mailbot(6, ROW)
    robot.request(1, first, 1)
    for _ in range(3):
        robot.act(robot.plan()[0], "preempted")
    assert robot.plan() is None
    robot.cancel(1)
    assert robot.plan() == []
    texts = [str(one.arguments[1]) for one in robot.answer if one.name == "_explain"]
    assert set(texts) == {'"somebody else drives the robot"'}
    robot.request(2, 2, 1)
    robot.act(robot.plan()[0], "preempted")
    finish(robot)
    assert ends(robot) == {1: "canceled", 2: "succeeded"}


@pytest.mark.slow
def test_what_is_on_the_robot_of_one_that_somebody_else_drives_is_brought_on_later():
    robot = Mailbot(6, ROW)
    robot.request(1, 1, 3)
    robot.act(robot.plan()[0])
    for _ in range(3):
        robot.act(robot.plan()[0], "preempted")
    assert robot.plan() is None
    robot.cancel(1)
    assert robot.plan() == []
    assert robot.places[1] == ("rides", "o1")
    robot.request(1, 1, 2)
    assert finish(robot) == 2
    assert ends(robot) == {1: "succeeded"}


@pytest.mark.slow
def test_what_the_core_has_ended_itself_is_no_failure():
    robot = Mailbot(6, ROW)
    robot.request(1, 2, 1)
    for _ in range(5):
        robot.act(robot.plan()[0], "preempted")
        robot.called_off()
    finish(robot)
    assert ends(robot) == {1: "succeeded"}


@pytest.mark.slow
@pytest.mark.parametrize("reason", ["o4", *(pytest.param(one, marks=RARE) for one in ("1", '"o2"', "77"))])
def test_the_name_of_something_else_is_a_failure(reason):
    robot = Mailbot(6, ROW)
    robot.request(1, 2, 3)
    robot.request(2, 2, 3)
    robot.act(robot.plan()[0], reason)
    assert what(robot.plan()[0]) == "o2", "it is not believed to be there"
    robot.act(robot.plan()[0])
    while robot.plan() is not None and not robot.ends:
        action = robot.answer_now()
        robot.act(action, "2" if what(action) == "1" else "1")
    assert all("could not be picked up" in end for end in ends(robot).values()), "three times, then it is given up"


@pytest.mark.slow
def test_what_could_not_be_put_down_is_asked_for_again():
    robot = Mailbot(6, ROW)
    robot.request(1, 1, 2)
    robot.act(robot.plan()[0])
    robot.act(robot.plan()[0])
    for _ in range(3):
        robot.act(robot.plan()[0], "failed")
    assert robot.plan() == []
    assert robot.places[1] == ("stuck",)
    robot.request(1, 2, 4)
    assert robot.plan() == [], "it is refused: the package is not there"
    robot.request(1, 1, 4)
    assert finish(robot) == 3
    assert robot.places[1] is None
    robot.request(1, 4, 1)
    finish(robot)
    assert ends(robot) == {1: "succeeded"}


@pytest.mark.slow
@pytest.mark.once
@pytest.mark.parametrize(
    ("moves", "then"),
    [
        (0, ["deliver,7", "pickup,7", "move_base,office1", "deliver,7"]),
        (1, ["move_base,office2", "move_base,office1", "deliver,7"]),
    ],
)
def test_what_is_being_brought_back_is_asked_for_again(moves, then):
    """As long as it is on the robot it stays there; that it is being put down is too late to change."""
    robot = Driver.of_shipped("mailbot.lp", "office.lp")
    robot.goal("first", "goal(office2,office4,7)").until("pickup")
    for _ in range(moves):
        robot.succeed()
    cycle = robot.core.cycle
    robot.core.receive("eye", [f"_blocked(office3,office4,{cycle})"])
    robot.succeed()
    assert robot.states("first")[-1] == "aborted"
    robot.goal("second", "goal(office2,office1,7)").finish()
    assert robot.states("second")[-1] == "succeeded"
    done = [text for text in robot.journal.actions if int(text[:-1].split(",")[-1]) > cycle]
    assert [text[len("_action_lib(") :].rpartition(",")[0] for text in done] == then


@pytest.mark.slow
def test_what_is_lost_on_the_way_can_be_asked_for_where_it_is():
    robot = Mailbot(6, ROW)
    robot.request(1, 1, 2)
    for reason in (None, None, "failed", "failed", "failed"):
        robot.act(robot.plan()[0], reason)
    robot.request(1, 1, 2)
    robot.act(robot.plan()[0], "not_carried")
    assert robot.plan() == []
    assert ends(robot) == {1: 'aborted(("package ",1," is not on the robot"))'}
    robot.request(1, 3, 2)
    finish(robot)
    assert ends(robot) == {1: "succeeded"}


@pytest.mark.slow
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


@pytest.mark.slow
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


def answers(update, program, models=1):
    solver = PlanSolver(program, models=models)
    return solver.update(parse_update(update)).answers


def statuses(answer):
    return [atom for atom in answer if atom.name == "_status"]


@pytest.mark.parametrize("offices", ["nowhere,office1", "office1,nowhere", "7,f(x)"])
def test_unknown_offices_are_rejected(offices):
    update = f"#step 1. _request(goal({offices},1),2). #endstep."
    found = statuses(answers(update, shipped("mailbot.lp", "office.lp"))[0])
    assert {str(one)[: len("_status(1,rejected(")] for one in found} == {"_status(1,rejected("}
    unknown = [one for one in offices.split(",", 1) if one != "office1"]
    assert sorted(str(one) for one in found) == sorted(
        f'_status(1,rejected(("there is no place ",{one})),1)' for one in unknown
    )


def test_a_string_is_no_constant():
    update = '#step 1. _request(goal("office1",office2,1),2). #endstep.'
    found = answers(update, shipped("mailbot.lp", "office.lp"))
    texts = [text_of(one.arguments[1].arguments[0]) for one in statuses(found[0])]
    assert texts == ['there is no place "office1": this is a string, write it without quotes']


@pytest.mark.slow
def test_an_office_without_a_way_to_it_is_rejected(tmp_path: Path):
    island = tmp_path / "island.lp"
    island.write_text("office(attic).", encoding="utf-8")
    update = "#step 1. _request(goal(office1,attic,1),2). #endstep."
    program = ReactiveProgram.from_files([ENCODINGS / "mailbot.lp", ENCODINGS / "office.lp", island])
    found = statuses(answers(update, program)[0])
    assert [str(one) for one in found] == ['_status(1,rejected(("no way leads to ",attic)),1)']


@pytest.mark.slow
@pytest.mark.parametrize(
    "absent",
    [
        ["search.lp", "heuristic.lp", "floor.lp"],
        *(
            pytest.param([one], marks=(pytest.mark.slow, pytest.mark.once))
            for one in ["search.lp", "heuristic.lp", "faults.lp"]
        ),
    ],
)
def test_bounds_change_no_plan_and_neither_do_failures_that_never_came(absent, tmp_path: Path):
    """Without these files there are exactly the same shortest plans: the other rules are whole."""
    shutil.copytree(ENCODINGS, tmp_path, dirs_exist_ok=True)
    lines = (ENCODINGS / "delivery.lp").read_text(encoding="utf-8").splitlines()
    kept = [line for line in lines if not any(f'"delivery/{name}"' in line for name in absent)]
    assert len(kept) == len(lines) - len(absent)
    (tmp_path / "delivery.lp").write_text("\n".join(kept), encoding="utf-8")
    program = ReactiveProgram.from_files([tmp_path / "mailbot.lp", ENCODINGS / "office.lp"])
    assert program.warnings == []
    update = "#step 1. _request(goal(office3,office1,1),2). _request(goal(office2,office4,2),2). #endstep."
    fewer = answers(update, program, models=0)
    assert len(set(fewer)) == len(fewer)
    assert set(fewer) == set(answers(update, shipped("mailbot.lp", "office.lp"), models=0))
    assert fewer


def test_the_search_that_plans_are_compared_with():
    graph = neighbours([(f"o{a}", f"o{b}") for a, b in ROW])
    assert fewest_steps(graph, 3, "o1", [("waits", "o3", "o2")]) == 5
    assert fewest_steps(graph, 1, "o1", [("waits", "o1", "o2"), ("waits", "o1", "o2")]) == 7
    assert fewest_steps(graph, 2, "o1", [("waits", "o1", "o2"), ("waits", "o1", "o2")]) == 5
    assert fewest_steps(graph, 3, "o1", [("rides", "o2"), None]) == 2
    assert fewest_steps(graph, 3, "o1", [("rides", "o1")], astray=True) == 2
    assert fewest_steps(graph, 3, "o1", [("rides", "o2")], shut={frozenset(("o1", "o2"))}) is None
    assert fewest_steps(graph, 1, "o1", [("stuck",), ("waits", "o1", "o2")]) is None


@pytest.mark.slow
@pytest.mark.once
def test_what_is_remembered_of_a_long_run_does_not_grow():
    """As long as a bound is kept (``_window``), the requests of its cycle are; all else that is over is forgotten."""
    files = [ENCODINGS / "mailbot.lp", ENCODINGS / "office.lp"]
    window, cycles = sized((8, 36), (20, 60))
    program = ReactiveProgram.from_files(files, {"_window": str(window)})
    solver = shortest(program)
    driver = Driver(settings=CoreSettings(), program=program, solver=lambda _: solver)
    number = 0
    while driver.core.cycle < cycles:
        number += 1
        driver.goal(str(number), f"goal(office{number % 4 + 1},office{number % 3 + 1},{number})").finish()
    past = solver.snapshot.past
    assert past.first > window
    times = [atom.arguments[-1].number for atom in past.facts if atom.name in ("waiting", "_aim", "_crossed")]
    assert min(times) >= past.first - window


@pytest.mark.slow
@pytest.mark.once
def test_a_place_that_navigation_does_not_know_may_be_left():
    driver = Driver.of_shipped("mailbot.lp", "office.lp")
    driver.core.add_goal("first", "goal(office1,office3,1)")
    driver.goal("second", "goal(office1,office3,2)").succeed().fail("not_at_label")
    assert driver.awaited == ["_action_lib(move_base,office1,3)"]
    driver.fail("unknown_label").finish()
    assert sorted(driver.states(key)[-1] for key in ("first", "second")) == ["aborted", "succeeded"]
    ended = "first" if driver.states("first")[-1] == "aborted" else "second"
    assert driver.message(ended).endswith("office1 is unreachable since the robot's navigation knows no place office1")
    assert driver.goal("third", "goal(office1,office3,3)").finish().states("third")[-1] == "succeeded"
