"""One question to a grounding: what is given, how many conflicts, when it is stopped; and what #heuristic says."""

from itertools import count

import pytest

from rosoclingo.oclingo import ReactiveProgram, ReactiveSolver, parse_atom, parse_update
from rosoclingo.planning.grounding import Grounding
from rosoclingo.planning.question import Question
from rosoclingo.planning.snapshot import Snapshot
from rosoclingo.planning.solver import PlanSolver

#: Eleven pigeons and ten holes.
PIGEONS = """
#program cumulative(t).
1 { in(P,H,t) : H = 1..10 } 1 :- P = 1..11.
:- in(P,H,t), in(Q,H,t), P < Q, tight(t).
{ tight(t) }.
#program volatile(t).
"""


def grounding_of(text, steps=1, **snapshot):
    return Grounding(ReactiveProgram.from_text(text), Snapshot(**snapshot), steps)


def ask(grounding, stopped=lambda: False, **limits):
    return grounding.ask(Question(1, 1, **limits), stopped)


TIGHT = [(parse_atom("tight(1)"), True)]


def test_conflicts_that_are_used_up_tell_nothing():
    grounding = grounding_of(PIGEONS)
    assert ask(grounding, given=TIGHT, conflicts=5).satisfiable is None
    assert ask(grounding, conflicts=5).satisfiable is True, "that is easy"


def test_a_limit_holds_for_one_search():
    grounding = grounding_of("#program cumulative(t). { a(t) }. #program volatile(t). :- a(t).")
    given = [(parse_atom("a(1)"), True)]
    assert ask(grounding, given=given, conflicts=0).satisfiable is not True
    assert ask(grounding, given=given).satisfiable is False
    assert not grounding.is_conflicting, "nothing is said for good of what was given"


def test_a_search_heeds_a_stop():
    looks = count()
    assert ask(grounding_of(PIGEONS), lambda: next(looks) >= 3, given=TIGHT).satisfiable is None


@pytest.mark.parametrize(("given", "answers"), [({}, 4), ({"a(1)": True}, 2), ({"a(1)": True, "b(1)": False}, 1)])
def test_what_is_given_is_in_all_answers(given, answers):
    grounding = grounding_of("#program cumulative(t). { a(t); b(t) }. #program volatile(t).")
    found = ask(grounding, models=0, given=[(parse_atom(atom), value) for atom, value in given.items()])
    assert len(found.answers) == answers
    for answer in found.answers:
        assert all((parse_atom(atom) in answer) == value for atom, value in given.items())


def test_an_action_that_nobody_knows_can_not_be_given():
    grounding = grounding_of("#program cumulative(t). { a(t) }. #program volatile(t).")
    assert ask(grounding, given=[(parse_atom("a(7)"), True)]).satisfiable is False
    assert ask(grounding, given=[(parse_atom("a(7)"), False)]).satisfiable is True


def test_open_actions_are_listed_by_their_cycles():
    closed = {2: frozenset([parse_atom("_action_lib(go,a,2)")])}
    text = "#program cumulative(t). { _action_lib(go,(a;b),t) }. #program volatile(t)."
    grounding = grounding_of(text, 4, closed=closed)
    listed = sorted(map(str, grounding.actions(1, 3)))
    assert listed == [f"_action_lib(go,{x},{cycle})" for x in "ab" for cycle in (1, 3)]


MODIFIERS = "#program cumulative(t). {{ a(X,t) : X = 1..8 }} = 3. #program volatile(t). {}"


@pytest.mark.parametrize(
    ("advice", "chosen"),
    [
        ("#heuristic a(X,t) : X = 6..8. [1,true]", "678"),
        ("#heuristic a(X,t) : X = (2;4;6). [X,true]", "246"),
        ("#heuristic a(X,t) : X = 1..8. [X,level] #heuristic a(X,t) : X = 1..8. [1,sign]", "678"),
        ("#heuristic a(X,t) : X = 1..5. [9-X,false]", "678"),
    ],
)
@pytest.mark.parametrize("solver", [ReactiveSolver, PlanSolver])
def test_heuristics_are_obeyed(advice, chosen, solver):
    program = ReactiveProgram.from_text(MODIFIERS.format(advice))
    assert program.advises
    result = solver(program).update(parse_update("#step 2. #endstep."))
    assert result.horizon == 2
    found = {str(one.arguments[0]) for one in result.answers[0] if one.name == "a" and one.arguments[1].number == 2}
    assert found == set(chosen)


def test_a_heuristic_defines_nothing_and_is_told_of_like_any_rule():
    text = "#program cumulative(t). { a(t) }. #heuristic b(t) : c(t). [1,true] #program volatile(t)."
    program = ReactiveProgram.from_text(text)
    assert not program.defines("b", 1)
    told = " ".join(program.warnings)
    assert "defines b/1" in told
    assert "defines c/1" in told


def test_a_program_without_heuristics_is_searched_as_ever():
    program = ReactiveProgram.from_text("#program cumulative(t). { a(t) }. #program volatile(t).")
    assert not program.advises
    assert not any("heuristic" in one for one in program.arguments())
