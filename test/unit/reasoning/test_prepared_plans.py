"""The answer is prepared should an action fail; each plan that goes out is one, whether it was prepared or not."""

import pytest
from children import preparing_process, wait_until_prepared
from core_driver import ERRANDS, Driver, shortest
from hypothesis import given, settings
from hypothesis import strategies as st
from mailbot_world import neighbours, program
from test_plans_that_go_out import Office, Run

from rosoclingo.planning.solver import PlanSolver
from rosoclingo.planning.workers.process_solver import ProcessSolver
from rosoclingo.reasoning.events import GoalChanged, ReturnTaken
from rosoclingo.reasoning.goals import Outcome
from rosoclingo.reasoning.settings import CoreSettings


class Noting(PlanSolver):
    """A solver that notes what it is to prepare, and what comes."""

    noted, came = [], []  # type: list, list

    def prefetch(self, update, before=()):
        self.noted += [*before, update]
        return True

    def update(self, update, *watch, **more):
        self.came.append(update)
        return super().update(update, *watch, **more)


@pytest.fixture
def driver():
    """A core whose solvers note what they are told."""
    Noting.noted, Noting.came = [], []
    return Driver(ERRANDS, solver=lambda one: shortest(one, Noting))


def prepared(driver):
    """What is prepared now."""
    Noting.noted.clear()
    driver.core.prepare()
    return [str(one) for one in Noting.noted]


def test_a_failure_is_prepared_for_as_it_was_last(driver):
    driver.goal("a", "do(x,1)")
    for told, reason in [("failed", "stuck(door)"), ("stuck(door)", "stuck(door)")]:
        (update,) = prepared(driver)
        assert f",{told}," in update
        driver.fail(reason)
        assert (str(Noting.came[-1]) == update) is (told == reason)


def test_what_has_come_meanwhile_is_prepared_for_with_success(driver):
    driver.goal("a", "do(x,1)")
    prepared(driver)
    driver.core.add_goal("b", "do(y,2)")
    (update,) = prepared(driver)
    assert "_request(do(y,2)," in update
    driver.succeed()
    assert str(Noting.came[-1]) == update


def test_nothing_is_prepared_again_before_something_changes(driver):
    driver.goal("a", "do(x,1)")
    assert len(prepared(driver)) == 1
    assert prepared(driver) == []
    driver.fail("failed")
    assert len(prepared(driver)) == 1


def test_nothing_is_prepared_where_nothing_runs(driver):
    assert prepared(driver) == []
    driver.goal("a", "do(x,1)").finish()
    assert prepared(driver) == []


FLOOR = (4, ((1, 2), (2, 3), (3, 4), (1, 4)), 1, 2)


class PreparedRun(Run):
    """A core whose solver's process prepares for failures."""

    def __init__(self, process):
        _, corridors, start, capacity = FLOOR
        self.office = Office(neighbours([(f"o{a}", f"o{b}") for a, b in corridors]), capacity, f"o{start}")
        self.shortest, self.failed, self.process = False, {}, process
        self.driver = Driver(settings=CoreSettings(), program=program(*FLOOR), solver=lambda _: ProcessSolver(process))

    def prepare(self, waits):
        """Prepare, and wait until that is done where it is so."""
        core = self.driver.run().core
        core.prepare()
        if waits:
            wait_until_prepared(self.process, core.prepare)

    @property
    def has_failed(self):
        """Whether the last action did."""
        return ",failed," in str(self.driver.journal.of(ReturnTaken)[-1].atom)


@pytest.fixture(scope="module")
def process():
    with preparing_process(program(*FLOOR)) as one:
        yield one


@pytest.mark.slow
def test_a_goal_that_comes_while_an_action_runs_has_its_plan_as_that_returns(process):
    run = PreparedRun(process)
    run.ask(1, 3)
    (action,) = run.driver.run().core.awaited
    run.ask(2, 4)
    run.prepare(waits=True)
    before = process.pid
    run.office.do(action)
    run.driver.succeed()
    assert process.pid != before
    assert len(run.driver.core.live_goals) == 2
    while any(run.office.packages.values()):
        run.step(fails=False)


ASKED = st.lists(st.permutations(range(1, 5)).map(lambda places: places[:2]), min_size=1, max_size=2)
STEPS = st.lists(st.tuples(st.booleans(), st.sampled_from(["no", "begun", "done"])), max_size=6)


@pytest.mark.slow
@pytest.mark.once
@settings(max_examples=max(1, settings.default.max_examples // 20))
@given(st.lists(st.tuples(ASKED, STEPS), min_size=1, max_size=2))
def test_what_goes_out_is_a_plan_whether_it_was_prepared_or_not(process, batches):
    run = PreparedRun(process)
    for asked, steps in batches:
        for places in asked:
            run.ask(*places)
        for number, (fails, prepares) in enumerate(steps):
            if not any(run.office.packages.values()):
                break
            if prepares != "no":
                run.prepare(waits=prepares == "done")
            before = process.pid
            run.step(fails)
            if number + 1 < len(steps):  # else goals may come with the return
                run.driver.run()
                assert prepares != "done" or (process.pid != before) is run.has_failed
    while any(run.office.packages.values()):
        run.step(fails=False)
    run.driver.run()
    ended = {one.outcome for one in run.driver.journal.of(GoalChanged) if one.outcome is not None}
    assert ended == {Outcome.SUCCEEDED}
