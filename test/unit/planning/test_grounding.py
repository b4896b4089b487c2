"""One grounding: which externals belong to which step, what is ground at once, and what it reports."""

import gc
import weakref

import clingo
import pytest
from stream_logs import copied

from rosoclingo.oclingo import DroppedError, ReactiveProgram, SolveOutcome, parse_update
from rosoclingo.oclingo.program.update_reader import Reader
from rosoclingo.planning.asking import Asking
from rosoclingo.planning.grounding import Grounding, pieces
from rosoclingo.planning.question import UNKNOWN, Question
from rosoclingo.planning.snapshot import Snapshot
from rosoclingo.planning.solver import PlanSolver

IGNORED = "Head {} has not been declared external. The entire rule will be ignored."
EXTERNALS = (
    "#external door. #external sees/1. d(1..2). #program cumulative(t). #external e(t). #external both(1) : t = 1. "
    "both(t+1). #external f(X) : d(X), t = 4. #program volatile(t). s(t) :- sees(t)."
)


def solver_of(text, **options):
    return PlanSolver(ReactiveProgram.from_text(text), **options)


def play(solver, text):
    return solver.update(parse_update(f"{text} #endstep."))


def atoms(result):
    assert result.outcome is SolveOutcome.SATISFIABLE
    return sorted(map(str, result.answers[-1]))


def grounding_of(text, horizon=1, update="", **options):
    program = ReactiveProgram.from_text(text)
    snapshot = Snapshot.initial(program).with_update(
        parse_update(f"#step 1. {update} #endstep."), Reader(program, False)
    )
    return Grounding(program, snapshot, horizon, **options)


def restored(solver):
    """The solver, with its history as one checkpoint, read from its text."""
    solver.restore(copied(solver.log.checkpoint(solver.snapshot)))
    return solver


# ---- Externals -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("horizons", [(1, 2, 3, 4, 5), (1, 3, 5), (3, 5)])
def test_to_which_steps_externals_belong(horizons):
    grounding = grounding_of(EXTERNALS, horizons[0], "#volatile. sees(1).")
    for last in horizons[1:]:
        grounding.grow_to(last)
    grounding.forget(5, 5)

    def declared(first, last, **options):
        return sorted(map(str, grounding.undefined_between(first, last, **options)))

    steps = [declared(step, step) for step in range(1, 6)]
    assert steps[:3] == [["both(1)", "door", "e(1)"], ["e(2)"], ["e(3)"]]
    assert "e(4)" in steps[3]
    assert steps[4] == []
    assert declared(1, 3) == ["both(1)", "door", "e(1)", "e(2)", "e(3)"]
    assert declared(1, 3, base=False) == ["both(1)", "e(1)", "e(2)", "e(3)"]


def test_a_history_that_is_restored_forgets_the_same():
    solver = solver_of("#cumulative t. #external e(t). c(t) :- e(t). #volatile t.")
    play(solver, "#step 5.")
    play(restored(solver), "#forget 3..3.")
    result = play(solver, "e(2). e(3). e(4).")
    assert result.warnings == (IGNORED.format("e(3)"),)
    assert atoms(result) == ["c(2)", "c(4)", "e(2)", "e(4)"]


def test_atoms_of_open_predicates_are_of_no_step_and_not_forgotten():
    solver = solver_of("#external sees/1. a(X) :- sees(X). #cumulative t. #volatile t.")
    play(solver, "#step 1. #volatile. sees(x).")
    play(solver, "#step 2. #forget 0..9.")
    assert atoms(play(solver, "sees(x).")) == ["a(x)", "sees(x)"]


@pytest.mark.parametrize("is_restored", [False, True])
def test_returns_of_all_cycles_before_the_last_closed_one_are_closed(is_restored):
    solver = solver_of("#cumulative t. #external _return(go,x,t). c(t) :- _return(go,x,t). #volatile t.")
    for step in (1, 2, 3, 4):
        play(solver, f"#step {step}. #closed {step}.")
    if is_restored:
        restored(solver)
    late = play(solver, "_return(go,x,2). _return(go,x,3). _return(go,x,4).")
    assert late.warnings == (IGNORED.format("_return(go,x,2)"), IGNORED.format("_return(go,x,3)"))
    assert atoms(late) == ["_return(go,x,4)", "c(4)"]
    found = atoms(play(solver, "#step 6. #closed 5. _return(go,x,4)."))
    assert found == ["_return(go,x,4)", "c(4)"], "it was asserted in time"


def test_rules_for_open_predicates_are_restored_as_rules_and_facts_as_facts():
    solver = solver_of("{ a }. #external sees/1. #cumulative t. b(X,t) :- sees(X). #volatile t.", models=0)
    play(solver, "#step 1. sees(x) :- a. sees(y). sees(z). sees(z) :- a. :- sees(w).")
    expected = set(play(solver, "#step 2.").answers)
    assert len(expected) == 2
    assert set(restored(solver).solve().answers) == expected


@pytest.mark.parametrize("rules", ["", "e(9) :- c(9)."], ids=["grown", "built again, for a loop"])
@pytest.mark.parametrize("first", [1, 6])
def test_steps_are_forgotten_however_the_horizon_gets_beyond_them(rules, first):
    program = ReactiveProgram.from_text("#cumulative t. #external e(t). #forget t : t-2. c(t) :- e(t). #volatile t.")
    snapshot = Snapshot.initial(program).with_update(
        parse_update(f"#step 1. {rules} #endstep."), Reader(program, False)
    )
    asking = Asking(program, snapshot, lambda one, horizon: Grounding(program, one, horizon), 8)
    asking.ground(first)
    assert asking.run(only(Question(1, 6)), lambda: False).satisfiable
    assert [str(one) for one in asking.grounding.undefined_between(1, 6) if one.name == "e"] == ["e(5)", "e(6)"]


def only(question):
    """A strategy that asks one question."""
    return (yield question)


# ---- What is ground at once ------------------------------------------------------------------------------------------


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
def test_pieces_end_where_steps_may_be_retired(keep_from, end, ends):
    assert list(pieces(1, end, 4, keep_from)) == ends


def test_building_ends_between_two_pieces_when_it_is_dropped():
    looks = []
    with pytest.raises(DroppedError):
        grounding_of(EXTERNALS, 1000, dropped=lambda: looks.append(1) or len(looks) > 3)
    assert len(looks) == 4


def test_changes_are_handed_over_before_clingo_grounds_or_searches(monkeypatch, compacts_at_once):
    opened, backend = [], clingo.Control.backend

    class Noted:
        """A backend that notes whether it is open."""

        def __init__(self, control):
            self._control, self._backend = control, backend(control)

        def __enter__(self):
            opened.append(self._control)
            return self._backend.__enter__()

        def __exit__(self, *error):
            opened.remove(self._control)
            return self._backend.__exit__(*error)

    def checked(step):
        def call(control, *arguments, **named):
            assert control not in opened
            return step(control, *arguments, **named)

        return call

    monkeypatch.setattr(clingo.Control, "backend", lambda control: Noted(control))
    monkeypatch.setattr(clingo.Control, "ground", checked(clingo.Control.ground))
    monkeypatch.setattr(clingo.Control, "solve", checked(clingo.Control.solve))
    solver = solver_of("#cumulative t. #external e(t). c(t) :- e(t). #volatile t.")
    for step in (1, 2, 3, 4):
        found = atoms(play(solver, f"#step {step}. #over {step}. e({step}). :- not c({step})."))
        assert found[-1] == f"e({step})"
    assert solver.snapshot.past is not None


@pytest.mark.parametrize("window", [0, -3])
def test_a_volatile_rule_of_no_steps_holds_at_none(window):
    solver = solver_of(f"#cumulative t. p(t). #volatile t : {window}. :- p(t). #volatile t.")
    assert [atoms(play(solver, f"#step {step}.")) for step in (1, 2)] == [["p(1)"], ["p(1)", "p(2)"]]


# ---- What a question leaves ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("predicts", [False, True])
def test_a_grounding_that_is_dropped_is_free_at_once(predicts):
    grounding = grounding_of(EXTERNALS, 3, "#volatile. sees(1).", predicts=predicts)
    assert grounding.undefined_between(1, 3)
    assert grounding.ask(Question(1, 3), lambda: False).satisfiable
    gone = weakref.ref(grounding)
    gc.disable()
    try:
        del grounding
        assert gone() is None
    finally:
        gc.enable()


HOLES = """
#program cumulative(t).
1 { in(P,H,t) : H = 1..11 } 1 :- P = 1..12.
:- in(P,H,t), in(Q,H,t), P < Q.
#program volatile(t).
"""


@pytest.mark.parametrize(
    ("text", "models"), [(HOLES, 1), ("{ a(1..40) }. #cumulative t. #volatile t.", 0)], ids=["none", "many"]
)
def test_a_search_that_is_stopped_replies_nothing(text, models):
    grounding = grounding_of(text)
    assert grounding.ask(Question(1, 1, models=models), lambda: True) == UNKNOWN


def test_an_interrupted_search_leaves_the_update_in_force():
    solver = solver_of("#cumulative t. #external e(t). :- e(t). #volatile t.")
    play(solver, "#step 1.")
    found = solver.update(parse_update("#step 2 : 0. e(2). #endstep."), lambda: True)
    assert found.outcome is SolveOutcome.INTERRUPTED
    assert solver.solve().outcome is SolveOutcome.UNSATISFIABLE
