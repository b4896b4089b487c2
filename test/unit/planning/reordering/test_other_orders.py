"""Plans in another order, walked through."""

from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st
from plain_deeds import deeds_of, text_of

from rosoclingo.planning.reordering.deeds import Deeds
from rosoclingo.planning.reordering.other_orders import Orders, Walk


def orders_of(plan, past="", before=None, back=True):
    return Orders(deeds_of(past), deeds_of(plan), Random(1), back, before)


def best(orders, rounds=200):
    found = [deeds for deeds in orders.shorter(rounds) if deeds is not None]
    return text_of(found[-1]) if found else None


#: To and fro between a and c, with b in between.
TO_AND_FRO = "go b; go c; water fern; go b; go a; water rose; go b; go c; water lily; go b; go a; water ivy"


def test_errands_to_one_place_are_done_together():
    assert best(orders_of(TO_AND_FRO, "go a")) in (
        "water rose; water ivy; go b; go c; water fern; water lily",
        "water ivy; water rose; go b; go c; water fern; water lily",
        "water rose; water ivy; go b; go c; water lily; water fern",
        "water ivy; water rose; go b; go c; water lily; water fern",
    )


def test_each_plan_is_shorter_than_those_before():
    lengths = [len(deeds) for deeds in orders_of(TO_AND_FRO, "go a").shorter(200) if deeds is not None]
    assert lengths == sorted(set(lengths), reverse=True)
    assert lengths[0] < 12


def test_none_is_yielded_where_there_is_no_shorter_one():
    orders = orders_of(TO_AND_FRO, "go a")
    assert len([*orders.shorter(200)]) == 200
    assert best(orders_of("go b; water fern; go c; water rose; go b; go a", "go a")) is None
    assert [*orders_of("water fern; water rose; go a; go b; go a").shorter(3)] == [None] * 3


@pytest.mark.parametrize("plan", ["", "go a; go b; go a", "go a; take 1; go b; put 1; go a"])
def test_of_a_single_chain_there_are_no_other_orders(plan):
    assert [*orders_of(plan).shorter(3)] == []


def test_it_goes_on_from_where_it_was_with_the_rest_of_the_plan():
    orders = orders_of(TO_AND_FRO, "go a")
    best(orders)
    later = orders_of(TO_AND_FRO.split("; ", 1)[1], "go a; go b", before=orders)
    assert later._search.best == orders._search.best
    (found,) = later.shorter(50)
    assert len(found) == 7, "what is known at once"
    assert [*orders_of(text_of(found), "go a; go b", before=later).shorter(3)] == [None] * 3
    other = orders_of("go b; go a; go b; water oak; water elm", "go a", before=orders)
    assert other._search.best == [1, 2]


def test_after_a_plan_with_nothing_to_order_it_begins_anew():
    assert best(orders_of(TO_AND_FRO, "go a", before=orders_of("go a"))) is not None


@pytest.mark.parametrize(
    ("plan", "past", "order", "done"),
    [
        ("go a; take 1; go b; take 2; go a; go b; put 1; put 2", "go b", [1, 2, 4, 3], None),
        (
            "go a; take 1; go b; go c; take 2; put 2; go b; put 1; go a",
            "go b",
            [1, 2, 3, 4],
            "go a; take 1; go b; put 1; go c; take 2; put 2; go b; go a",
        ),
        ("put 1; go a; go b; take 2; put 2; go a", "go c", [2, 1, 3], "put 1; go a; go b; take 2; put 2; go a"),
        (
            "go a; take 1; go b; mix 1; stir 1; go a; look x",
            "",
            [1, 4, 2, 3],
            "go a; take 1; look x; go b; mix 1; stir 1",
        ),
    ],
    ids=["nothing is passed", "on the way", "at once", "all that goes on there"],
)
def test_what_is_under_way_goes_on_where_a_way_leads_past(plan, past, order, done):
    walked = text_of(Walk(Deeds(deeds_of(past), deeds_of(plan), back=True)).through(order))
    assert walked == (done or "go a; take 1; go b; put 1; take 2; put 2")


@given(st.lists(st.tuples(st.integers(0, 5), st.integers(0, 5)).filter(lambda one: one[0] != one[1]), max_size=6))
def test_every_plan_does_each_task_once_where_it_was_done_and_moves_along_the_row(errands):
    """One errand after the other along a row of places; whatever is found obeys the same rules, and ends."""
    here, plan = 0, []
    for number, (start, end) in enumerate(errands):
        for what, place in (("take", start), ("put", end)):
            way = range(here + 1, place + 1) if place >= here else range(here - 1, place - 1, -1)
            plan += [f"go {10 + one}" for one in way] + [f"{what} {number}"]
            here = place
    where = {}
    for text in [None, "; ".join(plan)]:
        for deeds in [deeds_of(text)] if text else orders_of("; ".join(plan), "go 10").shorter(60):
            at, done = 0, []
            for kind, what in deeds or ():
                if str(kind) == "go":
                    assert abs(what.number - 10 - at) == 1
                    at = what.number - 10
                else:
                    done.append((str(kind), what.number, at))
            if deeds:
                assert sorted(done) == sorted(
                    [("take", number, start) for number, (start, _) in enumerate(errands)]
                    + [("put", number, end) for number, (_, end) in enumerate(errands)]
                )
                assert all(done.index(("take", n, s)) < done.index(("put", n, e)) for n, (s, e) in enumerate(errands))
                where[len(deeds)] = done
