"""One grounding: horizons of answers, limits of questions, and heuristics of the program."""

from itertools import count

import pytest
from stream_play import SOLVERS, play, solver_of

from rosoclingo.oclingo import ReactiveProgram, parse_atom
from rosoclingo.oclingo.errors import StoppedError
from rosoclingo.planning.grounding import Grounding
from rosoclingo.planning.question import Question
from rosoclingo.planning.snapshot import Snapshot


def grounding_of(rules, steps=1, **snapshot):
    return Grounding(ReactiveProgram.from_text(f"#program cumulative(t). {rules}"), Snapshot(**snapshot), steps)


def ask(grounding, first=1, last=1, stopped=lambda: False, **limits):
    return grounding.ask(Question(first, last, **limits), stopped)


PROGRAM = ReactiveProgram.from_text("#cumulative t. #external e(t). { a(t) }. #volatile t. s(t) :- e(t).")


def test_stopped_grounding_ends_between_two_pieces():
    looks = []
    with pytest.raises(StoppedError):
        Grounding(PROGRAM, Snapshot(), 1000, stopped=lambda: looks.append(1) or len(looks) > 3)
    assert len(looks) == 4


# ---- Questions -------------------------------------------------------------------------------------------------------

#: Eleven pigeons and ten holes.
PIGEONS = """
1 { in(P,H,t) : H = 1..10 } 1 :- P = 1..11.
:- in(P,H,t), in(Q,H,t), P < Q, tight(t).
{ tight(t) }.
#program volatile(t).
"""
TIGHT = [(parse_atom("tight(1)"), True)]


def test_question_ends_at_its_conflict_limit():
    grounding = grounding_of(PIGEONS)
    assert ask(grounding, given=TIGHT, conflicts=5).satisfiable is None
    assert ask(grounding, conflicts=5).satisfiable is True, "five conflicts suffice"


def test_question_respects_a_stop_during_the_search():
    looks = count()
    assert ask(grounding_of(PIGEONS), stopped=lambda: next(looks) >= 3, given=TIGHT).satisfiable is None


@pytest.mark.parametrize(
    ("advice", "chosen"),
    [
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
