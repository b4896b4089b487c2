"""What is read in a plan: moves, tasks, chains, places."""

import clingo
import pytest
from plain_deeds import deeds_of

from rosoclingo.planning.reordering.deeds import Deeds


def read(plan, past="", back=True, known=None):
    return Deeds(deeds_of(past), deeds_of(plan), back, known)


def place(name):
    return None if name is None else deeds_of(f"go {name}")[0]


def test_a_kind_that_does_something_twice_moves():
    deeds = read("go a; take 1; go b; put 1; go a; water fern")
    assert deeds.chains == [(1, 2), (3,)]
    assert [deeds.task(number) for number in deeds.order] == deeds_of("take 1; put 1; water fern")
    assert deeds.places == [None, place("a"), place("b"), place("a")]
    assert deeds.begun == [False, False]
    assert deeds.most == 1
    assert deeds.end is None
    assert deeds.ways.steps(place("b"), place("a")) == 1


def test_where_the_last_move_has_led_to_it_begins():
    assert read("take 1; go a; go b; go a", "go c; look x; go b; take 2").places == [place("b"), place("b")]
    assert read("take 1; go a; go b; go a", "look x").places == [None, None]


def test_a_plan_may_end_with_a_move():
    assert read("go a; take 1; go b; go a").end == place("a")
    assert read("").end is None


def test_what_moves_is_known_from_a_longer_rest():
    known = read("go a; take 1; go b; put 1; go a; take 2")
    assert read("go b; put 1; go a; take 2").chains == [(1,), (2,), (3,), (4,)]
    rest = read("go b; put 1; go a; take 2", "go a; take 1", known=known)
    assert rest.chains == [(1,), (2,)]
    assert rest.places == [place("a"), place("b"), place("a")]


@pytest.mark.parametrize(
    ("plan", "chains"),
    [
        ("go a; grasp cup; go b; put (cup,b); go a; wipe table", [(1, 2), (3,)]),
        ("go a; grasp cup; go b; put (cup,b); go a; grasp pot; go b; put on(pot,b)", [(1, 2), (3, 4)]),
        ("go a; fill cup; take pot; go b; pour (cup,pot); go a; wipe table", [(1, 2, 3), (4,)]),
        ("go a; wait a; go b; wait b; go a; look (a,b)", [(1,), (2,), (3,)]),
        ("go a; go a", []),
    ],
    ids=["a place has no part in it", "two things", "two join", "places alone", "no tasks"],
)
def test_tasks_about_the_same_thing_keep_their_order(plan, chains):
    assert read(plan).chains == chains


def test_parameters_may_be_as_deep_as_clingo_has_them():
    term = clingo.Number(1)
    for _ in range(5000):
        term = clingo.Function("f", [term, term])
    deep, moves = (clingo.Function("take"), term), deeds_of("go a; go b; go a; put 1")
    assert Deeds([], [*moves, deep], back=True).chains == [(1, 2)]


def test_a_chain_that_ends_as_a_longer_one_was_begun_before():
    deeds = read("go a; put 7; take 1; go b; put 1; go a; water fern; wash 8; put 8")
    assert [[str(deeds.task(one)[0]) for one in chain] for chain in deeds.chains] == [
        ["put"],
        ["take", "put"],
        ["water"],
        ["wash", "put"],
    ]
    assert deeds.begun == [True, False, False, False]


def test_as_many_chains_may_be_under_way_as_were_at_once():
    plan = "go a; put 7; take 1; take 2; go b; put 2; put 1; go a; take 3; look x; put 3"
    deeds = read(plan)
    assert deeds.most == 2
    assert deeds.under_way([2, 3, 1, 4, 5, 6, 7, 8]) == 3
    rest = read("go b; put 1; go a; take 3; put 3", known=deeds)
    assert (rest.under_way(rest.order), rest.most) == (1, 2)


def test_the_order_of_a_longer_rest_is_taken_where_it_fits():
    deeds = read("go a; take 1; go b; put 1; go a; take 2; put 2")
    assert deeds.left_of(deeds_of("look x; take 2; put 2; take 1; put 1")) == [3, 4, 1, 2]
    assert deeds.left_of(deeds_of("take 2; take 1; put 1; put 2")) is None, "the robot can't hold both"
    assert deeds.left_of(deeds_of("take 2; put 2; take 1")) is None, "one is missing"


def test_distances_are_of_ways_and_to_the_end():
    tasks = read("take 0; go a; take 1; go b; go c; put 1; go a; go d").tasks()
    far = tasks.distances[2][1]
    assert far > 1000
    assert tasks.distances == [[0, 0, 1, 2, 2], [0, 0, 1, 2, 2], [far, far, 0, 1, 1], [far, far, 1, 0, 2]]
    assert (tasks.chains, tasks.begun, tasks.most) == ([(1,), (2, 3)], [False, False], 1)
    assert [row[-1] for row in read("go a; take 1; go b; put 1; go a; take 2").tasks().distances] == [0] * 4
