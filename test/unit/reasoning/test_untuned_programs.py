"""A core with programs without solver heuristics: plans are valid and short, without superfluous actions."""

from functools import lru_cache
from random import Random

import pytest
from core_driver import Driver, first, shortest
from incmode import shortest_plan
from planning_domains import DOMAINS, check, superfluous
from workloads import sized

from rosoclingo.oclingo import parse_update
from rosoclingo.planning.history import Plan
from rosoclingo.reasoning.events import GoalChanged
from rosoclingo.reasoning.goals import Outcome
from rosoclingo.reasoning.settings import CoreSettings

#: The arguments of a task that is executed, and of a larger one that is only planned.
SIZES = {
    "blocks": ((6,), (8,)),
    "gripper": ((2, 3), (3, 5)),
    "elevator": ((4, 3), (6, 5)),
    "hanoi": ((3,), (4,)),
    "tiles": ((3, 2, 8), (3, 3, 10)),
    "keys": ((4, 2), (6, 3)),
    "disinfection": ((5, 4), (8, 6)),
    "garden": ((3,), (6,)),
    "crates": ((4, 1, 2), (6, 2, 3)),
}


#: Additional steps of an executed plan, at most, compared with the shortest one for all goals.
FACTOR = 1.5


def task_of(kind, seed, large=False):
    return DOMAINS[kind].make(*SIZES[kind][large], seed=seed)


def steps_of(actions):
    """Return the steps of a plan; a step without an action does not count."""
    steps = {}
    for action in sorted(actions, key=lambda one: one.cycle):
        steps.setdefault(action.cycle, []).append((action.interface_name, str(action.parameter)))
    return list(steps.values())


def steps_of_answer(result):
    """Return the steps of the plan in an answer, including idle ones."""
    steps = [[] for _ in range(result.horizon)]
    for interface, parameter, cycle in (one.arguments for one in Plan.from_result(result).actions):
        steps[cycle.number - 1].append((str(interface), str(parameter)))
    return steps


def ask_all(task):
    """Return a solver's first update, with all goals."""
    requests = "".join(f"_request({goal.term},2).\n" for goal in task.goals)
    return parse_update(f"#step 1 : 100.\n{requests}#endstep.")


@lru_cache(maxsize=None)
def reference(kind, seed):
    """Return a shortest plan, found by plain clingo."""
    task = task_of(kind, seed)
    return shortest_plan([source.text for source in task.sources], [goal.term for goal in task.goals])


class Run:
    """A core and the world in which it acts: its goals come at once, and some are cancelled later.

    Every plan is checked when its first action goes out, and after each improvement.
    """

    def __init__(self, task):
        self.task, self.world, self.steps, self.failed, self.given_up = task, task.world(), 0, 0, set()
        self._driver = Driver(program=task.program, solver=first, settings=CoreSettings())
        self.core = self._driver.core
        for number, goal in enumerate(task.goals, 1):
            self.core.add_goal(str(number), goal.term)
        self._go_on()

    def _go_on(self):
        self._driver.run()
        if self.core.awaited:
            self._check_plan(fixed=0)

    def _check_plan(self, fixed):
        """Check the plan; its first ``fixed`` steps have begun."""
        found = superfluous(self.world, self.plan)
        assert {one for one in found if one[0] >= fixed} == set(), self.plan

    @property
    def plan(self):
        """Return the steps of the plan from the present one on."""
        return steps_of(self.core.plan.remaining(self.core.cycle))

    @property
    def aborted(self):
        """Return the numbers of the goals that the core has aborted."""
        ended = self._driver.journal.of(GoalChanged)
        return {int(event.key) for event in ended if event.outcome is Outcome.ABORTED}

    def cancel(self, number):
        self.core.cancel_goal(str(number))
        self.world.cancel(number)

    def improve(self):
        while self.core.improve(lambda: False):
            self._check_plan(fixed=1)

    def end_actions(self, fails=lambda: False, cancelled=()):
        """Return the actions under way, and cancel some goals before the next action begins."""
        under_way = {action: (action.interface_name, str(action.parameter)) for action in self.core.awaited}
        failed = [one for one in under_way.values() if self.world.can_fail(one) and fails()]
        if failed:
            before = set(self.world.open)
            for one in failed:
                self.world.fail(one)
            self.given_up |= before - set(self.world.open)
            self.world.do_possible([one for one in under_way.values() if one not in failed])
        else:
            self.world.do(list(under_way.values()))
        self.steps, self.failed = self.steps + 1, self.failed + bool(failed)
        for action, one in under_way.items():
            value = "slipped" if one in failed else action.parameter
            self.core.receive("world", [f"_return({action.interface},{value},{action.cycle})"])
        for number in cancelled:
            self.cancel(number)
        self._go_on()


@pytest.mark.sampled(4)
@pytest.mark.mostly_slow
@pytest.mark.parametrize("seed", sized([1], [1, 2, 3]))
@pytest.mark.parametrize("kind", sorted(SIZES))
def test_untuned_first_plan_has_no_superfluous_actions(kind, seed):
    task = task_of(kind, seed, large=sized(False, True))
    plan = steps_of_answer(first(task.program).update(ask_all(task)))
    assert superfluous(task.world(), plan) == set()
    assert all(plan), "no step is idle"


@pytest.mark.sampled(4)
@pytest.mark.parametrize("seed", sized([2], [1, 2, 4]))
@pytest.mark.parametrize("kind", sorted(SIZES))
def test_untuned_shortest_plan_matches_plain_clingo(kind, seed):
    task = task_of(kind, seed)
    plan = steps_of_answer(shortest(task.program).update(ask_all(task)))
    assert superfluous(task.world(), plan) == set()
    check(task.world(), reference(kind, seed))
    assert len(plan) == len(reference(kind, seed))


@pytest.mark.sampled(3)
@pytest.mark.slow
@pytest.mark.parametrize("seed", sized([1], [1, 2]))
@pytest.mark.parametrize("kind", sorted(SIZES))
def test_untuned_run_is_short_despite_cancels_and_failures(kind, seed):
    source, run = Random(seed), Run(task_of(kind, seed))
    goals = len(run.task.goals)
    while run.core.awaited:
        run.improve()
        cancelled = [source.randint(1, goals)] * (source.random() < 0.1)
        run.end_actions(lambda: source.random() < 0.1, cancelled)
    assert run.world.at_rest
    assert run.steps - run.failed <= FACTOR * len(reference(kind, seed))
    assert run.core.live_goals == []
    assert run.aborted == run.given_up
