"""Horizons: answers contain no steps or actions beyond them, independent of the form of the cycle term."""

import pytest
from stream_play import WALK, atoms, planner_of, play

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.planning.grounding import Grounding
from rosoclingo.planning.question import Question
from rosoclingo.planning.snapshot import Snapshot

ENDS = "#program cumulative(t). { a(t) }. :- a(t). #program volatile(t). end(t). #show end/1."
ACTIONS = (
    "#program cumulative(t). now(t). {{ _action_lib(go,x,{cycle}) }} :- now(T), T = t{rest}. "
    "#program volatile(t). #show _action_lib/3."
)


def grounding_of(text, last, settled=1):
    return Grounding(ReactiveProgram.from_text(text), Snapshot(horizon=last, min_horizon=settled), last)


def ask(grounding, first, last, models=0):
    return grounding.ask(Question(first, last, models=models), lambda: False)


def cycles(answers):
    return {atom.arguments[2].number for answer in answers for atom in answer if atom.name == "_action_lib"}


@pytest.mark.parametrize(("first", "last"), [(1, 1), (4, 4), (1, 4), (2, 3)])
def test_horizons_lie_in_the_range_of_the_question(first, last):
    found = ask(grounding_of(ENDS, 4), first, last)
    assert sorted(" ".join(map(str, answer)) for answer in found.answers) == [
        f"end({step})" for step in range(first, last + 1)
    ]
    assert f"end({found.horizon})" in map(str, found.answers[-1])


def test_horizons_begin_at_the_settled_step():
    grounding = grounding_of(ENDS, 5, settled=3)
    assert len(ask(grounding, 3, 5).answers) == 3
    assert ask(grounding, 1, 2).satisfiable is False


def test_no_volatile_rule_holds_before_the_first_step():
    found = ask(grounding_of(ENDS, 3, settled=0), 0, 2).answers
    assert sorted("".join(map(str, answer)) for answer in found) == ["", "end(1)", "end(2)"]


@pytest.mark.parametrize("cycle", [f"{name}+{offset}" for name in "tT" for offset in range(-3, 4)] + ["2*T-T+1"])
def test_answers_contain_no_actions_beyond_the_horizon(cycle):
    offset = 1 if "*" in cycle else int(cycle[2:])
    grounding = grounding_of(ACTIONS.format(cycle=cycle, rest=""), 1)
    for last in (1, 2, 6):
        if last > 1:
            grounding.grow_to(last)
        for horizon in range(1, last + 1):
            found = ask(grounding, horizon, horizon)
            possible = range(max(1, 1 + offset), min(last + offset, horizon) + 1)
            assert cycles(found.answers) == set(possible)
            assert len(found.answers) == 2 ** len(possible)


def test_actions_of_one_rule_have_individual_cycles():
    text = "#program cumulative(t). { _action_lib(go,x,2*t+(0..1)) }. #program volatile(t)."
    assert cycles(ask(grounding_of(text, 2), 2, 2).answers) == {2}


def test_far_or_symbolic_cycle_is_not_a_step():
    text = "#program cumulative(t). { _action_lib(go,x,(2147483647;soon)) } :- t = 1. #program volatile(t)."
    found = ask(grounding_of(text, 3), 2, 3)
    assert [sorted(map(str, answer)) for answer in found.answers] == [[], ["_action_lib(go,x,soon)"]] * 2


def test_forget_directive_spares_the_horizon_externals():
    text = "#program cumulative(t). { _action_lib(go,x,t+3) }. #forget t : t-1. #program volatile(t)."
    solver = planner_of(text, models=0)
    for step, answers in ((1, 1), (3, 1), (4, 2), (6, 8)):
        assert len(play(solver, f"#step {step} : 0.").answers) == answers


@pytest.mark.parametrize(("rule", "shown"), [("{ _action_lib(go,x,t-1) }.", []), ("_action_lib(go,x,t-1).", [0])])
def test_only_facts_are_actions_before_cycle_one(rule, shown):
    solver = planner_of(f"#program cumulative(t). {rule} #program volatile(t).", models=0)
    assert [cycles([answer]) for answer in play(solver, "#step 1.").answers] == [set(shown)]


def test_answers_hide_the_literals_of_horizons():
    solver = planner_of(WALK, horizon_limit=30)
    play(solver, "#step 1. _request(4,1).")
    found = play(solver, "#step 2. _request(1,2). :- not _action_lib(move,1,1).")
    assert solver.horizon > found.horizon
    assert not [name for name in atoms(found) if name.startswith("__")]
