"""The mailbot encoding: plans are shortest in every situation, and exist wherever the rules permit one."""

import shutil
from pathlib import Path

import pytest
from core_driver import Driver, shortest
from core_scripts import perform, scripts
from hypothesis import given, settings
from hypothesis import strategies as st
from mailbot_world import Mailbot
from shipped import ENCODINGS, shipped
from workloads import sized

from rosoclingo.oclingo import ReactiveProgram, parse_update
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.reasoning.settings import CoreSettings

ROW = tuple((number, number + 1) for number in range(1, 6))
RING = ((1, 2), (2, 3), (3, 4), (4, 5), (5, 6), (6, 1))
FLOOR = ((1, 2), (2, 3), (3, 4), (4, 2), (4, 5), (5, 6))  # a loop between two dead ends
COMMON = ("failed", "timeout", "server_lost", "preempted", "stuck(door,1)", '"no idea"', "77", "move_base", '"o2"')
OTHERS = ("o1", "o2", "o3", "1", "2", "3")  # arguments of other actions
MOVING = (*COMMON, "blocked", "unreachable", "unknown_label")
HANDLING = (*COMMON, "not_here", "unknown_package", "not_carried", "not_at_label", "full", "blocked")


# each example loads its own program, and a run costs the time of many single plans
PLANS = settings(max_examples=max(1, settings.default.max_examples // 5))
RUNS = settings(max_examples=max(1, settings.default.max_examples // 12))


@st.composite
def floors(draw):
    """Generate the number of offices, the corridors of a connected floor, start and capacity."""
    count = draw(st.integers(3, 6))
    corridors = {(draw(st.integers(1, number - 1)), number) for number in range(2, count + 1)}
    pairs = st.tuples(st.integers(1, count), st.integers(1, count)).filter(lambda pair: pair[0] != pair[1])
    corridors |= set(draw(st.lists(pairs, max_size=3)))
    return count, tuple(sorted(corridors)), draw(st.integers(1, count)), draw(st.integers(1, 3))


@pytest.mark.slow
@PLANS
@given(st.data())
def test_mailbot_plans_are_shortest(data):
    """One batch of requests, some with equal offices, some without a move."""
    count, corridors, start, capacity = data.draw(floors())
    robot = Robot(count, corridors, start, capacity)
    offices = st.integers(1, count)
    for number, (source, target) in enumerate(data.draw(st.lists(st.tuples(offices, offices), min_size=1, max_size=4))):
        robot.request(number + 1, source, target)
    assert robot.plan()


@pytest.mark.slow
@RUNS
@given(st.data())
def test_mailbot_plans_are_shortest_at_any_time(data):
    """Runs with requests, cancels, failures and idle cycles in any order; ids are reused."""
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
                reason = data.draw(
                    st.sampled_from([one for one in (*reasons, *OTHERS) if one != str(ahead[0].arguments[1])])
                )
                robot.act(ahead[0], reason if outcome == "fails" else None)
    robot.finish()


def happens(robot, data, count):
    """Add a request, a cancel, or nothing."""
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


#: The floor, and the events for a robot that starts in office 1 and carries at most three packages.
LIVES = {
    **{f"no failure is tried for ever: {reason}": (FLOOR, f"""
        request 1 3 6; only_fails {reason}; gives_up; rests; request 2 3 6; finish; ended 1 canceled 2 succeeded""")
       for reason in ("failed", "blocked")},
    "unknown place is tried again when somebody asks for it": (ROW[:2], """
        request 1 1 3; works 2; fails unknown_label; has_no_plan; gives_up; finish; request 2 2 3; finish
        request 3 2 3; finish; ended 1 canceled 2 succeeded 3 succeeded"""),
    "detour while a connection is blocked": (RING, """
        request 1 3 1; goes o2; fails blocked; goes o6 o5 o4 o3; finish; request 2 1 2; goes 2; finish
        ended 1 succeeded 2 succeeded"""),
    **{f"somebody else drives it until somebody asks, in {place}": (ROW, f"""
        request 1 {place} 1; fails preempted 3; has_no_plan; cancel 1; rests; explains somebody else drives the robot
        request 2 2 1; fails preempted; finish; ended 1 canceled 2 succeeded""") for place in (1, 2)},
    "actions that the core ends are not failures": (ROW, f"""
        request 1 2 1; {"fails preempted; called_off;" * 5} finish; ended 1 succeeded"""),
    "things that could not be put down are asked for again": (ROW, """
        request 1 1 2; works 2; fails failed 3; rests; place 1 stuck; request 1 2 4; rests; request 1 1 4; finish 3
        place 1 None; request 1 4 1; finish; ended 1 succeeded"""),
    "things that are lost on the way are asked for where they are": (ROW, """
        request 1 1 2; works 2; fails failed 3; request 1 1 2; fails not_carried; rests
        ended 1 aborted(("package ",1," is not on the robot")); request 1 3 2; finish; ended 1 succeeded"""),
    "package that cannot be brought back until the way is open again": (ROW, """
        request 1 1 3; works 2; request 2 2 1; works 1; cancel 1; fails blocked; has_no_plan; cancel 2; finish
        place 1 rides o1; place 2 None; request 3 1 2; finish; place 1 None; place 2 None; place 3 None
        ended 1 canceled 2 canceled 3 succeeded"""),
}  # fmt: skip


class Robot(Mailbot):
    """The words of the robot's script."""

    def request(self, *numbers):
        super().request(*map(int, numbers))

    def cancel(self, number):
        super().cancel(int(number))

    def works(self, times=1):
        """Let a number of actions succeed."""
        for _ in range(int(times)):
            self.act(self.plan()[0])

    def fails(self, reason, times=1):
        """Let the next action fail a number of times."""
        for _ in range(int(times)):
            self.act(self.plan()[0], reason)

    def only_fails(self, reason):
        """Let every action fail until there is no plan."""
        while (ahead := self.plan()) is not None:
            assert self.cycle < 20
            self.act(ahead[0], reason)

    def goes(self, *things):
        """Expect these parameters of the next actions, none of which is executed in this cycle."""
        assert [str(one.arguments[1]) for one in self.plan()[: len(things)]] == list(things)

    def has_no_plan(self):
        assert self.plan() is None

    def rests(self):
        """Expect an empty plan."""
        assert self.plan() == []

    def gives_up(self):
        """Cancel the goals that cannot be met; the rest must have a plan."""
        hopeless = self.hopeless()
        assert hopeless
        for identifier in hopeless:
            self.cancel(identifier)

    def finish(self, number=None):
        """Let all actions succeed and cancel unmeetable goals; expect this number of actions."""
        for done in range(200):
            ahead = self.plan()
            if ahead is None:
                self.gives_up()
            elif ahead:
                self.act(ahead[0])
            else:
                assert number is None or done == int(number)
                return
        raise AssertionError("the robot never comes to rest")

    def place(self, number, *words):
        """Expect the place of a package."""
        assert self.places[int(number)] == (None if words == ("None",) else words)

    def explains(self, *words):
        texts = [str(one.arguments[1]) for one in self.answer if one.name == "_explain"]
        assert set(texts) == {f'"{" ".join(words)}"'}

    def ended(self, *words):
        """Expect each request and its end."""
        assert " ".join(f"{number} {end}" for number, (end, _) in sorted(self.ends.items())) == " ".join(words)


@pytest.mark.sampled(3)
@pytest.mark.slow
@scripts(LIVES)
def test_mailbot_life_follows_the_script(row):
    corridors, script = row
    perform(Robot(max(map(max, corridors)), corridors), script)


def answers(update, program, models=1):
    solver = PlanSolver(program, models=models)
    return solver.update(parse_update(update)).answers


def statuses(answer):
    return [atom for atom in answer if atom.name == "_status"]


@pytest.mark.parametrize("offices", ["nowhere,office1", "7,f(x)"])
def test_mailbot_rejects_unknown_offices(offices):
    update = f"#step 1. _request(goal({offices},1),2). #endstep."
    found = statuses(answers(update, shipped("mailbot.lp", "office.lp"))[0])
    assert {str(one)[: len("_status(1,rejected(")] for one in found} == {"_status(1,rejected("}
    unknown = [one for one in offices.split(",", 1) if one != "office1"]
    assert sorted(str(one) for one in found) == sorted(
        f'_status(1,rejected(("there is no place ",{one})),1)' for one in unknown
    )


@pytest.mark.slow
def test_mailbot_rejects_an_office_without_a_way(tmp_path: Path):
    island = tmp_path / "island.lp"
    island.write_text("office(attic).", encoding="utf-8")
    update = "#step 1. _request(goal(office1,attic,1),2). #endstep."
    program = ReactiveProgram.from_files([ENCODINGS / "mailbot.lp", ENCODINGS / "office.lp", island])
    found = statuses(answers(update, program)[0])
    assert [str(one) for one in found] == ['_status(1,rejected(("no way leads to ",attic)),1)']


@pytest.mark.slow
@pytest.mark.parametrize("absent", [["search.lp", "heuristic.lp", "floor.lp"], ["faults.lp"]])
def test_mailbot_plans_need_neither_bounds_nor_failure_rules(absent, tmp_path: Path):
    """Without these files the shortest plans are exactly the same: the other rules are complete."""
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
