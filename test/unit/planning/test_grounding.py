"""One grounding: its blocks of steps and its memory, horizons of answers, and limits of questions."""

import gc
import weakref
from itertools import count

import pytest
from stream_play import SOLVERS, play, solver_of

from rosoclingo.oclingo import ReactiveProgram, parse_atom
from rosoclingo.oclingo.errors import StoppedError
from rosoclingo.planning.grounding import Grounding, pieces
from rosoclingo.planning.question import Question, never
from rosoclingo.planning.snapshot import Snapshot


def grounding_of(rules, steps=1, **snapshot):
    return Grounding(ReactiveProgram.from_text(f"#program cumulative(t). {rules}"), Snapshot(**snapshot), steps)


def ask(grounding, first=1, last=1, stopped=lambda: False, **limits):
    return grounding.ask(Question(first, last, **limits), stopped)


# ---- Blocks of steps, and memory -------------------------------------------------------------------------------------

PROGRAM = ReactiveProgram.from_text("#cumulative t. #external e(t). { a(t) }. #volatile t. s(t) :- e(t).")


@pytest.mark.parametrize(
    ("keep_from", "end", "ends"),
    [
        (0, 10, [4, 8, 10]),
        (2, 10, [1, 5, 9, 10]),
        (5, 10, [4, 8, 10]),
        (6, 10, [4, 5, 9, 10]),
        (6, 5, [4, 5]),
        (6, 0, []),
    ],
)
def test_pieces_end_where_compaction_can_start(keep_from, end, ends):
    assert list(pieces(1, end, lambda: 4, never, keep_from)) == ends


def test_stopped_grounding_ends_between_two_pieces():
    looks = []
    with pytest.raises(StoppedError):
        Grounding(PROGRAM, Snapshot(), 1000, stopped=lambda: looks.append(1) or len(looks) > 3)
    assert len(looks) == 4


@pytest.mark.parametrize("predicts", [False, True])
def test_grounding_without_references_is_freed_at_once(predicts):
    grounding = Grounding(PROGRAM, Snapshot(), 3, predicts=predicts)
    assert ask(grounding, 1, 3).satisfiable
    grounding.forget(1, 3)
    assert any(grounding.definitions.false)
    reference = weakref.ref(grounding)
    gc.disable()
    try:
        del grounding
        assert reference() is None
    finally:
        gc.enable()


# ---- Horizons --------------------------------------------------------------------------------------------------------


def ending(rules, last, settled=1):
    """Return a grounding whose answers show their horizon and their actions."""
    text = f"{rules} #program volatile(t). end(t). #show end/1. #show _action_lib/3."
    return grounding_of(text, last, horizon=last, min_horizon=settled)


def answers(grounding, first, last):
    found = ask(grounding, first, last, models=0)
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
    found = answers(ending("{ a(t) }. :- a(t).", 5, settled), first, last)
    assert found == [end and f"end({end})" for end in ends]


@pytest.mark.parametrize(
    ("rule", "cycle"),
    [
        ("{ _action_lib(go,x,2*t+(0..1)) }.", 2),
        ("{ _action_lib(go,x,(2147483647;soon)) } :- t = 1.", "soon"),
        ("#program base. { _action_lib(go,x,2); _action_lib(go,x,7) }.", 2),
        ("#volatile k : 3. { _action_lib(go,x,2*k+(0..1)) }.", 2),
    ],
)
def test_only_actions_up_to_the_horizon_or_without_cycle_are_answers(rule, cycle):
    """Each action of a rule has its own cycle."""
    assert answers(ending(rule, 3), 2, 2) == [f"_action_lib(go,x,{cycle}) end(2)", "end(2)"]


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


def test_question_limit_does_not_affect_the_next():
    grounding = grounding_of("{ a(t) }. #program volatile(t). :- a(t).")
    given = [(parse_atom("a(1)"), True)]
    assert ask(grounding, given=given, conflicts=0).satisfiable is not True
    assert ask(grounding, given=given).satisfiable is False
    assert not grounding.is_conflicting, "assumptions are not permanent"


def test_question_respects_a_stop_during_the_search():
    looks = count()
    assert ask(grounding_of(PIGEONS), stopped=lambda: next(looks) >= 3, given=TIGHT).satisfiable is None


@pytest.mark.parametrize(
    ("given", "answers"), [({}, 4), ({"a(1)": True, "b(1)": False}, 1), ({"a(7)": True}, 0), ({"a(7)": False}, 4)]
)
def test_question_finds_answers_with_its_assumptions(given, answers):
    """Unknown atoms are false in each answer."""
    grounding = grounding_of("{ a(t); b(t) }.")
    found = ask(grounding, models=0, given=[(parse_atom(atom), value) for atom, value in given.items()])
    assert len(found.answers) == answers
    for answer in found.answers:
        assert all((parse_atom(atom) in answer) == value for atom, value in given.items())


def test_grounding_lists_open_actions_by_cycle():
    closed = {2: frozenset([parse_atom("_action_lib(go,a,2)")])}
    grounding = grounding_of("{ _action_lib(go,(a;b),t) }.", 4, closed=closed)
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
