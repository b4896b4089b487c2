"""New goals and cancels join a plan that goes on once a plan with them is there: the robot waits for no search."""

import pytest
from children import preparing_process, wait_until_prepared
from core_driver import Driver
from hypothesis import given, settings
from hypothesis import strategies as st
from late_standby import NEVER, Standby
from mailbot_world import neighbours, program
from test_plans_that_go_out import Office

from rosoclingo.oclingo import parse_update
from rosoclingo.planning.workers.process_solver import ProcessSolver
from rosoclingo.reasoning import admission
from rosoclingo.reasoning.events import GoalChanged
from rosoclingo.reasoning.goals import Outcome
from rosoclingo.reasoning.settings import CoreSettings
from rosoclingo.reasoning.stream_planner import Halt, unwatched

FLOOR = (4, ((1, 2), (2, 3), (3, 4)), 1, 3)


class World:
    """A core on a row of offices, whose solver's standby worker is late by some cycles."""

    def __init__(self, delay=0, solver=None, watch_joining=unwatched, search_timeout=0.0):
        _, corridors, start, capacity = FLOOR
        self.standby = Standby(delay)
        self.office = Office(neighbours([(f"o{a}", f"o{b}") for a, b in corridors]), capacity, f"o{start}")
        self.driver = Driver(
            settings=CoreSettings(search_timeout=search_timeout),
            program=program(*FLOOR),
            solver=solver or self.standby.solver,
            watch_joining=watch_joining,
        )

    @property
    def core(self):
        return self.driver.core

    @property
    def fed(self):
        """The goals that the program knows."""
        return [goal.key for goal in self.core.live_goals if goal.fed]

    def ask(self, *errands):
        for origin, destination in errands:
            number = len(self.office.packages) + 1
            self.office.packages[number] = ("waits", f"o{origin}", f"o{destination}")
            self.core.add_goal(str(number), f"goal(o{origin},o{destination},{number})")
        self.driver.run()
        return self

    def step(self, fails=False):
        """The action is done, or fails; return whether there was one."""
        if not self.core.awaited:
            return False
        (action,) = self.core.awaited
        if not fails:
            self.office.do(action)
        (self.driver.fail("failed") if fails else self.driver.succeed())
        return True

    def go_on(self):
        """The action is done; if the plan in force has another action, that goes out without a search."""
        due, before = self.core.plan.at(self.core.cycle + 1), self.standby.searches
        assert self.step()
        assert not due or (self.core.awaited and self.standby.searches == before)

    def waits(self, key):
        """The reasons that a client was told while its goal waited."""
        return [one.waits for one in self.driver.feedback(key) if one.waits]

    def finish(self):
        """All that is asked for is done, and reported."""
        while self.step():
            pass
        assert set(self.office.packages.values()) == {None}
        ended = {one.outcome for one in self.driver.journal.of(GoalChanged) if one.outcome is not None}
        assert ended == {Outcome.SUCCEEDED}


def requests(update):
    """The requests in an update's text."""
    heads = [str(one.head) for _, one in parse_update(update).sections() if one.head]
    return [head for head in heads if head.startswith("_request")]


# ---- New goals


def test_new_goal_is_in_the_next_update_if_its_plan_is_there():
    world = World(delay=0).ask((2, 4)).ask((3, 1))
    world.go_on()
    assert requests(world.driver.journal.updates[-1]) == ["_request(goal(o3,o1,2),3)"]
    assert world.waits("2") == []
    world.finish()


@pytest.mark.parametrize(("delay", "cycles"), [(1, [3]), (2, [3, 6]), (3, [3, 6]), (4, [3, 6, 13])])
def test_new_goal_joins_later_without_a_search(delay, cycles):
    """The cycle in which it joins is twice as far away each time."""
    world = World(delay).ask((1, 4), (4, 1), (1, 4), (4, 1)).ask((2, 3))
    while "5" not in world.fed:
        world.go_on()
    assert world.core.cycle == cycles[-1]
    assert world.waits("5") == [f"it joins in cycle {one}, a plan is made for that" for one in cycles]
    world.finish()


def test_new_goal_joins_when_the_plan_is_over():
    world = World(delay=NEVER).ask((1, 2)).ask((3, 1))
    while world.core.plan.at(world.core.cycle + 1):
        world.go_on()
        assert world.fed == ["1"]
    world.finish()


def test_goals_that_come_before_others_join_wait_for_the_next_time():
    world = World(delay=2).ask((1, 4), (4, 1), (1, 4)).ask((2, 3))
    for _ in range(4):
        world.go_on()
    world.ask((3, 2))
    while "4" not in world.fed:
        world.go_on()
    assert "5" not in world.fed
    while "5" not in world.fed:
        world.go_on()
    world.finish()


def test_next_cycle_for_joining_is_nearer_after_each_success():
    world = World(delay=3).ask((1, 4), (4, 1), (1, 4)).ask((2, 3))
    while "4" not in world.fed:
        world.go_on()
    world.standby.delay, cycles = 0, []
    for number in range(5, 8):
        cycle = world.ask((2, 3)).core.cycle
        while str(number) not in world.fed:
            world.go_on()
        cycles.append(world.core.cycle - cycle)
    assert cycles[0] > cycles[1] > cycles[2] == 1
    world.finish()


def test_without_a_limit_new_goals_are_in_the_next_update():
    """As with plans that are to be shortest, whatever the search takes."""
    world = World(delay=NEVER, watch_joining=None).ask((2, 4)).ask((3, 1))
    world.step()
    assert world.fed == ["1", "2"]
    world.finish()


def test_without_a_standby_worker_new_goals_are_in_the_next_update():
    world = World(solver=None)
    world.driver = Driver(settings=CoreSettings(), program=program(*FLOOR), watch_joining=unwatched)
    world.ask((2, 4)).ask((3, 1)).step()
    assert world.fed == ["1", "2"]
    world.finish()


def test_goals_without_room_join_while_the_robot_acts(monkeypatch):
    monkeypatch.setattr(admission, "FIRST", 2)
    world = World(delay=0, search_timeout=600.0)
    world.ask((1, 4), (4, 1), (1, 3), (3, 1), (2, 3))
    assert world.fed == ["1", "2"]
    world.go_on()
    assert world.fed == ["1", "2", "3", "4", "5"]
    world.finish()


# ---- Other events


def test_failure_brings_new_goals_into_the_update():
    """There is no plan that goes on."""
    world = World(delay=NEVER).ask((1, 4), (4, 1)).ask((2, 3))
    for _ in range(2):
        world.go_on()
    world.step(fails=True)
    assert world.fed == ["1", "2", "3"]
    assert world.waits("3")[-1].startswith("it joins in cycle ")
    world.finish()


def test_fact_is_in_the_next_update_without_new_goals():
    world = World(delay=NEVER).ask((1, 4), (4, 1)).ask((2, 3))
    world.go_on()
    world.driver.facts("_blocked(o4,o1,now)")
    world.step()
    assert "_blocked(o4,o1," in world.driver.journal.updates[-1]
    assert world.fed == ["1", "2"]
    world.standby.delay = 0
    while "3" not in world.fed:
        world.go_on()
    world.finish()


@pytest.mark.parametrize("delay", [0, 1, 2, NEVER])
def test_cancel_does_not_stop_the_robot(delay):
    world = World(delay).ask((1, 4), (4, 1))
    world.go_on()
    world.driver.cancel("2")
    while "2" in world.fed and world.core.plan.at(world.core.cycle + 1):
        world.go_on()
    world.driver.finish()
    assert world.driver.states("2")[-1] in ("preempted", "succeeded")
    assert world.driver.states("1")[-1] == "succeeded"


def test_cancel_of_a_goal_that_is_to_join_ends_it():
    world = World(delay=NEVER).ask((1, 4), (4, 1)).ask((2, 3), (3, 2))
    for _ in range(2):
        world.go_on()
    world.driver.cancel("3")
    assert world.driver.states("3")[-1] == "recalled"
    del world.office.packages[3]
    world.standby.delay = 0
    while "4" not in world.fed:
        world.go_on()
    world.driver.finish()
    assert world.driver.states("4")[-1] == "succeeded"


EVENTS = st.lists(st.sampled_from(["done", "done", "done", "failed", "asked", "prepared"]), max_size=12)


@pytest.mark.mostly_slow
@settings(max_examples=max(1, settings.default.max_examples // 20))
@given(EVENTS, st.lists(st.permutations(range(1, 5)).map(lambda way: way[:2]), min_size=18, max_size=18), st.data())
def test_robot_acts_and_all_goals_are_met_however_late_answers_are(events, errands, data):
    world, ways, failed = World(), iter(errands), 0
    world.ask(*(next(ways) for _ in range(3)))
    for event in events:
        world.standby.delay = data.draw(st.sampled_from([0, 1, 2, 3, 5, NEVER]))
        failed = failed + 1 if event == "failed" and failed < 2 else 0
        if event == "asked":
            world.ask(next(ways))
        elif event == "prepared":
            world.core.prepare()
        elif failed:
            world.step(fails=True)
        elif world.core.awaited:
            world.go_on()
    world.finish()


# ---- Worker processes


@pytest.fixture(scope="module")
def process():
    with preparing_process(program(*FLOOR)) as one:
        yield one


@pytest.mark.slow
@pytest.mark.parametrize("waits", [True, False])
def test_standby_worker_that_has_the_plan_takes_over(process, waits):
    """A plan that is not there yet is waited for until the watch ends that."""
    looks = []

    def watch():
        return lambda: looks.append(1)

    world = World(solver=lambda _: ProcessSolver(process), watch_joining=watch).ask((2, 4))
    spare = process.standby_pid
    world.ask((3, 1)).core.prepare()
    if waits:
        wait_until_prepared(process, world.core.prepare)
    world.step()
    assert process.pid == spare
    assert waits or looks
    assert world.fed == ["1", "2"]
    world.finish()


@pytest.mark.slow
def test_worker_processes_let_goals_join_later(process):
    halts = []

    def watch():
        return lambda: Halt("the test") if halts else None

    world = World(solver=lambda _: ProcessSolver(process), watch_joining=watch).ask((1, 4), (4, 1))
    halts.append(1)
    world.ask((2, 3))
    while "3" not in world.fed:
        assert world.step()
        wait_until_prepared(process, world.core.prepare)
    assert world.waits("3")
    world.finish()
