"""Goals that wait join in a later cycle, for which a plan is made by another process while the robot goes on."""

import pytest
from children import preparing_process, wait_until_prepared
from core_driver import Driver
from hypothesis import given, settings
from hypothesis import strategies as st
from mailbot_world import neighbours, program
from test_plans_that_go_out import Office

from rosoclingo.oclingo import parse_update
from rosoclingo.planning.workers.worker import Worker
from rosoclingo.reasoning import CoreSettings, GoalChanged, GoalProgress, Outcome, preparations, waiting_queue

FLOOR = (4, ((1, 2), (2, 3), (3, 4)), 1, 3)
ROOM = 2  # goals that are planned for at first


class World:
    """A core on a row of offices; a cycle takes a second."""

    def __init__(self, process):
        _, corridors, start, capacity = FLOOR
        self.process = process
        self.office = Office(neighbours([(f"o{a}", f"o{b}") for a, b in corridors]), capacity, f"o{start}")
        limits = CoreSettings(search_timeout=600.0)
        self.driver = Driver(settings=limits, program=program(*FLOOR), solver=lambda _: process.solver())

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

    def prepare(self):
        """The core has prepared what is worth it, and that is done; tell whether goals are to join."""
        self.core.prepare()
        wait_until_prepared(self.process, self.core.prepare)
        return self.core.queue.closed

    def step(self, fails=False):
        """The action is done, or fails; where nothing is, that is told."""
        if not self.core.awaited:
            return False
        (action,) = self.core.awaited
        if not fails:
            self.office.do(action)
        self.driver.now += 1.0
        (self.driver.fail("failed") if fails else self.driver.succeed())
        return True

    def hear(self, what, key):
        """While the action runs a fact comes, the cancel of a goal, or another goal."""
        if what == "cancel":
            self.driver.cancel(key)
        elif what == "fact":
            self.driver.facts("_blocked(o4,o1,now)")
        elif what == "another":
            self.ask((3, 4))

    def finish(self):
        """All that is asked for is done, and said to be."""
        while self.step():
            pass
        assert set(self.office.packages.values()) == {None}
        ended = {one.outcome for one in self.driver.journal.of(GoalChanged) if one.outcome is not None}
        assert ended == {Outcome.SUCCEEDED}


@pytest.fixture(scope="module")
def process():
    with preparing_process(program(*FLOOR)) as one:
        yield one


@pytest.fixture(autouse=True)
def little_room(monkeypatch):
    """There is room for few goals, and it does not grow; a plan for more takes four cycles."""
    for name, value in {"FIRST": ROOM, "FASTER": 1.0}.items():
        monkeypatch.setattr(waiting_queue, name, value)
    monkeypatch.setattr(waiting_queue.GoalWindow, "seconds_for", lambda window, goals: 0.5)


@pytest.fixture
def world(process):
    return World(process)


ERRANDS = [(2, 4), (4, 1), (1, 3), (3, 1), (2, 3)]


def begun(world):
    """Errands are asked for, and as the second action runs those that wait are to join; return the cycle of that."""
    world.ask(*ERRANDS)
    assert world.fed == ["1", "2"]
    assert not world.prepare(), "how long a cycle takes is not known, and the plan is new"
    world.step()
    assert world.prepare()
    assert world.fed == ["1", "2"]
    told = {one.waits for one in world.driver.journal.of(GoalProgress) if one.waits.startswith("it joins")}
    (why,) = told
    return int(why.split("in cycle ")[1].split(",")[0])


@pytest.mark.slow
def test_goals_that_wait_join_with_a_plan_that_is_there_by_then(process, world):
    cycle = begun(world)
    before, spare = process.pid, process.standby_pid
    while world.core.cycle < cycle - 1:
        world.step()
        assert world.fed[-1] == "2"
        assert process.pid == before
    update = world.driver.journal.updates[-1]
    assert "_request" not in update
    world.step()
    assert process.pid == spare, "whoever had prepared that goes on"
    heads = [str(one.head) for _, one in parse_update(world.driver.journal.updates[-1]).sections() if one.head]
    assert heads[:3] == [f"_request(goal(o{a},o{b},{n}),{cycle + 1})" for n, (a, b) in enumerate(ERRANDS[2:], 3)]
    assert set(world.fed) >= {"3", "4", "5"}
    world.finish()


@pytest.mark.slow
@pytest.mark.parametrize("what", ["failure", "fact", "cancel"])
def test_goals_that_wait_go_on_waiting_where_something_else_comes(process, world, what):
    begun(world)
    before = process.pid
    world.hear(what, "3")
    if what == "cancel":
        del world.office.packages[3]
    world.step(fails=what == "failure")
    assert not world.core.queue.closed
    assert process.pid == before
    world.office.packages = {key: value for key, value in world.office.packages.items() if value}
    world.prepare()
    while world.step():
        pass
    assert not any(world.office.packages.values())


@pytest.mark.slow
@pytest.mark.parametrize("what", ["fact", "cancel", "another"])
def test_what_comes_while_an_action_runs_has_its_answer_prepared_at_once(process, world, what):
    """Though goals were to join: that is over then. A further goal only waits, it changes nothing."""
    begun(world)
    spare = process.standby_pid
    world.hear(what, "2")
    assert world.core.queue.closed
    assert world.prepare() is (what == "another")
    if what != "another":
        world.step()
        assert process.pid == spare, "it had the answer"


@pytest.mark.slow
def test_goals_do_not_join_where_the_last_action_before_fails(process, world):
    """There is no plan for that, and to make one would take long."""
    cycle, before = begun(world), process.pid
    while world.core.cycle < cycle - 1:
        world.step()
    world.step(fails=True)
    assert world.core.cycle == cycle
    assert (process.pid, world.fed[-1]) == (before, "2")
    assert not world.core.queue.closed
    world.finish()


@pytest.mark.slow
def test_a_plan_that_is_not_there_in_time_is_not_waited_for_and_the_next_has_more_time(process, world, monkeypatch):
    monkeypatch.setattr(preparations, "MARGIN", 0.5)
    cycle, before = begun(world), process.pid
    usual = world.core._ahead._cycles_for(5)
    with monkeypatch.context() as patch:
        patch.setattr(Worker, "has_answer", lambda *_: False)
        while world.core.cycle < cycle:
            world.step()
    assert (process.pid, world.fed[-1]) == (before, "2")
    told = [one.waits for one in world.driver.journal.of(GoalProgress) if "not there by the cycle" in one.waits]
    assert len(told) == 3
    assert not world.core.queue.closed
    assert world.core._ahead._cycles_for(5) > usual
    world.core._ahead._reach = 100
    assert not world.prepare(), "first the plan that there is may get shorter"
    while not world.prepare():
        assert world.step()
    while world.core.queue.closed:
        world.step()
    assert set(world.fed) >= {"3", "4", "5"}
    assert world.core._ahead._cycles_for(5) == usual
    world.finish()


@pytest.mark.slow
def test_no_goal_joins_beside_those_for_which_a_plan_is_made(world):
    cycle = begun(world)
    world.ask((3, 4))
    assert [one.waits for one in world.driver.feedback("6")] == ["others join first"]
    while world.core.cycle < cycle:
        world.step()
    assert "6" not in world.fed
    world.finish()


def test_nothing_is_held_where_nobody_can_prepare():
    here = Driver(settings=CoreSettings(search_timeout=600.0), program=program(*FLOOR))
    for number, (origin, destination) in enumerate(ERRANDS, 1):
        here.core.add_goal(str(number), f"goal(o{origin},o{destination},{number})")
    here.run()
    for _ in range(3):
        here.now += 1.0
        here.succeed()
        here.core.prepare()
        assert not here.core.queue.closed


def test_a_world_that_takes_its_own_way_is_foreseen_less_far(process, world):
    """The further away the cycle is, the less likely it comes to that."""
    begun(world)
    world.step(fails=True)
    assert world.core._ahead._reach == 1
    assert not world.prepare()
    assert world.core._ahead._reach == 2
    world.core._ahead._reach = 1 + -(-preparations.MARGIN * 1.5 // 1)
    assert world.prepare()
    world.finish()


EVENTS = st.lists(st.sampled_from(["done", "done", "done", "failed", "asked", "prepared"]), max_size=12)


@pytest.mark.slow
@pytest.mark.once
@settings(max_examples=max(1, settings.default.max_examples // 20))
@given(EVENTS, st.lists(st.permutations(range(1, 5)).map(lambda way: way[:2]), min_size=18, max_size=18))
def test_all_is_done_whatever_comes_before_goals_join(process, events, errands):
    world, ways, failed = World(process), iter(errands), 0
    world.ask(*(next(ways) for _ in range(5)))
    for event in events:
        if event == "asked":
            world.ask(next(ways))
        elif event == "prepared":
            world.prepare()
        else:
            failed = failed + 1 if event == "failed" and failed < 2 else 0
            world.step(fails=failed > 0)
    world.finish()
