"""The bench of domains, with its smallest tasks and without Fast Downward; and the domains' PDDL."""

import re
import sys
from argparse import Namespace
from pathlib import Path

import pytest

sys.path.append(str(Path(__file__).resolve().parents[3] / "bench"))

import domains  # noqa: E402
from deliveries import pddl_of, random_requests, row  # noqa: E402
from planning_domains import DOMAINS, RuleError, check, superfluous  # noqa: E402

OPTIONS = Namespace(
    without=["fast_downward_plans"],
    plan_time=1.0,
    seconds=0.5,
    action_time=0.1,
    search_timeout=10.0,
    limit=60.0,
    lama_seconds=1.0,
)


@pytest.mark.slow
@pytest.mark.once
def test_planning_domains_row_has_valid_plans_of_planners():
    cells = domains.measure("crates", "small", 1, OPTIONS)
    assert cells["incmode"] == cells["best"] <= cells["improved"] <= cells["out"] <= cells["first"]
    assert cells["executed"] >= cells["best"]
    assert cells["steps"] == cells["executed"] / cells["best"]
    assert cells["lama-first"] is cells["time"] is None


@pytest.mark.slow
@pytest.mark.once
def test_planning_domains_cell_beyond_limit_is_empty():
    options = Namespace(**{**vars(OPTIONS), "limit": 1e-6})
    cells = domains.measure("tiles", "large", 1, options)
    assert set(cells.values()) == {None}


@pytest.mark.parametrize("name", sorted(DOMAINS))
def test_planning_domains_tasks_follow_from_their_seed(name):
    make, args = DOMAINS[name].make, DOMAINS[name].sizes["large"]
    first, again, other = make(*args, seed=1), make(*args, seed=1), make(*args, seed=2)
    assert (first.sources, first.goals) == (again.sources, again.goals) != (other.sources, other.goals)
    assert first.pddl is None or first.pddl.problem == again.pddl.problem != other.pddl.problem


TASKS = {name: one.make(*one.sizes["small"]).pddl for name, one in DOMAINS.items() if name != "crates"}
TASKS["deliveries"] = pddl_of(row(4), random_requests(row(4), 3, seed=1))


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
    with pytest.raises(RuleError, match="not here"):
        check(world, [plan[1], plan[0], plan[2]])
    with pytest.raises(RuleError, match="all goals"):
        check(world, plan[:2])
    detour = [[("go", "room1")], [("go", "hall")], *plan]
    assert superfluous(world, detour) == {(0, ("go", "room1"))}, "the way back depends on it"


def test_planning_domains_joint_actions_execute_together():
    world = DOMAINS["crates"].make(2, 1, 0, seed=1).world()
    start = world.places["c1"]
    world.at = dict.fromkeys(world.at, start)
    world.do_possible([("anna", "lift(c1)")])
    assert world.carried == ""
    world.do([("anna", "lift(c1)"), ("otto", "lift(c1)")])
    assert world.carried == "c1"
    with pytest.raises(RuleError, match="two robots"):
        world.do([("anna", "drop(c1)")])
