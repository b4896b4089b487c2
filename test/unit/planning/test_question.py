"""One question to a grounding: assumptions, conflict limit, stop, and ``#heuristic``."""

from itertools import count

import pytest
from stream_play import SOLVERS, play, solver_of

from rosoclingo.oclingo import ReactiveProgram, parse_atom
from rosoclingo.planning.grounding import Grounding
from rosoclingo.planning.question import Question
from rosoclingo.planning.snapshot import Snapshot

#: Eleven pigeons and ten holes.
PIGEONS = """
#program cumulative(t).
1 { in(P,H,t) : H = 1..10 } 1 :- P = 1..11.
:- in(P,H,t), in(Q,H,t), P < Q, tight(t).
{ tight(t) }.
#program volatile(t).
"""
TIGHT = [(parse_atom("tight(1)"), True)]


def grounding_of(text, steps=1, **snapshot):
    return Grounding(ReactiveProgram.from_text(text), Snapshot(**snapshot), steps)


def ask(grounding, stopped=lambda: False, **limits):
    return grounding.ask(Question(1, 1, **limits), stopped)


def test_question_ends_at_its_conflict_limit():
    grounding = grounding_of(PIGEONS)
    assert ask(grounding, given=TIGHT, conflicts=5).satisfiable is None
    assert ask(grounding, conflicts=5).satisfiable is True, "five conflicts suffice"


def test_question_limit_does_not_affect_the_next():
    grounding = grounding_of("#program cumulative(t). { a(t) }. #program volatile(t). :- a(t).")
    given = [(parse_atom("a(1)"), True)]
    assert ask(grounding, given=given, conflicts=0).satisfiable is not True
    assert ask(grounding, given=given).satisfiable is False
    assert not grounding.is_conflicting, "assumptions are not permanent"


def test_question_respects_a_stop_during_the_search():
    looks = count()
    assert ask(grounding_of(PIGEONS), lambda: next(looks) >= 3, given=TIGHT).satisfiable is None


@pytest.mark.parametrize(
    ("given", "answers"), [({}, 4), ({"a(1)": True, "b(1)": False}, 1), ({"a(7)": True}, 0), ({"a(7)": False}, 4)]
)
def test_question_finds_answers_with_its_assumptions(given, answers):
    """Unknown atoms are false in each answer."""
    grounding = grounding_of("#program cumulative(t). { a(t); b(t) }. #program volatile(t).")
    found = ask(grounding, models=0, given=[(parse_atom(atom), value) for atom, value in given.items()])
    assert len(found.answers) == answers
    for answer in found.answers:
        assert all((parse_atom(atom) in answer) == value for atom, value in given.items())


def test_grounding_lists_open_actions_by_cycle():
    closed = {2: frozenset([parse_atom("_action_lib(go,a,2)")])}
    grounding = grounding_of(
        "#program cumulative(t). { _action_lib(go,(a;b),t) }. #program volatile(t).", 4, closed=closed
    )
    listed = sorted(map(str, grounding.actions(1, 3)))
    assert listed == [f"_action_lib(go,{x},{cycle})" for x in "ab" for cycle in (1, 3)]


@pytest.mark.parametrize(
    ("advice", "chosen"),
    [
        ("#heuristic a(X,t) : X = 6..8. [1,true]", "678"),
        ("#heuristic a(X,t) : X = (2;4;6). [X,true]", "246"),
        ("#heuristic a(X,t) : X = 1..8. [X,level] #heuristic a(X,t) : X = 1..8. [1,sign]", "678"),
        ("#heuristic a(X,t) : X = 1..5. [9-X,false]", "678"),
    ],
)
@SOLVERS
def test_solvers_obey_heuristics_of_the_program(advice, chosen, kind):
    solver = solver_of(f"#program cumulative(t). {{ a(X,t) : X = 1..8 }} = 3. #program volatile(t). {advice}", kind)
    assert solver.program.advises
    (answer,) = play(solver, "#step 2.").answers
    assert {str(one.arguments[0]) for one in answer if one.arguments[1].number == 2} == set(chosen)


def test_program_knows_its_heuristics_and_their_undefined_atoms():
    plain, advising = (
        ReactiveProgram.from_text(f"#program cumulative(t). {{ a(t) }}. {advice} #program volatile(t).")
        for advice in ("", "#heuristic b(t) : c(t). [1,true]")
    )
    assert (plain.advises, advising.advises) == (False, True)
    assert not any("heuristic" in one for one in plain.arguments())
    assert not advising.defines("b", 1)
    assert all(f"defines {name}/1" in " ".join(advising.warnings) for name in "bc")
