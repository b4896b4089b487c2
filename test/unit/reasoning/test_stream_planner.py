"""The stream planner: compaction, the horizon bound, and searches that end despite a stop or fail."""

import pytest
from core_driver import ERRANDS, FORGETFUL, Driver

from rosoclingo.oclingo import ReactiveProgram, SolverError, parse_update
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.reasoning.stream_planner import LONG_AGO, RECENT, Halt, Planner, steps_for


@pytest.mark.parametrize(
    ("cycle", "since", "first"),
    [
        (500, 499, 500 - RECENT),  # recent events can need an explanation in any case
        (500, 500 - RECENT - 20, 500 - RECENT - 20),  # an open request looks back to its beginning
        (500, 1, 500 - LONG_AGO),  # but not for ever
    ],
)
def test_planner_keeps_recent_steps_and_those_of_open_requests(cycle, since, first):
    planner = Planner(lambda: PlanSolver(ReactiveProgram.from_text(FORGETFUL)), 8)
    assert planner.first_open(cycle + 1, since) == first
    planner.update(parse_update("#step 2. #over 1. #endstep."))
    assert planner.first_open(3) == 1, "past steps stay past"


@pytest.mark.parametrize(
    ("steps", "arguments"),
    [
        # a tenth for each further goal
        *((100, (0, 100)), (100, (1, 100)), (110, (2, 100)), (140, (5, 100)), (13, (2, 11)), (11, (2, 10))),
        # the present plan, and a quarter for each new goal
        *((100, (1, 100, 300, 1)), (110, (2, 100, 20, 1)), (400, (28, 100, 302, 0)), (600, (36, 100, 299, 8))),
    ],
)
def test_planner_bounds_horizon_by_goals_and_plan(steps, arguments):
    assert steps_for(*arguments) == steps


def test_search_with_a_plan_despite_a_stop_is_complete():
    class DeafSolver(PlanSolver):
        def update(self, update, stopped=None):
            stopped()
            return super().update(update)

    driver = Driver(ERRANDS, solver=DeafSolver, watch=lambda: lambda: Halt("the test", disturbed=True))
    assert driver.goal("a", "do(walk,1)").awaited == ["_action_lib(walk,1,1)"]
    assert driver.problems == []


def test_failing_improvement_changes_nothing():
    class LostSolver(PlanSolver):
        def improve(self, stopped):
            raise SolverError("the worker is lost")

    driver = Driver(ERRANDS, solver=LostSolver).goal("a", "do(walk,1)")
    assert not driver.core.improve(lambda: False)
    assert driver.finish().states("a")[-1] == "succeeded"
