"""Ways over the moves of a plan."""

import pytest

from rosoclingo.oclingo import parse_term
from rosoclingo.planning.reordering.known_ways import FAR, Ways


def to(name):
    return parse_term("move_base"), parse_term(name)


def walked(back, *names, here=None):
    ways = Ways(here and to(here), back)
    for name in names:
        ways.go(to(name))
    return ways


def test_the_shortest_way_is_found_in_both_directions():
    ways = walked(True, "a", "b", "c", "d", "a", "e")
    assert ways.here == to("e")
    assert ways.way(to("e"), to("d")) == [to("a"), to("d")]
    assert ways.way(to("b"), to("d")) in ([to("a"), to("d")], [to("c"), to("d")])
    assert ways.steps(to("c"), to("e")) == 3
    assert ways.way(to("a"), to("a")) == []


def test_without_the_way_back_only_what_was_gone_is_known():
    ways = walked(False, "b", "c", "a", "d", here="a")
    assert ways.way(to("b"), to("d")) == [to("c"), to("a"), to("d")]
    assert ways.steps(to("a"), to("b")) == 1
    assert ways.steps(to("d"), to("a")) == FAR
    with pytest.raises(KeyError):
        ways.way(to("d"), to("a"))


@pytest.mark.parametrize("back", [True, False])
def test_to_where_it_began_leads_no_move_that_is_known(back):
    ways = walked(back, "a", "b")
    assert ways.way(None, to("b")) == [to("a"), to("b")]
    assert ways.steps(to("a"), None) == FAR


def test_ways_are_found_anew_after_a_further_move():
    ways = walked(True, "a", "b", "c")
    assert ways.steps(to("a"), to("c")) == 2
    ways.go(to("a"))
    assert ways.steps(to("a"), to("c")) == 1
