"""Each plan that goes out is one, by rules written apart from the program: on any floor, with failures, and improved.

With ``~plan: shortest`` each has as few steps as a search from scratch finds. Improving changes nothing that is done or
under way. With a standby worker the answer is prefetched should an action fail, and new goals and cancels join a plan
that goes on once a plan with them is there: the robot waits for no search.
"""

from functools import partial

import pytest
from children import preparing_process, wait_until_prepared
from core_driver import ERRANDS, Driver, shortest, soon
from hypothesis import given, settings
from hypothesis import strategies as st
from late_standby import NEVER, Standby
from mailbot_world import neighbours, program
from office_world import Office

from rosoclingo.oclingo import parse_update
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.planning.workers.process_solver import ProcessSolver
from rosoclingo.reasoning import admission
from rosoclingo.reasoning.events import GoalChanged, ReturnTaken
from rosoclingo.reasoning.goals import Outcome
from rosoclingo.reasoning.settings import CoreSettings
from rosoclingo.reasoning.stream_planner import Halt, unwatched

LOOKS = 300  # of an improvement at whether it is to stop

SOLVERS = {"shortest": shortest, "first": partial(soon, plan_time=0.0), "soon": partial(soon, plan_time=0.05)}

#: Number of offices, corridors, start, capacity.
ROW = (4, ((1, 2), (2, 3), (3, 4)), 1, 3)
RING = (4, ((1, 2), (2, 3), (3, 4), (1, 4)), 1, 2)


@st.composite
def floors(draw):
    """A connected floor."""
    count = draw(st.integers(3, 5))
    corridors = {(draw(st.integers(1, number - 1)), number) for number in range(2, count + 1)}
    if draw(st.booleans()):
        corridors.add((1, count))
    return count, tuple(sorted(corridors)), draw(st.integers(1, count)), draw(st.integers(1, 3))


class Run:
    """A core on a floor, its goals, and failures, no more than two in a row of an action."""

    def __init__(self, floor, solver, search_timeout=10.0, **watches):
        _, corridors, start, capacity = floor
        self.office = Office(neighbours([(f"o{a}", f"o{b}") for a, b in corridors]), capacity, f"o{start}")
        self.failed, limits = {}, CoreSettings(search_timeout=search_timeout)
        self.driver = Driver(settings=limits, program=program(*floor), solver=solver, **watches)
        self.core = self.driver.core

    def ask(self, *errands):
        """Further goals; the core goes on with the next step."""
        for origin, destination in errands:
            number = len(self.office.packages) + 1
            self.office.packages[number] = ("waits", f"o{origin}", f"o{destination}")
            self.core.add_goal(str(number), f"goal(o{origin},o{destination},{number})")

    def end(self, fails=False):
        """The action under way is done, or fails, unless it has failed twice; the core has not gone on."""
        (action,) = self.core.awaited
        times = self.failed.get(action.parameter, 0)
        fails = fails and times < 2
        self.failed[action.parameter] = times + 1 if fails else 0
        if not fails:
            self.office.do(action)
        value = "failed" if fails else action.parameter
        self.core.receive("world", [f"_return({action.interface},{value},{action.cycle})"])

    def finish(self):
        """All that is asked for is done, and reported."""
        while self.driver.run().core.awaited:
            self.end()
        assert set(self.office.packages.values()) <= {None}
        assert {one.outcome for one in self.driver.journal.of(GoalChanged)} <= {None, Outcome.SUCCEEDED}
        assert self.core.live_goals == []


class JudgedRun(Run):
    """Each plan is judged, and improved unless it is to be shortest."""

    def __init__(self, floor, solver, is_shortest=False):
        super().__init__(floor, solver)
        self.is_shortest = is_shortest

    def step(self, fails):
        """The core goes on, its plan is judged, and its action ends."""
        core = self.driver.run().core
        steps = self.office.judge(core.plan.actions, core.cycle)
        if self.is_shortest:
            assert steps == self.office.fewest()
        else:
            self.improve(steps)
        self.end(fails)

    def improve(self, steps):
        """Plans only get shorter, and are plans; what is done or under way is left alone."""
        core, looks = self.core, iter(range(LOOKS))
        fixed = [one for one in core.plan.actions if one.cycle <= core.cycle], core.awaited, core.cycle
        more = True
        while more:
            more = core.improve(lambda: next(looks, None) is None) and next(looks, None) is not None
            found = self.office.judge(core.plan.actions, core.cycle)
            assert found <= steps
            steps = found
            assert fixed == ([one for one in core.plan.actions if one.cycle <= core.cycle], core.awaited, core.cycle)

    def finish(self):
        while any(self.office.packages.values()):
            self.step(fails=False)
        super().finish()


@pytest.mark.slow
@settings(max_examples=max(1, settings.default.max_examples // 8))
@given(st.sampled_from(sorted(SOLVERS)), st.data())
def test_each_plan_that_goes_out_is_one(kind, data):
    floor = data.draw(floors())
    run, ways = JudgedRun(floor, SOLVERS[kind], kind == "shortest"), st.permutations(range(1, floor[0] + 1))
    for _ in range(data.draw(st.integers(1, 4), label="batches")):
        for _ in range(data.draw(st.integers(1, 2), label="goals")):
            run.ask(data.draw(ways)[:2])
        for fails in data.draw(st.lists(st.sampled_from([False, False, True]), max_size=8), label="failures"):
            if any(run.office.packages.values()):
                run.step(fails)
    run.finish()


# ---- What is prefetched


class Noting(PlanSolver):
    """A solver that notes what it is to prefetch, and what comes."""

    noted, came = [], []  # type: list, list

    def prefetch(self, update, before=()):
        self.noted += [*before, update]
        return True

    def update(self, update, *watch, **more):
        self.came.append(update)
        return super().update(update, *watch, **more)


def prefetched(driver):
    """The updates that are to be prefetched now."""
    Noting.noted.clear()
    driver.core.prepare()
    return [str(one) for one in Noting.noted]


def test_answers_to_failures_and_arrivals_are_prefetched():
    Noting.noted, Noting.came = [], []
    driver = Driver(ERRANDS, solver=lambda one: shortest(one, Noting))
    assert prefetched(driver) == [], "nothing runs"
    driver.goal("a", "do(x,1)")
    for expected, reason in [("failed", "stuck(door)"), ("stuck(door)", "stuck(door)")]:
        (update,) = prefetched(driver)
        assert f",{expected}," in update, "as it failed last"
        assert prefetched(driver) == [], "nothing has changed"
        driver.fail(reason)
        assert (str(Noting.came[-1]) == update) is (expected == reason)
    prefetched(driver)
    driver.core.add_goal("b", "do(y,2)")
    (update,) = prefetched(driver)
    assert "_request(do(y,2)," in update, "with success"
    driver.succeed()
    assert str(Noting.came[-1]) == update
    assert prefetched(driver.finish()) == []


@pytest.fixture(scope="module")
def ring_process():
    with preparing_process(program(*RING)) as one:
        yield one


def prepare(run, process, waits=True):
    """Prefetch, and wait until that is done where it is so."""
    run.driver.run().core.prepare()
    if waits:
        wait_until_prepared(process, run.core.prepare)


@pytest.mark.slow
def test_a_goal_that_comes_while_an_action_runs_has_its_plan_as_that_returns(ring_process):
    run = JudgedRun(RING, lambda _: ProcessSolver(ring_process))
    run.ask((1, 3))
    run.driver.run()
    run.ask((2, 4))
    prepare(run, ring_process)
    before = ring_process.pid
    run.end()
    assert len(run.driver.run().core.live_goals) == 2
    assert ring_process.pid != before
    run.finish()


ASKED = st.lists(st.permutations(range(1, 5)).map(lambda places: places[:2]), min_size=1, max_size=2)
STEPS = st.lists(st.tuples(st.booleans(), st.sampled_from(["no", "begun", "done"])), max_size=6)


@pytest.mark.slow
@pytest.mark.once
@settings(max_examples=max(1, settings.default.max_examples // 20))
@given(st.lists(st.tuples(ASKED, STEPS), min_size=1, max_size=2))
def test_each_plan_that_goes_out_is_one_whether_it_was_prefetched_or_not(ring_process, batches):
    run = JudgedRun(RING, lambda _: ProcessSolver(ring_process))
    for asked, steps in batches:
        run.ask(*asked)
        for number, (fails, prepares) in enumerate(steps):
            if not any(run.office.packages.values()):
                break
            if prepares != "no":
                prepare(run, ring_process, waits=prepares == "done")
            before = ring_process.pid
            run.step(fails)
            if number + 1 < len(steps):  # else goals may come with the return
                has_failed = ",failed," in str(run.driver.run().journal.of(ReturnTaken)[-1].atom)
                assert prepares != "done" or (ring_process.pid != before) is has_failed
    run.finish()


# ---- Goals that join a plan


class JoiningRun(Run):
    """A core whose solver's standby worker is late by some cycles."""

    def __init__(self, delay=0, solver=None, watch_joining=unwatched, search_timeout=0.0):
        self.standby = Standby(delay)
        super().__init__(ROW, solver or self.standby.solver, search_timeout, watch_joining=watch_joining)

    @property
    def fed(self):
        """The goals that the program knows."""
        return [goal.key for goal in self.core.live_goals if goal.fed]

    def ask(self, *errands):
        super().ask(*errands)
        self.driver.run()
        return self

    def step(self, fails=False):
        """The action ends, and the core goes on."""
        self.end(fails)
        self.driver.run()

    def go_on(self, times=1):
        """The action is done; if the plan in force has another action, that goes out without a search."""
        for _ in range(times):
            due, before = self.core.plan.at(self.core.cycle + 1), self.standby.searches
            self.step()
            assert not due or (self.core.awaited and self.standby.searches == before)

    def until(self, key):
        """It goes on until the program knows a goal."""
        while key not in self.fed:
            self.go_on()

    def waits(self, key):
        """The reasons that a client heard while its goal waited."""
        return [one.waits for one in self.driver.feedback(key) if one.waits]


def test_new_goal_is_in_the_next_update_if_its_plan_is_there():
    run = JoiningRun(delay=0).ask((2, 4)).ask((3, 1))
    run.go_on()
    heads = [str(one.head) for _, one in parse_update(run.driver.journal.updates[-1]).sections() if one.head]
    assert [head for head in heads if head.startswith("_request")] == ["_request(goal(o3,o1,2),3)"]
    assert run.waits("2") == []
    run.finish()


@pytest.mark.parametrize(("delay", "cycles"), [(1, [3]), (2, [3, 6]), (3, [3, 6]), (4, [3, 6, 13])])
def test_new_goal_joins_later_without_a_search(delay, cycles):
    """The cycle in which it joins is twice as far away each time."""
    run = JoiningRun(delay).ask((1, 4), (4, 1), (1, 4), (4, 1)).ask((2, 3))
    run.until("5")
    assert run.core.cycle == cycles[-1]
    assert run.waits("5") == [f"it joins the plan in cycle {one}" for one in cycles]
    run.finish()


def test_new_goal_joins_when_the_plan_is_over():
    run = JoiningRun(delay=NEVER).ask((1, 2)).ask((3, 1))
    while run.core.plan.at(run.core.cycle + 1):
        run.go_on()
        assert run.fed == ["1"]
    run.finish()


def test_goals_that_come_before_others_join_wait_for_the_next_time():
    run = JoiningRun(delay=2).ask((1, 4), (4, 1), (1, 4)).ask((2, 3))
    run.go_on(4)
    run.ask((3, 2)).until("4")
    assert "5" not in run.fed
    run.until("5")
    run.finish()


def test_next_cycle_for_joining_is_nearer_after_each_success():
    run = JoiningRun(delay=3).ask((1, 4), (4, 1), (1, 4)).ask((2, 3))
    run.until("4")
    run.standby.delay, cycles = 0, []
    for number in range(5, 8):
        cycle = run.ask((2, 3)).core.cycle
        run.until(str(number))
        cycles.append(run.core.cycle - cycle)
    assert cycles[0] > cycles[1] > cycles[2] == 1
    run.finish()


@pytest.mark.parametrize("limits", [{"watch_joining": None}, {"solver": shortest}], ids=["no limit", "no standby"])
def test_new_goals_are_in_the_next_update(limits):
    """Without a limit of the wait, as with plans that are to be shortest, or without a standby worker."""
    run = JoiningRun(delay=NEVER, **limits).ask((2, 4)).ask((3, 1))
    run.step()
    assert run.fed == ["1", "2"]
    run.finish()


def test_goals_without_room_join_while_the_robot_acts(monkeypatch):
    monkeypatch.setattr(admission, "FIRST", 2)
    run = JoiningRun(delay=0, search_timeout=600.0).ask((1, 4), (4, 1), (1, 3), (3, 1), (2, 3))
    assert run.fed == ["1", "2"]
    run.go_on()
    assert run.fed == ["1", "2", "3", "4", "5"]
    run.finish()


def test_failure_brings_new_goals_into_the_update():
    """There is no plan that goes on."""
    run = JoiningRun(delay=NEVER).ask((1, 4), (4, 1)).ask((2, 3))
    run.go_on(2)
    run.step(fails=True)
    assert run.fed == ["1", "2", "3"]
    assert run.waits("3")[-1].startswith("it joins the plan in cycle ")
    run.finish()


def test_fact_is_in_the_next_update_without_new_goals():
    run = JoiningRun(delay=NEVER).ask((1, 4), (4, 1)).ask((2, 3))
    run.go_on()
    run.driver.facts("_blocked(o4,o1,now)")
    run.step()
    assert "_blocked(o4,o1," in run.driver.journal.updates[-1]
    assert run.fed == ["1", "2"]
    run.standby.delay = 0
    run.until("3")
    run.finish()


@pytest.mark.parametrize("delay", [0, 1, 2, NEVER])
def test_cancel_does_not_stop_the_robot(delay):
    run = JoiningRun(delay).ask((1, 4), (4, 1))
    run.go_on()
    run.driver.cancel("2")
    while "2" in run.fed and run.core.plan.at(run.core.cycle + 1):
        run.go_on()
    run.driver.finish()
    assert run.driver.states("2")[-1] in ("preempted", "succeeded")
    assert run.driver.states("1")[-1] == "succeeded"


def test_cancel_of_a_goal_that_is_to_join_ends_it():
    run = JoiningRun(delay=NEVER).ask((1, 4), (4, 1)).ask((2, 3), (3, 2))
    run.go_on(2)
    run.driver.cancel("3")
    assert run.driver.states("3")[-1] == "recalled"
    del run.office.packages[3]
    run.standby.delay = 0
    run.until("4")
    run.driver.finish()
    assert run.driver.states("4")[-1] == "succeeded"


EVENTS = st.lists(st.sampled_from(["done", "done", "done", "failed", "asked", "prepared"]), max_size=12)


@pytest.mark.mostly_slow
@settings(max_examples=max(1, settings.default.max_examples // 20))
@given(EVENTS, st.lists(st.permutations(range(1, 5)).map(lambda way: way[:2]), min_size=18, max_size=18), st.data())
def test_robot_acts_and_all_goals_are_met_however_late_answers_are(events, errands, data):
    run, ways = JoiningRun(), iter(errands)
    run.ask(*(next(ways) for _ in range(3)))
    for event in events:
        run.standby.delay = data.draw(st.sampled_from([0, 1, 2, 3, 5, NEVER]))
        if event == "asked":
            run.ask(next(ways))
        elif event == "prepared":
            run.core.prepare()
        elif event == "failed" and run.core.awaited:
            run.step(fails=True)
        elif run.core.awaited:
            run.go_on()
    run.finish()


@pytest.fixture(scope="module")
def row_process():
    with preparing_process(program(*ROW)) as one:
        yield one


@pytest.mark.slow
@pytest.mark.parametrize("waits", [True, False])
def test_standby_worker_that_has_the_plan_takes_over(row_process, waits):
    """A plan that is not there yet is waited for until the watch ends that."""
    looks = []
    run = JoiningRun(solver=lambda _: ProcessSolver(row_process), watch_joining=lambda: lambda: looks.append(1))
    run.ask((2, 4))
    spare = row_process.standby_pid
    run.ask((3, 1))
    prepare(run, row_process, waits)
    run.step()
    assert row_process.pid == spare
    assert waits or looks
    assert run.fed == ["1", "2"]
    run.finish()


@pytest.mark.slow
def test_worker_processes_let_goals_join_later(row_process):
    halts = []

    def watch():
        return lambda: Halt("the test") if halts else None

    run = JoiningRun(solver=lambda _: ProcessSolver(row_process), watch_joining=watch).ask((1, 4), (4, 1))
    halts.append(1)
    run.ask((2, 3))
    while "3" not in run.fed:
        run.step()
        wait_until_prepared(row_process, run.core.prepare)
    assert run.waits("3")
    run.finish()
