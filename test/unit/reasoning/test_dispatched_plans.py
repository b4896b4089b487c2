"""Each published plan is valid by an independent model: on any floor, with failures, and after improvement.

With ``~plan: shortest`` each plan has as few steps as a search from scratch finds. Improving leaves executed actions
and those under way alone. With a standby worker, answers for failing actions are prefetched, and new goals and
cancels join a running plan once a plan with them exists: the robot waits for no search.
"""

from functools import partial

import pytest
from children import preparing_process, wait_until_prepared
from core_driver import Driver, first, shortest, soon
from hypothesis import given, settings
from hypothesis import strategies as st
from late_standby import NEVER, Standby
from mailbot_world import neighbours, program
from office_world import Office

from rosoclingo.planning.workers.process_solver import ProcessSolver
from rosoclingo.reasoning.events import GoalChanged, ReturnAccepted
from rosoclingo.reasoning.goals import Outcome
from rosoclingo.reasoning.settings import CoreSettings
from rosoclingo.reasoning.stream_planner import unwatched

LOOKS = 300  # calls in which an improvement checks whether to stop

SOLVERS = {"shortest": shortest, "first": first, "soon": partial(soon, plan_time=0.05)}

#: Number of offices, corridors, start, capacity.
ROW = (4, ((1, 2), (2, 3), (3, 4)), 1, 3)
RING = (4, ((1, 2), (2, 3), (3, 4), (1, 4)), 1, 2)


@st.composite
def floors(draw):
    """Generate a connected floor."""
    count = draw(st.integers(3, 5))
    corridors = {(draw(st.integers(1, number - 1)), number) for number in range(2, count + 1)}
    if draw(st.booleans()):
        corridors.add((1, count))
    return count, tuple(sorted(corridors)), draw(st.integers(1, count)), draw(st.integers(1, 3))


class Run:
    """A core on a floor, its goals, and failures, at most two in a row per action."""

    def __init__(self, floor, solver, search_timeout=10.0, **watches):
        _, corridors, start, capacity = floor
        self.office = Office(neighbours([(f"o{a}", f"o{b}") for a, b in corridors]), capacity, f"o{start}")
        self.failed, limits = {}, CoreSettings(search_timeout=search_timeout)
        self.driver = Driver(settings=limits, program=program(*floor), solver=solver, **watches)
        self.core = self.driver.core

    def ask(self, *errands):
        """Send further goals; the core advances at the next step."""
        for origin, destination in errands:
            number = len(self.office.packages) + 1
            self.office.packages[number] = ("waits", f"o{origin}", f"o{destination}")
            self.core.add_goal(str(number), f"goal(o{origin},o{destination},{number})")

    def end(self, fails=False):
        """End the action under way, with a failure at most twice; the core does not advance."""
        (action,) = self.core.awaited
        times = self.failed.get(action.parameter, 0)
        fails = fails and times < 2
        self.failed[action.parameter] = times + 1 if fails else 0
        if not fails:
            self.office.do(action)
        value = "failed" if fails else action.parameter
        self.core.receive("world", [f"_return({action.interface},{value},{action.cycle})"])

    def finish(self):
        """Execute and report all goals."""
        while self.driver.run().core.awaited:
            self.end()
        assert set(self.office.packages.values()) <= {None}
        assert {one.outcome for one in self.driver.journal.of(GoalChanged)} <= {None, Outcome.SUCCEEDED}
        assert self.core.live_goals == []


class JudgedRun(Run):
    """Judge each plan, and improve it unless it is to be shortest."""

    def __init__(self, floor, solver, is_shortest=False):
        super().__init__(floor, solver)
        self.is_shortest = is_shortest

    def step(self, fails):
        """Advance the core, judge its plan, and end its action."""
        core = self.driver.run().core
        steps = self.office.judge(core.plan.actions, core.cycle)
        if self.is_shortest:
            assert steps == self.office.fewest()
        else:
            self.improve(steps)
        self.end(fails)

    def improve(self, steps):
        """Check that plans only get shorter and stay valid, and that executed and running actions stay."""
        core, looks = self.core, iter(range(LOOKS))
        fixed = [one for one in core.plan.actions if one.cycle <= core.cycle], core.awaited, core.cycle
        core.compact(lambda: False)
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
def test_plan_that_goes_out_is_valid(kind, data):
    floor = data.draw(floors())
    run, ways = JudgedRun(floor, SOLVERS[kind], kind == "shortest"), st.permutations(range(1, floor[0] + 1))
    for _ in range(data.draw(st.integers(1, 4), label="batches")):
        for _ in range(data.draw(st.integers(1, 2), label="goals")):
            run.ask(data.draw(ways)[:2])
        for fails in data.draw(st.lists(st.sampled_from([False, False, True]), max_size=8), label="failures"):
            if any(run.office.packages.values()):
                run.step(fails)
    run.finish()


# ---- Prefetching


@pytest.fixture(scope="module")
def ring_process():
    with preparing_process(program(*RING)) as one:
        yield one


def prepare(run, process, waits=True):
    """Prefetch, and wait for the result if it is asynchronous."""
    run.driver.run().core.prepare()
    if waits:
        wait_until_prepared(process, run.core.prepare)


ASKED = st.lists(st.permutations(range(1, 5)).map(lambda places: places[:2]), min_size=1, max_size=2)
STEPS = st.lists(st.tuples(st.booleans(), st.sampled_from(["no", "begun", "done"])), max_size=6)


@pytest.mark.slow
@settings(max_examples=max(1, settings.default.max_examples // 20))
@given(st.lists(st.tuples(ASKED, STEPS), min_size=1, max_size=2))
def test_plan_that_goes_out_is_valid_with_prefetching(ring_process, batches):
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
            if number + 1 < len(steps):  # otherwise goals could come with the return
                has_failed = ",failed," in str(run.driver.run().journal.of(ReturnAccepted)[-1].atom)
                assert prepares != "done" or (ring_process.pid != before) is has_failed
    run.finish()


# ---- Goals that join a plan


class JoiningRun(Run):
    """A core whose standby worker answers some cycles late."""

    def __init__(self, delay=0, solver=None, watch_joining=unwatched):
        self.standby = Standby(delay)
        super().__init__(ROW, solver or self.standby.solver, 0.0, watch_joining=watch_joining)

    @property
    def fed(self):
        """Return the goals that the program knows."""
        return [goal.key for goal in self.core.live_goals if goal.fed]

    @property
    def continues(self):
        """Whether the plan in force has an action in the next cycle."""
        return bool(self.core.plan.at(self.core.cycle + 1))

    def ask(self, *errands):
        super().ask(*errands)
        self.driver.run()
        return self

    def step(self, fails=False):
        """End the action and advance the core."""
        self.end(fails)
        self.driver.run()

    def go_on(self):
        """End the action; if the plan in force has another action, it goes out without a search."""
        due, before = self.continues, self.standby.searches
        self.step()
        assert not due or (self.core.awaited and self.standby.searches == before)


@pytest.mark.slow
def test_goal_joins_the_plan_in_a_later_cycle():
    run = JoiningRun(delay=3).ask((1, 4), (4, 1), (1, 4), (4, 1)).ask((2, 3))
    while "5" not in run.fed:
        run.go_on()
    waits = [one.waits for one in run.driver.feedback("5") if one.waits]
    assert waits == [f"it joins the plan in cycle {one}" for one in (3, 6)]
    assert run.core.cycle == 6
    run.finish()


@pytest.mark.slow
@pytest.mark.parametrize("limits", [{"watch_joining": None}, {"solver": shortest}], ids=["no limit", "no standby"])
def test_new_goals_join_next_update_without_wait_limit(limits):
    """There is no limit of the wait with shortest plans, or without a standby worker."""
    run = JoiningRun(delay=NEVER, **limits).ask((2, 4)).ask((3, 1))
    run.step()
    assert run.fed == ["1", "2"]
    run.finish()


EVENTS = st.lists(st.sampled_from(["done", "done", "done", "failed", "asked", "prepared"]), max_size=12)


@pytest.mark.slow
@settings(max_examples=max(1, settings.default.max_examples // 20))
@given(EVENTS, st.lists(st.permutations(range(1, 5)).map(lambda way: way[:2]), min_size=18, max_size=18), st.data())
def test_robot_meets_all_goals_however_late_answers_are(events, errands, data):
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
