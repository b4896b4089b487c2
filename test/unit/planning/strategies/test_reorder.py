"""Candidates for shorter plans: tasks in another order, by transitions that the plan itself contains."""

from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rosoclingo.oclingo import parse_atom
from rosoclingo.planning.history import Plan, cycle_of
from rosoclingo.planning.strategies.reorder import reordered

#: Twice from a over b to c and back; 7 steps suffice.
TO_AND_FRO = "go a; go b; go c; water fern; go b; go a; water rose; go b; go c; water lily; go b; go a; water ivy"

CAPACITY = 2


def plan_of(acts, first=1):
    """Return the plan with these acts in sequence, such as "go a; take b"."""
    texts = [one.split(" ", 1) for one in acts.split("; ") if one]
    actions = [f"_action_lib({kind},{what},{cycle})" for cycle, (kind, what) in enumerate(texts, first)]
    return Plan(frozenset(map(parse_atom, actions)), first + len(texts) - 1)


def acts_of(plan):
    return [f"{one.arguments[0]} {one.arguments[1]}" for one in sorted(plan.actions, key=cycle_of)]


def candidate(plan, step=0, stopped=lambda: False, seed=1):
    return reordered(plan, step, Random(seed), stopped)


@pytest.mark.parametrize("first", [1, 40])
def test_reordered_joins_tasks_at_one_place(first):
    found = candidate(plan_of(TO_AND_FRO, first), first)
    assert found.horizon == first + 6
    assert sorted(map(cycle_of, found.actions)) == [*range(first + 1, first + 7)]
    assert acts_of(found)[2:4] == ["go b", "go c"]
    back = candidate(plan_of(TO_AND_FRO + "; go b"), 1)
    assert (back.horizon, acts_of(back)[-1]) == (8, "go b"), "it ends at the place where the plan ends"


def test_reordered_continues_open_chains_on_the_way():
    acts = "take 1; take 2; go b; go c; put 2; go b; put 1; go a; take 3; go b; go c; put 3; go b; go a; take 4"
    found = acts_of(candidate(plan_of(acts)))
    assert found[found.index("go b") + 1] == "put 1"


@pytest.mark.slow
def test_reordered_uses_return_ways_in_some_searches():
    ring = plan_of("go a; go b; go c; go d; take 1; go a; go b; go c; go d; take 2; go a")
    assert {candidate(ring, 1, seed=seed).horizon for seed in range(9)} == {5, 7}


@pytest.mark.parametrize(
    "acts",
    ["", "go a; go b; go a", "water fern; water rose", "go a; go b; go a; take 1; go b; put 1; go a"],
    ids=["no plan", "only moves", "no moves", "one chain"],
)
def test_reordered_returns_none_for_a_single_order(acts):
    assert candidate(plan_of(acts)) is None


def test_reordered_requires_one_action_per_step():
    plan = plan_of(TO_AND_FRO)
    assert candidate(plan._replace(actions=plan.actions | {parse_atom("_action_lib(sing,song,5)")}), 1) is None
    past = plan._replace(actions=plan.actions | {parse_atom("_action_lib(sing,song,1)")})
    assert candidate(past, 1) is not None


def test_reordered_ends_its_search_at_a_stop():
    looks = iter([False, False, True])
    candidate(plan_of(TO_AND_FRO), 1, lambda: next(looks))
    assert next(looks, None) is None


class World:
    """A corridor with packages; impossible actions are errors."""

    def __init__(self, packages, carried=()):
        self.packages, self.carried, self.waiting = packages, set(carried), {*packages} - {*carried}
        self.place, self.most = 0, len(self.carried)

    def do(self, act):
        kind, number = act.split()[0], int(act.split()[1])
        if kind == "go":
            assert abs(number - self.place) == 1
            self.place = number
            return
        assert self.packages[number][kind == "put"] == self.place
        if kind == "take":
            self.waiting.remove(number)
            self.carried.add(number)
            self.most = max(self.most, len(self.carried))
        else:
            self.carried.remove(number)


def some_plan(packages, carried, draw):
    """Return a random plan as acts that take and put packages, and the world after it."""
    world, acts = World(packages, carried), []
    while world.waiting or world.carried:
        ready = [("put", one) for one in sorted(world.carried)]
        ready += [("take", one) for one in sorted(world.waiting) if len(world.carried) < CAPACITY]
        kind, number = draw.choice(ready)
        end = packages[number][kind == "put"]
        way = range(world.place, end, 1 if end > world.place else -1)
        new = [f"go {one + (1 if end > one else -1)}" for one in way] + [f"{kind} {number}"]
        for act in new:
            world.do(act)
        acts += new
    return acts, world


@pytest.mark.slow
@given(
    st.lists(st.tuples(st.integers(0, 5), st.integers(0, 5)), min_size=2, max_size=6), st.integers(0, 2), st.randoms()
)
def test_reordered_plans_are_shorter_and_obey_the_rules(ends, carried, draw):
    packages = dict(enumerate(ends))
    acts, old = some_plan(packages, range(carried), draw)
    step = draw.randrange(len(acts))
    found = candidate(plan_of("; ".join(acts)), step)
    if found is None:
        return
    new = World(packages, range(carried))
    for act in acts[:step] + acts_of(found):
        new.do(act)
    assert not new.waiting
    assert not new.carried
    assert found.horizon == step + len(found.actions) < len(acts)
    assert new.most <= old.most
