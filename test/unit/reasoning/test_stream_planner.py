"""The stream planner: compaction, the horizon bound, and searches that end despite a stop or fail."""

from core_driver import ERRANDS, Driver

from rosoclingo.oclingo import SolverError
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.reasoning.stream_planner import Halt


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


def test_history_is_compacted_only_while_actions_run_and_nothing_waits():
    compactions = []

    class NotingSolver(PlanSolver):
        def compact(self, stopped):
            compactions.append(self.step)

    driver = Driver(ERRANDS, solver=NotingSolver)
    driver.core.compact(lambda: False)
    assert compactions == []
    driver.goal("a", "do(walk,1)").core.compact(lambda: False)
    assert compactions == [1]
    driver.core.add_goal("b", "do(walk,2)")
    driver.core.compact(lambda: False)
    assert compactions == [1]
