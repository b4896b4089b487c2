"""Horizons: answers contain no steps or actions beyond them, independent of the form of the cycle term."""

import pytest

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.planning.grounding import Grounding
from rosoclingo.planning.question import Question
from rosoclingo.planning.snapshot import Snapshot


def grounding_of(text, last, settled=1):
    text = f"#program cumulative(t). {text} #program volatile(t). end(t). #show end/1. #show _action_lib/3."
    return Grounding(ReactiveProgram.from_text(text), Snapshot(horizon=last, min_horizon=settled), last)


def answers(grounding, first, last):
    found = grounding.ask(Question(first, last, models=0), lambda: False)
    assert not found.answers or f"end({found.horizon})" in map(str, found.answers[-1]) or first == 0
    return sorted(" ".join(sorted(map(str, answer))) for answer in found.answers)


@pytest.mark.parametrize(
    ("settled", "first", "last", "ends"),
    [
        (1, 1, 1, [1]),
        (1, 4, 4, [4]),
        (1, 1, 4, [1, 2, 3, 4]),
        (1, 2, 3, [2, 3]),
        (3, 3, 5, [3, 4, 5]),
        (3, 1, 2, []),
        (0, 0, 2, ["", 1, 2]),
    ],
)
def test_horizons_lie_in_the_range_of_the_question(settled, first, last, ends):
    """They begin at the ``settled`` step, and no volatile rule holds before the first step."""
    found = answers(grounding_of("{ a(t) }. :- a(t).", 5, settled), first, last)
    assert found == [end and f"end({end})" for end in ends]


@pytest.mark.parametrize("cycle", [f"{name}+{offset}" for name in "tT" for offset in range(-3, 4)] + ["2*T-T+1"])
def test_answers_contain_no_actions_beyond_the_horizon(cycle):
    offset = 1 if "*" in cycle else int(cycle[2:])
    grounding = grounding_of(f"now(t). {{ _action_lib(go,x,{cycle}) }} :- now(T), T = t.", 1)
    for last in (1, 2, 6):
        if last > 1:
            grounding.grow_to(last)
        for horizon in range(1, last + 1):
            possible = range(max(1, 1 + offset), min(last + offset, horizon) + 1)
            found = answers(grounding, horizon, horizon)
            assert len(found) == 2 ** len(possible)
            every = {one for answer in found for one in answer.split()} - {f"end({horizon})"}
            assert every == {f"_action_lib(go,x,{step})" for step in possible}


@pytest.mark.parametrize(
    ("rule", "cycle"),
    [("{ _action_lib(go,x,2*t+(0..1)) }.", 2), ("{ _action_lib(go,x,(2147483647;soon)) } :- t = 1.", "soon")],
)
def test_only_actions_up_to_the_horizon_or_without_cycle_are_answers(rule, cycle):
    """Each action of a rule has its own cycle."""
    assert answers(grounding_of(rule, 3), 2, 2) == [f"_action_lib(go,x,{cycle}) end(2)", "end(2)"]
