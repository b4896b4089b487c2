"""Orders of tasks: what is found is one, and the shortest of few tasks is found."""

from itertools import permutations
from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rosoclingo.planning.reordering import ruin_and_recreate
from rosoclingo.planning.reordering.ruin_and_recreate import RuinAndRecreate, Tasks


@st.composite
def some_tasks(draw, most=6):
    """Tasks between places on a plane, and an order in which they can be done."""
    lengths = draw(st.lists(st.integers(1, 3), min_size=2, max_size=4).filter(lambda some: sum(some) <= most))
    count = sum(lengths)
    points = draw(st.lists(st.tuples(*[st.integers(0, 9)] * 2), min_size=count + 2, max_size=count + 2))
    distances = [[abs(a - c) + abs(b - d) for c, d in points] for a, b in points[:-1]]
    if draw(st.booleans()):
        distances = [[*row[:-1], 0] for row in distances]
    numbers = draw(st.permutations(range(1, count + 1)))
    chains = [tuple(numbers[sum(lengths[:one]) : sum(lengths[: one + 1])]) for one in range(len(lengths))]
    begun = [draw(st.booleans()) for _ in chains]
    least = max(1, sum(begun))
    tasks = Tasks(distances, chains, begun, draw(st.integers(least, least + 2)))
    first = sorted(range(len(chains)), key=lambda chain: not begun[chain])
    return tasks, [task for chain in first for task in chains[chain]]


def fits(tasks, order):
    """Whether chains keep their order and no more are under way than may be; written without a look at the search."""
    for before in range(len(order) + 1):
        under_way = 0
        for chain, begun in zip(tasks.chains, tasks.begun):
            places = [order.index(task) for task in chain]
            if places != sorted(places):
                return False
            under_way += (begun or places[0] < before) and places[-1] >= before
        if under_way > tasks.most:
            return False
    return True


def length(tasks, order):
    ways = zip([0, *order], order)
    return sum(tasks.distances[a][b] for a, b in ways) + tasks.distances[order[-1]][-1]


@given(some_tasks(), st.randoms(use_true_random=False))
def test_what_is_found_is_an_order_and_shorter_than_all_before(case, random):
    tasks, order = case
    search = RuinAndRecreate(tasks, order, Random(random.random()))
    best = order
    for found in search.search(30):
        if found is not None:
            assert sorted(found) == sorted(order)
            assert fits(tasks, found)
            assert tasks.steps(found) == length(tasks, found) < length(tasks, best)
            best = found
        assert search.best == best


@given(some_tasks(), st.randoms(use_true_random=False))
def test_of_few_tasks_the_shortest_order_is_found(case, random):
    tasks, order = case
    least = min(length(tasks, list(one)) for one in permutations(order) if fits(tasks, list(one)))
    search = RuinAndRecreate(tasks, order, Random(random.random()))
    assert len([*search.search(400)]) == 400
    assert length(tasks, search.best) == least


@pytest.mark.parametrize("blink", [0.0, 1.0])
@given(case=some_tasks())
def test_a_chain_is_put_where_it_costs_least(blink, case):
    tasks, order = case
    chain = tasks.chains[-1]
    rest = [task for task in order if task not in chain]
    search = RuinAndRecreate(tasks, order, Random(1))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(ruin_and_recreate, "BLINK", blink)
        found = search._recreated(rest, [len(tasks.chains) - 1])
    if blink:
        assert found is None, "all places are passed over"
        return
    others = [list(one) for one in permutations(order) if [task for task in one if task not in chain] == rest]
    assert found in others
    assert length(tasks, found) == min(length(tasks, one) for one in others if fits(tasks, one))


def test_no_order_is_yielded_where_no_chain_finds_room(monkeypatch):
    monkeypatch.setattr(ruin_and_recreate, "BLINK", 1.0)
    tasks = Tasks([[0, 5, 1, 0], [0, 0, 1, 0], [0, 1, 0, 0]], [(1,), (2,)], [False, False], 1)
    search = RuinAndRecreate(tasks, [1, 2], Random(1))
    assert list(search.search(20)) == [None] * 20
    assert search.best == [1, 2]


@pytest.mark.parametrize(("worse", "found"), [(1, True), (100, False)])
def test_the_search_goes_on_from_orders_that_are_little_longer(monkeypatch, worse, found):
    """One chain at a time is put elsewhere; the shortest order is two such changes away, over a worse one."""
    monkeypatch.setattr(ruin_and_recreate, "TAKEN_OUT", 1)
    steps = {(1, 2, 3): 3, (3, 2, 1): 0}
    tasks = Tasks([[0] * 5] * 4, [(1,), (2,), (3,)], [False] * 3, 1)
    monkeypatch.setattr(Tasks, "steps", lambda _, order: steps.get(tuple(order), 3 + worse))
    search = RuinAndRecreate(tasks, [1, 2, 3], Random(2))
    assert ([3, 2, 1] in search.search(400)) == found
