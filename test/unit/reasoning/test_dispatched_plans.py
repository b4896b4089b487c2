"""Each published plan is valid by an independent model: on any floor, with failures, and after improvement.

With ``~plan: shortest`` each plan has as few steps as a search from scratch finds. Improving leaves executed actions
and those under way alone. With a standby worker, answers for failing actions are prefetched, and new goals and
cancels join a running plan once a plan with them exists: the robot waits for no search.
"""

from functools import partial

import pytest
from children import preparing_process, wait_until_prepared
from core_driver import Driver, shortest, soon
from core_scripts import perform, scripts
from hypothesis import given, settings
from hypothesis import strategies as st
from late_standby import NEVER, Standby
from mailbot_world import neighbours, program
from office_world import Office

from rosoclingo.planning.workers.process_solver import ProcessSolver
from rosoclingo.reasoning.events import GoalChanged, ReturnAccepted
from rosoclingo.reasoning.goals import Outcome
from rosoclingo.reasoning.settings import CoreSettings
from rosoclingo.reasoning.stream_planner import Halt, unwatched

pytestmark = pytest.mark.once

LOOKS = 300  # calls in which an improvement checks whether to stop

SOLVERS = {"shortest": shortest, "first": partial(soon, plan_time=0.0), "soon": partial(soon, plan_time=0.05)}

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


@pytest.mark.slow
def test_goal_arriving_during_action_has_plan_at_its_return(ring_process):
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
    """A core whose standby worker answers some cycles late, and the words of scripts."""

    def __init__(self, delay=0, solver=None, watch_joining=unwatched, search_timeout=0.0):
        self.standby = Standby(delay)
        super().__init__(ROW, solver or self.standby.solver, search_timeout, watch_joining=watch_joining)

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

    def goals(self, *ways):
        """Send goals such as 1-4, from office o1 to o4."""
        return self.ask(*(way.split("-") for way in ways))

    def step(self, fails=False):
        """End the action and advance the core."""
        self.end(fails)
        self.driver.run()

    def fail(self):
        self.step(fails=True)

    def go_on(self, times=1):
        """End the action; if the plan in force has another action, it goes out without a search."""
        for _ in range(int(times)):
            due, before = self.continues, self.standby.searches
            self.step()
            assert not due or (self.core.awaited and self.standby.searches == before)

    def until(self, key):
        """Continue until the program knows a goal."""
        while key not in self.fed:
            self.go_on()

    def alone(self, *keys):
        """Continue to the end of the plan; meanwhile the program knows only these goals."""
        while self.continues:
            self.go_on()
            assert self.fed == list(keys)

    def delay(self, cycles):
        self.standby.delay = int(cycles)

    def cancel(self, key):
        self.driver.cancel(key)

    def forget(self, key):
        """Remove the package of a cancelled goal."""
        del self.office.packages[int(key)]

    def while_known(self, key):
        """Continue while the program knows a goal and the plan has further actions."""
        while key in self.fed and self.continues:
            self.go_on()

    def facts(self, *facts):
        self.driver.facts(*facts)

    # -- expectations

    def has(self, *keys):
        assert self.fed == list(keys)

    def lacks(self, key):
        assert key not in self.fed

    def cycle(self, number):
        assert self.core.cycle == int(number)

    def joins(self, key, *cycles):
        """Expect that a client received these cycles in which its goal would join the plan."""
        waits = [one.waits for one in self.driver.feedback(key) if one.waits]
        assert waits == [f"it joins the plan in cycle {one}" for one in cycles]

    def sends(self, text):
        assert text in self.driver.journal.updates[-1]

    def ended(self, key, *states):
        """Expect a goal to end in one of these states, after the success of all actions."""
        self.driver.finish()
        assert self.driver.states(key)[-1] in states


#: The delay of the standby worker in cycles, and the script. The next cycle for joining is twice as far away each time.
JOINS = {
    "goal is in the next update if it was prefetched": (0, "goals 2-4; goals 3-1; go_on; has 1 2; joins 2; finish"),
    **{f"goal joins {delay} cycles late": (delay, f"""
        goals 1-4 4-1 1-4 4-1; goals 2-3; until 5; cycle {cycles.split()[-1]}; joins 5 {cycles}; finish""")
       for delay, cycles in ((1, "3"), (3, "3 6"))},
    "goal joins when the plan ends": (NEVER, "goals 1-2; goals 3-1; alone 1; finish"),
    "failure brings new goals into the next update": (NEVER, """
        goals 1-4 4-1; goals 2-3; go_on 2; fail; has 1 2 3; joins 3 3 6; finish"""),
    "fact is in the next update without new goals": (NEVER, """
        goals 1-4 4-1; goals 2-3; go_on; facts _blocked(o4,o1,now); step; sends _blocked(o4,o1,; has 1 2
        delay 0; until 3; finish"""),
}  # fmt: skip
SLOW_JOINS = {
    "new goals wait while others are about to join": (2, """
        goals 1-4 4-1 1-4; goals 2-3; go_on 4; goals 3-2; until 4; lacks 5; until 5; finish"""),
    "goal that would join is cancelled": (NEVER, """
        goals 1-4 4-1; goals 2-3 3-2; go_on 2; cancel 3; forget 3; delay 0; until 4; ended 3 recalled; ended 4 succeeded
        """),
    **{f"cancel is answered {delay} cycles late": (delay, """
        goals 1-4 4-1; go_on; cancel 2; while_known 2; ended 2 preempted succeeded; ended 1 succeeded""")
       for delay in (2, NEVER)},
}  # fmt: skip


@pytest.mark.sampled(4)
@pytest.mark.slow
@scripts(JOINS, SLOW_JOINS)
def test_goals_join_without_a_search_for_the_next_action(row):
    delay, script = row
    perform(JoiningRun(delay), script)


@pytest.mark.slow
def test_next_cycle_for_joining_is_nearer_after_success():
    run = perform(JoiningRun(delay=3), "goals 1-4 4-1 1-4; goals 2-3; until 4; delay 0")
    cycles = []
    for number in range(5, 8):
        cycle = run.core.cycle
        perform(run, f"goals 2-3; until {number}")
        cycles.append(run.core.cycle - cycle)
    assert cycles[0] > cycles[1] > cycles[2] == 1
    run.finish()


@pytest.mark.slow
@pytest.mark.parametrize("limits", [{"watch_joining": None}, {"solver": shortest}], ids=["no limit", "no standby"])
def test_new_goals_join_next_update_without_wait_limit(limits):
    """There is no limit of the wait with shortest plans, or without a standby worker."""
    perform(JoiningRun(delay=NEVER, **limits), "goals 2-4; goals 3-1; step; has 1 2; finish")


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


@pytest.fixture(scope="module")
def row_process():
    with preparing_process(program(*ROW)) as one:
        yield one


@pytest.mark.slow
def test_standby_worker_that_still_plans_takes_over(row_process):
    """The core waits for a missing plan until the watch ends the wait."""
    looks = []
    run = JoiningRun(solver=lambda _: ProcessSolver(row_process), watch_joining=lambda: lambda: looks.append(1))
    run.ask((2, 4))
    spare = row_process.standby_pid
    run.ask((3, 1))
    prepare(run, row_process, waits=False)
    run.step()
    assert row_process.pid == spare
    assert looks
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
    assert any(one.waits for one in run.driver.feedback("3"))
    run.finish()
