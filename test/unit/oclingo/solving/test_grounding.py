"""One grounding: which externals belong to which step, what is grounded at once, and what a search leaves undone."""

import gc
import weakref
from contextlib import contextmanager

import clingo
import pytest
from stream_logs import cut
from test_solver import atoms, play, solver_of

from rosoclingo.oclingo import ReactiveProgram, SolveOutcome, parse_atom, parse_update
from rosoclingo.oclingo.solving.assumptions import Search
from rosoclingo.oclingo.solving.grounding import Grounding
from rosoclingo.oclingo.solving.stream_state import FOREVER, StreamState, block_ends

IGNORED = "Head {} has not been declared external. The entire rule will be ignored."
EXTERNALS = (
    "#external door. #external sees/1. d(1..2). #program cumulative(t). #external e(t). #external both(1) : t = 1. "
    "both(t+1). #external f(X) : d(X), t = 4. #program volatile(t). s(t) :- sees(t)."
)


@pytest.mark.parametrize("shortest", [True, False])
@pytest.mark.parametrize("blocks", [(1, 2, 3, 4, 5), (1, 3, 5), (3, 5)])
def test_to_which_steps_externals_belong(shortest, blocks):
    if not shortest:
        blocks = range(1, 6)
    grounding = Grounding(ReactiveProgram.from_text(EXTERNALS), [parse_atom("sees(1)")], set(), shortest)
    for last in blocks:
        grounding.ground_to(last)
    grounding.atoms.close(parse_atom("e(5)"))

    def declared(first, last, **options):
        found = map(str, grounding.declared_between(first, last, **options))
        return sorted(one for one in found if one[0] != "_")

    steps = [declared(step, step) for step in range(1, 6)]
    assert steps[:3] == [["both(1)", "door", "e(1)"], ["e(2)"], ["e(3)"]]
    assert "e(4)" in steps[3]
    assert steps[4] == []
    assert declared(1, 3) == ["both(1)", "door", "e(1)", "e(2)", "e(3)"]
    assert declared(1, 3, base=False) == ["both(1)", "e(1)", "e(2)", "e(3)"]


@pytest.mark.parametrize("shortest", [True, False])
def test_externals_are_found_as_their_steps_are_ground(shortest):
    text = "#external p(2). #program cumulative(t). #external p(t). #program volatile(t)."
    grounding = Grounding(ReactiveProgram.from_text(text), (), set(), shortest)
    for last, found in ((1, ["p(1)", "p(2)"]), (2, []), (3, ["p(3)"])):
        grounding.ground_to(last)
        names = map(str, grounding.declared_between(last, last))
        assert sorted(one for one in names if one[0] == "p") == found, "base counts as the first step"


def test_open_atoms_may_be_given_in_any_way():
    program = ReactiveProgram.from_text("#external sees/1. a(X) :- sees(X). #cumulative t. #volatile t.")
    grounding = Grounding(program, iter([parse_atom("sees(1)"), parse_atom("sees(2)")]), set())
    assert all(grounding.atoms.is_open(parse_atom(f"sees({one})")) for one in (1, 2))


@pytest.mark.parametrize(("shortest", "foresees"), [(True, False), (True, True), (False, False)])
def test_what_is_let_go_is_free_at_once(shortest, foresees):
    program = ReactiveProgram.from_text(EXTERNALS)
    grounding = Grounding(program, [parse_atom("sees(1)")], set(), shortest, foresees=foresees)
    grounding.ground_to(3)
    assert grounding.declared_between(1, 3)
    assert grounding.search(1, lambda: False, 1, 3).satisfiable
    gone = weakref.ref(grounding)
    gc.disable()
    try:
        del grounding
        assert gone() is None
    finally:
        gc.enable()


@pytest.mark.parametrize("shortest", [True, False])
def test_changes_are_handed_over_before_clingo_grounds_or_searches(shortest, monkeypatch, compacts_at_once):
    opened, backend = [], clingo.Control.backend

    @contextmanager
    def noted(control):
        with backend(control) as session:
            opened.append(control)
            yield session
        opened.remove(control)

    def checked(step):
        def call(control, *arguments, **named):
            assert control not in opened
            return step(control, *arguments, **named)

        return call

    monkeypatch.setattr(clingo.Control, "backend", noted)
    monkeypatch.setattr(clingo.Control, "ground", checked(clingo.Control.ground))
    monkeypatch.setattr(clingo.Control, "solve", checked(clingo.Control.solve))
    solver = solver_of("#cumulative t. #external e(t). c(t) :- e(t). #volatile t.", shortest=shortest)
    for step in (1, 2, 3, 4):
        solver.forget_before(step)
        assert atoms(play(solver, f"#step {step}. #volatile. e({step}). :- not c({step})."))[-1] == f"e({step})"
    assert (solver.state.past is not None) is shortest


@pytest.mark.parametrize("shortest", [True, False])
def test_a_stream_that_is_restored_forgets_the_same(shortest):
    solver = solver_of("#cumulative t. #external e(t). c(t) :- e(t). #volatile t.", shortest=shortest)
    play(solver, "#step 5.")
    solver.restore(cut(solver))
    play(solver, "#forget 3..3.")
    result = play(solver, "e(2). e(3). e(4).")
    assert result.warnings == (IGNORED.format("e(3)"),)
    assert atoms(result) == ["c(2)", "c(4)", "e(2)", "e(4)"]


def test_atoms_of_open_predicates_are_of_no_step_and_not_forgotten():
    solver = solver_of("#external sees/1. a(X) :- sees(X). #cumulative t. #volatile t.")
    play(solver, "#step 1. #volatile. sees(x).")
    play(solver, "#step 2. #forget 0..9.")
    assert atoms(play(solver, "sees(x).")) == ["a(x)", "sees(x)"]


@pytest.mark.parametrize(
    ("keep_from", "ends"),
    [
        (0, [4, 8, 10]),
        (1, [4, 8, 10]),
        (2, [1, 5, 9, 10]),
        (4, [3, 7, 10]),
        (5, [4, 8, 10]),
        (6, [4, 5, 9, 10]),
        (10, [4, 8, 9, 10]),
        (11, [4, 8, 10]),
    ],
)
def test_blocks_end_where_steps_may_be_retired(keep_from, ends):
    assert list(block_ends(StreamState(step=10, horizon=10, keep_from=keep_from), 1, 4)) == ends


@pytest.mark.parametrize(("end", "ends"), [(0, []), (1, [1]), (5, [4, 5]), (7, [4, 5, 7]), (12, [4, 5, 9, 10])])
def test_the_last_block_ends_with_the_step_asked_for(end, ends):
    assert list(block_ends(StreamState(step=10, horizon=10, keep_from=6), 1, 4, end)) == ends


@pytest.mark.parametrize("restored", [False, True])
def test_returns_of_all_cycles_before_the_last_closed_one_are_closed(restored):
    solver = solver_of("#cumulative t. #external _return(go,x,t). c(t) :- _return(go,x,t). #volatile t.")
    for step in (1, 2, 3, 4):
        play(solver, f"#step {step}.")
        solver.close_cycle(step, [])
    if restored:
        solver.restore(cut(solver))
    late = play(solver, "_return(go,x,2). _return(go,x,3). _return(go,x,4).")
    assert late.warnings == (IGNORED.format("_return(go,x,2)"), IGNORED.format("_return(go,x,3)"))
    assert atoms(late) == ["_return(go,x,4)", "c(4)"]


def test_rules_for_open_predicates_are_restored_as_rules_and_facts_as_facts():
    solver = solver_of("{ a }. #external sees/1. #cumulative t. b(X,t) :- sees(X). #volatile t.", models=0)
    play(solver, "#step 1. sees(x) :- a. sees(y). sees(z). sees(z) :- a. :- sees(w).")
    expected = set(play(solver, "#step 2.").answers)
    assert len(expected) == 2
    solver.restore(cut(solver))
    assert set(solver.solve().answers) == expected


def test_steps_that_are_ground_anew_one_by_one_see_nothing_of_later_ones():
    solver = solver_of("#cumulative t. p(t). q(t) :- p(t+1). #volatile t.")
    play(solver, "#step 4.")
    solver.restore(cut(solver))
    assert atoms(play(solver, "#step 5.")) == ["p(1)", "p(2)", "p(3)", "p(4)", "p(5)"]


@pytest.mark.parametrize("window", [0, -3])
def test_a_volatile_rule_of_no_steps_holds_at_none(window):
    solver = solver_of(f"#cumulative t. p(t). #volatile t : {window}. :- p(t). #volatile t.")
    assert [atoms(play(solver, f"#step {step}.")) for step in (1, 2)] == [["p(1)"], ["p(1)", "p(2)"]]


HOLES = """
#program cumulative(t).
1 { in(P,H,t) : H = 1..11 } 1 :- P = 1..12.
:- in(P,H,t), in(Q,H,t), P < Q.
#program volatile(t).
"""


def test_a_search_ends_when_it_is_stopped():
    grounding = Grounding(ReactiveProgram.from_text(HOLES), (), set())
    grounding.ground_to(1)
    assert grounding.search(1, lambda: True, 1, 1).satisfiable is None
    assert not grounding.satisfied


def test_a_search_that_is_stopped_among_many_answers_has_none():
    grounding = Grounding(ReactiveProgram.from_text("{ a(1..40) }. #cumulative t. #volatile t."), (), set())
    grounding.ground_to(1)
    assert grounding.search(0, lambda: True, 1, 1) == Search(None)


def test_what_was_not_searched_is_not_known_to_have_an_answer():
    program = ReactiveProgram.from_text("{ a }. #program cumulative(t). #program volatile(t).")
    grounding = Grounding(program, (), set())
    assert not grounding.satisfied
    grounding.ground_to(1)
    assert not grounding.satisfied
    (rule,) = [one for _, one in parse_update("#step 1. :- a. #endstep.").sections()]
    for change in (lambda: grounding.ground_to(2), lambda: grounding.add(rule, FOREVER)):
        assert grounding.search(1, lambda: False, grounding.horizon, grounding.horizon).satisfiable
        assert grounding.satisfied
        change()
        assert not grounding.satisfied


def test_an_update_is_no_other_for_a_search_that_was_stopped():
    solver = solver_of("#cumulative t. #external e(t). :- e(t). #volatile t.")
    play(solver, "#step 1.")
    found = solver.update(parse_update("#step 2 : 0. e(2). #endstep."), lambda: True)
    assert found.outcome is SolveOutcome.INTERRUPTED
    assert solver.solve().outcome is SolveOutcome.UNSATISFIABLE


@pytest.mark.parametrize(("rule", "heard"), [("s(t) :- e(t).", False), ("{ s(t) }. e(t) :- s(t).", True)])
@pytest.mark.parametrize("foresees", [True, False])
def test_rules_are_heard_of_only_where_they_may_define_externals(monkeypatch, rule, heard, foresees):
    """To hear of each rule takes as long as to ground it."""
    program = ReactiveProgram.from_text(f"#program cumulative(t). #external e(t). {rule} #program volatile(t).")
    observers, register = [], clingo.Control.register_observer

    def note(self, observer, replace=False):
        observers.append(observer)
        register(self, observer, replace)

    monkeypatch.setattr(clingo.Control, "register_observer", note)
    grounding = Grounding(program, [], set(), shortest=True, foresees=foresees)
    grounding.ground_to(3)
    assert any(type(one).rule is not clingo.backend.Observer.rule for one in observers) is heard


def test_a_program_that_had_an_answer_has_one_whatever_was_asked_for_then():
    program = ReactiveProgram.from_text("#program cumulative(t). { a(t) }. #external e(t).")
    grounding = Grounding(program, [], set(), shortest=True)
    grounding.ground_to(1)
    assert not grounding.satisfied
    assert grounding.search(1, lambda: False, 1, 1).satisfiable
    (atom,) = [one for one in grounding.known if str(one) == "a(1)"]
    refused = grounding.search(1, lambda: False, 1, 1, [(atom, True), (atom, False)])
    assert refused.satisfiable is False
    assert grounding.satisfied
    grounding.ground_to(2)
    assert not grounding.satisfied
