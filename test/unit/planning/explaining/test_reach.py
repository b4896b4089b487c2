"""Unreachable atoms, checked by brute force in small worlds, whose states are all reached in few steps."""

import clingo
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shipped import shipped
from stream_logs import stream_of

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.planning.explaining.explainer import explain

STEPS = 2
THINGS = "abcd"
ALL = 2 ** len(THINGS) + 2  # enough steps to reach every reachable state


class World:
    """Boolean things, and actions that require some of them, make one true and another one false."""

    def __init__(self, first, actions, forbidden, wanted):
        self.wanted = wanted
        lines = [f"has({one},0)." for one in first]
        for number, (needed, gives, takes) in enumerate(actions):
            lines += [f"act({number}).", f"gives({number},{gives})."]
            lines += [f"needs({number},{one})." for one in needed]
            lines += [f"takes({number},{takes})."] if takes else []
        self.lines = [
            *lines,
            "#defined needs/2. #defined takes/2.",
            "#program cumulative(t).",
            "{ _action_lib(do,N,t) : able(N,t) } 1.",
            "able(N,t) :- act(N), not lacks(N,t).",
            "lacks(N,t) :- needs(N,X), not has(X,t-1).",
            *(
                f"has({one},t) :- _action_lib(do,{n},t)" + "".join(f", has({x},t-1)" for x in needed) + "."
                for n, (needed, one, _) in enumerate(actions)
            ),
            "has(X,t) :- has(X,t-1), not taken(X,t).",
            "taken(X,t) :- _action_lib(do,N,t), takes(N,X).",
            *(f":- has({one},t), has({other},t)." for one, other in forbidden),
        ]

    def holds(self, atom, heeding=True):
        """Return whether an atom holds at the end of some plan; ``heeding``: whether constraints count."""
        lines = [line for line in self.lines if heeding or not line.startswith(":-")]
        control = clingo.Control(["-Wnone"])
        control.add("base", [], "\n".join(lines))
        control.ground([("base", [])])
        for step in range(1, ALL):
            control.ground([("cumulative", [clingo.Number(step)])])
            goal = clingo.parse_term(atom.replace(",t)", f",{step})"))
            if control.solve(assumptions=[(goal, True)]).satisfiable:
                return True
        return False


def explained(program, facts="", steps=STEPS):
    return explain(program, stream_of(f"#step 1. {facts}", steps))


def check(world, steps=STEPS):
    """Check that atoms reported as unreachable are unreachable."""
    text = "\n".join([*world.lines, "#program volatile(t).", f":- not has({world.wanted},t).", ""])
    found = explained(ReactiveProgram.from_text(text, "world.lp"), steps=steps)
    if found is None:
        assert world.holds(f"has({world.wanted},t)")
        return None
    if found.never:
        assert not world.holds(f"has({world.wanted},t)")
    for one in found.lacking:
        assert not world.holds(one.atom, heeding=False)
        for miss in one.misses:
            assert "_" in miss.lacks.replace("_action_lib", "") or not world.holds(miss.lacks, heeding=False)
    return found


SOME = st.lists(st.sampled_from(THINGS), max_size=2, unique=True)
ACTION = st.tuples(SOME, st.sampled_from(THINGS), st.sampled_from([None, *THINGS]))
PAIR = st.tuples(st.sampled_from(THINGS), st.sampled_from(THINGS)).filter(lambda pair: pair[0] < pair[1])
WORLDS = st.builds(
    World, SOME, st.lists(ACTION, min_size=1, max_size=3), st.lists(PAIR, max_size=1), st.sampled_from(THINGS)
)


@pytest.mark.slow
@settings(max_examples=max(5, settings.default.max_examples // 3))
@given(WORLDS)
def test_reach_agrees_with_brute_force_in_small_worlds(world):
    check(world)


@pytest.mark.mostly_slow
@pytest.mark.parametrize(
    ("goal", "atom", "last"),
    [
        ("goal(office1,office9,1)", "delivered(1,t)", "next(_,office9)"),
        ("goal(office9,office1,1)", "picked(1,t)", "next(_,office9)"),  # mail waits until its pickup
    ],
)
def test_reach_knows_that_the_paper_lacks_an_office(goal, atom, last):
    found = explained(shipped("paper.lp"), f"_request({goal},2).")
    assert found.never
    assert [(one.atom, one.misses[-1].lacks) for one in found.lacking] == [(atom, last)]


COUNTING = """
at(0,0).
#program cumulative(t).
{ go(t) }.
at(N+1,t) :- at(N,t-1), go(t).
at(N,t) :- at(N,t-1), not go(t).
late(t) :- t > 20.
late(t) :- late(t-1).
#program volatile(t).
:- not late(t).
"""


@pytest.mark.slow
def test_reach_draws_no_conclusion_about_clocks():
    found = explained(ReactiveProgram.from_text(COUNTING, "count.lp"))
    assert (found.never, found.lacking) == (False, ())
