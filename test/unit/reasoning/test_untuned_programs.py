"""A core with programs that give the solver no advice: plans are valid, short, and hold no superfluous action."""

from functools import lru_cache, partial
from random import Random

import pytest
from core_driver import Driver, shortest, soon
from untuned_programs import disinfection, elevator, keys, superfluous

from rosoclingo.oclingo import parse_update
from rosoclingo.planning.history import Plan
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.reasoning import CoreSettings
from rosoclingo.reasoning.stream_planner import Halt

#: Takes the first plan that is found: no time is left to shorten it.
FIRST = partial(soon, plan_time=0.0)

TASKS = {
    "disinfection": partial(disinfection, 5, 4),
    "keys": partial(keys, 4, 2),
    "elevator": partial(elevator, 4, 3),
}

LARGE = {
    "disinfection": partial(disinfection, 8, 6),
    "keys": partial(keys, 6, 3),
    "elevator": partial(elevator, 6, 5),
}

#: Steps of a plan that the core executes, at most, over those of the shortest one for all goals.
FACTOR = 1.5


def deeds_of(actions):
    return [(one.interface_name, str(one.parameter)) for one in sorted(actions, key=lambda one: one.cycle)]


def ask_all(task):
    """A solver's first update, with all goals."""
    return parse_update("#step 1 : 100.\n" + "".join(f"_request({goal},2).\n" for goal in task.goals) + "#endstep.")


def world_of(task):
    """A world in which all goals are asked for."""
    world = task.world()
    for number in range(1, len(task.goals) + 1):
        task.ask(world, number)
    return world


@lru_cache(maxsize=None)
def shortest_steps(kind, seed):
    task = TASKS[kind](seed)
    return shortest(task.program).update(ask_all(task)).horizon


class Run:
    """A core and the world in which it acts: its goals all come at once, and then some are cancelled.

    Every plan is looked at when it goes out: when its first action does, and when it has been improved.
    """

    def __init__(self, task, leaves_at=None):
        """With ``leaves_at`` the first search that grounds so many steps is left, and the first goal cancelled."""
        self.task, self.world, self.steps, self.left = task, world_of(task), 0, False
        self._leaves_at, self._solvers = leaves_at, []
        self._driver = Driver(program=task.program, solver=self._made, settings=CoreSettings(), watch=self._watch)
        self.core = self._driver.core
        for number, goal in enumerate(task.goals, 1):
            self.core.add_goal(str(number), goal)
        self._go_on()

    def _made(self, program):
        self._solvers.append(FIRST(program))
        return self._solvers[-1]

    def _watch(self):
        def look():
            """Leave the search if it has grounded so many steps."""
            if self._leaves_at is None or all(one.reached < self._leaves_at for one in self._solvers):
                return None
            self.left = True
            return Halt("a cancel", disturbed=True)

        return look

    def _go_on(self):
        while self.core.advance(1.0):
            if self.left and self._leaves_at is not None:
                self._leaves_at = None
                self.cancel(1)
        if self.core.awaited:
            self._look_at_plan(fixed=0)

    def _look_at_plan(self, fixed):
        deeds = deeds_of(self.core.plan.after(self.core.cycle - 1))
        assert {place for place in superfluous(self.world, deeds) if place >= fixed} == set(), deeds

    @property
    def updates(self):
        """The texts of all updates."""
        return self._driver.journal.updates

    def cancel(self, number):
        self.core.cancel_goal(str(number))
        self.world.cancel(number)

    def improve(self):
        while self.core.improve(lambda: False):
            self._look_at_plan(fixed=len(self.core.awaited))

    def succeed(self, *cancelled):
        """What is under way succeeds, and some goals are cancelled before the next action begins."""
        for action in self.core.awaited:
            self.world.do(action.interface_name, str(action.parameter))
            self.steps += 1
            self.core.receive("world", [f"_return({action.interface},{action.parameter},{action.cycle})"])
        for number in cancelled:
            self.cancel(number)
        self._go_on()


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize("kind", sorted(LARGE))
def test_first_plan_is_valid_without_superfluous_actions(kind, seed):
    task = LARGE[kind](seed)
    result = FIRST(task.program).update(ask_all(task))
    plan = Plan.from_result(result)
    assert plan is not None
    actions = sorted(plan.actions, key=lambda one: one.arguments[2].number)
    assert superfluous(world_of(task), [(one.arguments[0].name, str(one.arguments[1])) for one in actions]) == set()
    assert [one.arguments[2].number for one in actions] == list(range(1, result.horizon + 1)), "no step is idle"


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize("kind", sorted(TASKS))
def test_executed_steps_are_few_where_goals_are_cancelled_at_random(kind, seed):
    source, run = Random(seed), Run(TASKS[kind](seed))
    goals = len(run.task.goals)
    while run.core.awaited:
        run.improve()
        run.succeed(*[source.randint(1, goals)] * (source.random() < 0.1))
    assert run.world.at_rest
    assert run.steps <= FACTOR * shortest_steps(kind, seed)
    assert run.core.live_goals == []


@pytest.mark.parametrize("leaves_at", [9, 17, 33])
@pytest.mark.parametrize("kind", sorted(TASKS))
def test_executed_steps_are_few_where_a_search_was_left_for_a_cancel(kind, leaves_at):
    run = Run(TASKS[kind](1), leaves_at)
    while run.core.awaited:
        run.improve()
        run.succeed()
    assert run.world.at_rest
    assert run.steps <= FACTOR * shortest_steps(kind, 1)


@pytest.mark.parametrize("kind", sorted(TASKS))
def test_improvement_goes_on_after_predicted_updates_until_plans_are_short(kind):
    """Where the plan has had no time while the first actions ran."""
    run = Run(TASKS[kind](2))
    for _ in range(3):
        run.succeed()
    left = len(run.core.plan.after(run.core.cycle - 1))
    run.improve()
    improved = len(run.core.plan.after(run.core.cycle - 1))
    assert improved <= left
    solver = PlanSolver(run.task.program)
    for update in run.updates:
        best = solver.update(parse_update(update))
    assert improved == best.horizon - run.core.cycle + 1
