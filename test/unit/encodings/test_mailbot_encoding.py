"""The mailbot encoding: plans are shortest in every situation, and exist wherever the rules permit one."""

import pytest
from core_driver import Driver, shortest
from hypothesis import given, settings
from hypothesis import strategies as st
from mailbot_world import Mailbot
from shipped import ENCODINGS
from workloads import sized

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.oclingo.program.sources import Source
from rosoclingo.reasoning.settings import CoreSettings

COMMON = ("failed", "timeout", "server_lost", "preempted", "stuck(door,1)", '"no idea"', "77", "move_base", '"o2"')
EVENTS = (*["nothing"] * 2, "request", *["requests"] * 2, "cancel", "cancel_what_is_over")
OTHERS = ("o1", "o2", "o3", "1", "2", "3")  # arguments of other actions
MOVING = (*COMMON, "blocked", "unreachable", "unknown_label")
HANDLING = (*COMMON, "not_here", "unknown_package", "not_carried", "not_at_label", "full", "blocked")


# each example loads its own program, and a run costs the time of many single plans
RUNS = settings(max_examples=max(1, settings.default.max_examples // 3))


@st.composite
def floors(draw):
    """Generate the number of offices, the corridors of a connected floor, start and capacity."""
    count = draw(st.integers(3, 6))
    corridors = {(draw(st.integers(1, number - 1)), number) for number in range(2, count + 1)}
    pairs = st.tuples(st.integers(1, count), st.integers(1, count)).filter(lambda pair: pair[0] != pair[1])
    corridors |= set(draw(st.lists(pairs, max_size=3)))
    return count, tuple(sorted(corridors)), draw(st.integers(1, count)), draw(st.integers(1, 3))


@pytest.mark.slow
@RUNS
@given(st.data())
def test_mailbot_plans_are_shortest_at_any_time(data):
    """Runs with requests, some with equal offices, cancels, failures and idle cycles in any order; ids are reused."""
    count, corridors, start, capacity = data.draw(floors())
    robot = Robot(count, corridors, start, capacity)
    for _ in range(data.draw(st.integers(1, 20), label="cycles")):
        happens(robot, data, count)
        ahead = robot.plan()
        if ahead is None:
            robot.gives_up()
            ahead = robot.plan()
            assert ahead is not None
        if ahead:
            outcome = data.draw(st.sampled_from(["works", "works", "works", "fails", "skipped"]))
            reasons = MOVING if ahead[0].arguments[0].name == "move_base" else HANDLING
            if outcome != "skipped":
                own = str(ahead[0].arguments[1])
                reason = data.draw(st.sampled_from([one for one in (*reasons, *OTHERS) if one != own]))
                robot.act(ahead[0], reason if outcome == "fails" else None)
                if outcome == "fails" and reason == "preempted" and data.draw(st.booleans(), label="by the core"):
                    robot.called_off()
    robot.finish()


def happens(robot, data, count):
    """Add a request, a cancel, or nothing."""
    free = [number for number in range(1, 5) if robot.places.get(number) in (None, ("stuck",))]
    taken = [number for number in range(1, 5) if robot.places.get(number)]
    event = data.draw(st.sampled_from(EVENTS))
    if event.startswith("request"):
        for number in free[: 1 if event == "request" else data.draw(st.integers(2, 4))]:
            origin = int(robot.origins.get(number, "o1")[1:])
            robot.request(
                number, data.draw(st.sampled_from([origin, *range(1, count + 1)])), data.draw(st.integers(1, count))
            )
    elif event == "cancel" and taken:
        robot.cancel(data.draw(st.sampled_from(taken)))
    elif event == "cancel_what_is_over" and free:
        robot.cancel(free[0])


class Robot(Mailbot):
    """A robot that ends a run."""

    def gives_up(self):
        """Cancel the goals that cannot be met; the rest must have a plan."""
        hopeless = self.hopeless()
        assert hopeless
        for identifier in hopeless:
            self.cancel(identifier)

    def finish(self):
        """Let all actions succeed and cancel unmeetable goals."""
        for _ in range(200):
            ahead = self.plan()
            if ahead is None:
                self.gives_up()
            elif ahead:
                self.act(ahead[0])
            else:
                return
        raise AssertionError("the robot never comes to rest")


@pytest.mark.slow
def test_mailbot_actions_that_the_core_ends_are_no_failures():
    robot = Robot(3, ((1, 2), (2, 3)))
    robot.request(1, 2, 1)
    for _ in range(5):
        robot.act(robot.plan()[0], "preempted")
        robot.called_off()
    robot.finish()
    assert robot.ends[1][0] == "succeeded"


@pytest.mark.slow
def test_mailbot_rejects_an_office_without_a_way():
    island = Source("island.lp", "office(attic).")
    program = ReactiveProgram([*map(Source.from_file, (ENCODINGS / "mailbot.lp", ENCODINGS / "office.lp")), island])
    driver = Driver(program=program).goal("a", "goal(office1,attic,1)")
    assert driver.message("a").endswith("no way leads to attic")


@pytest.mark.slow
def test_mailbot_accepts_a_late_report_about_a_way_it_has_driven():
    driver = Driver.of_shipped("mailbot.lp", "office.lp").goal("a", "goal(office3,office4,1)").succeed().succeed()
    driver.facts("_blocked(office2,office3,1)").finish()
    assert (driver.states("a")[-1], driver.problems) == ("succeeded", [])


@pytest.mark.slow
def test_mailbot_memory_of_a_long_run_is_bounded():
    """The requests of a bound stay as long as the bound (``_window``); all other past is forgotten."""
    files = [ENCODINGS / "mailbot.lp", ENCODINGS / "office.lp"]
    window, cycles = sized((6, 24), (20, 60))
    program = ReactiveProgram.from_files(files, {"_window": str(window)})
    solver = shortest(program)
    driver = Driver(settings=CoreSettings(), program=program, solver=lambda _: solver)
    number = 0
    while driver.core.cycle < cycles:
        number += 1
        driver.goal(str(number), f"goal(office{number % 4 + 1},office{number % 3 + 1},{number})").finish()
    solver.checkpoint()
    past = solver.snapshot.past
    assert past.first > window
    times = [atom.arguments[-1].number for atom in past.facts if atom.name in ("waiting", "_aim", "_crossed")]
    assert min(times) >= past.first - window
