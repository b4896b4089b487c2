"""The bench of domains, with its smallest tasks and without Fast Downward; and the domains' PDDL."""

import re
from argparse import Namespace

import domains
import peers
import pytest
from deliveries import random_requests, row, task_of
from planning_domains import DOMAINS, RuleError, check, superfluous

OPTIONS = Namespace(seed=1, seconds=0.5, action_time=0.1, limit=60.0, lama_seconds=1.0)


@pytest.mark.slow
def test_planning_domains_row_has_valid_plans_of_planners():
    cells = domains.measure_row("crates", "small", OPTIONS)
    assert cells["incmode"] == cells["best"] <= cells["improved"] <= cells["out"] <= cells["first"]
    assert cells["executed"] >= cells["best"]
    assert cells["steps/best"] == cells["executed"] / cells["best"]
    assert cells["first/lama"] is None, "it has simultaneous actions"


@pytest.mark.slow
def test_planning_domains_cell_beyond_limit_is_empty(monkeypatch):
    monkeypatch.setattr(peers, "folder_of", lambda package: None)
    cells = domains.measure_row("tiles", "large", Namespace(**{**vars(OPTIONS), "limit": 1e-6}))
    assert set(cells.values()) == {None}


@pytest.mark.parametrize("name", sorted(DOMAINS))
def test_planning_domains_tasks_follow_from_their_seed(name):
    make, args = DOMAINS[name].make, DOMAINS[name].sizes["large"]
    first, again, other = make(*args, seed=1), make(*args, seed=1), make(*args, seed=2)
    assert (first.sources, first.goals) == (again.sources, again.goals) != (other.sources, other.goals)
    assert first.problem == again.problem


TASKS = {name: one.make(*one.sizes["small"]) for name, one in DOMAINS.items()}
TASKS["deliveries"] = task_of(row(4), random_requests(row(4), 3, seed=1))


@pytest.mark.parametrize("name", sorted(TASKS))
def test_planning_domains_problems_use_predicates_of_domain(name):
    task = TASKS[name]
    known = re.search(r"\(:predicates((?:\s*\([^()]*\))*)\)", task.domain).group(1)
    init, goal = task.problem.split("(:init", 1)[1].split("(:goal (and", 1)
    atoms = [one.split() for one in re.findall(r"\(([^()]+)\)", init + goal)]
    arity = {one.split()[0]: one.count("?") for one in re.findall(r"\(([^()]+)\)", known)}
    assert {(predicate, len(arguments)) for predicate, *arguments in atoms} <= set(arity.items())


def test_planning_domains_plan_is_checked_stepwise():
    world = DOMAINS["gripper"].make(2, 1).world()
    plan = [[("left", "take(ball1)")], [("go", "room1")], [("left", "put(ball1)")]]
    check(world, plan)
    assert superfluous(world, plan) == set()
    with pytest.raises(RuleError, match="impossible"):
        check(world, [plan[1], plan[0], plan[2]])
    with pytest.raises(RuleError, match="all goals"):
        check(world, plan[:2])
    detour = [[("go", "room1")], [("go", "hall")], *plan]
    assert superfluous(world, detour) == {(0, ("go", "room1"))}, "the way back depends on it"


def test_planning_domains_joint_actions_execute_together():
    world = DOMAINS["crates"].make(2, 1, 0, seed=1).world()
    start = next(atom[2] for atom in world.state if atom[:2] == ("in", "c1"))
    for robot in ("anna", "otto"):
        if start != "dock":
            world.do([(robot, f"go({start})")])
    world.do_possible([("anna", "lift(c1)")])
    assert ("empty",) in world.state
    world.do([("anna", "lift(c1)"), ("otto", "lift(c1)")])
    assert ("carried", "c1") in world.state
    with pytest.raises(RuleError, match="impossible"):
        world.do([("anna", "drop(c1)")])
