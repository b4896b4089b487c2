"""One grounding: externals by step, blocks of steps, and memory after a question."""

import gc
import weakref

import pytest
from stream_logs import cut
from stream_play import atoms, planner_of, play

from rosoclingo.oclingo import DroppedError, ReactiveProgram, parse_update
from rosoclingo.planning.grounding import Grounding, pieces
from rosoclingo.planning.question import UNKNOWN, Question
from rosoclingo.planning.snapshot import Snapshot
from rosoclingo.planning.strategy_runner import StrategyRunner

IGNORED = "Head {} has not been declared external. The entire rule will be ignored."
EXTERNALS = (
    "#external door. #external sees/1. d(1..2). #program cumulative(t). #external e(t). #external both(1) : t = 1. "
    "both(t+1). #external f(X) : d(X), t = 4. #program volatile(t). s(t) :- sees(t)."
)
STEPS = "#cumulative t. #external e(t). c(t) :- e(t). #volatile t."


def snapshot_of(program, update):
    return Snapshot.initial(program).with_update(parse_update(f"#step 1. {update} #endstep."), program)


def grounding_of(text, horizon=1, update="", **options):
    program = ReactiveProgram.from_text(text)
    return Grounding(program, snapshot_of(program, update), horizon, **options)


# ---- Externals -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("horizons", [(1, 2, 3, 4, 5), (1, 3, 5), (3, 5)])
def test_externals_belong_to_the_steps_that_declare_them(horizons):
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


@pytest.mark.parametrize("is_restored", [False, True])
@pytest.mark.parametrize(
    ("text", "updates", "late", "closed", "expected"),
    [
        (STEPS, ["#step 5.", "#forget 3..3."], "e(2). e(3). e(4).", ["e(3)"], ["c(2)", "c(4)", "e(2)", "e(4)"]),
        (
            "#external sees/1. a(X) :- sees(X). #cumulative t. #volatile t.",
            ["#step 1. #volatile. sees(x).", "#step 2. #forget 0..9."],
            "sees(x).",
            [],
            ["a(x)", "sees(x)"],
        ),
        (
            "#cumulative t. #external _return(go,x,t). c(t) :- _return(go,x,t). #volatile t.",
            [f"#step {step}. #closed {step}." for step in (1, 2, 3, 4)],
            "_return(go,x,2). _return(go,x,3). _return(go,x,4).",
            ["_return(go,x,2)", "_return(go,x,3)"],
            ["_return(go,x,4)", "c(4)"],
        ),
    ],
    ids=["forgotten", "open predicates have no step", "returns before the last closed cycle"],
)
def test_externals_are_closed_in_restored_histories_too(text, updates, late, closed, expected, is_restored):
    solver = planner_of(text)
    for update in updates:
        play(solver, update)
    if is_restored:
        solver.restore(cut(solver))
    result = play(solver, late)
    assert (result.warnings, atoms(result)) == (tuple(map(IGNORED.format, closed)), expected)
    assert atoms(play(solver, f"#step 6. #closed 5. {late}")) == expected, "facts asserted in time stay"


def test_rules_and_facts_of_open_predicates_are_restored():
    solver = planner_of("{ a }. #external sees/1. #cumulative t. b(X,t) :- sees(X). #volatile t.", models=0)
    play(solver, "#step 1. sees(x) :- a. sees(y). sees(z). sees(z) :- a. :- sees(w).")
    expected = set(play(solver, "#step 2.").answers)
    assert len(expected) == 2
    solver.restore(cut(solver))
    assert set(solver.solve().answers) == expected


def only(question):
    """A strategy that asks one question."""
    return (yield question)


@pytest.mark.parametrize("rules", ["", "e(9) :- c(9)."], ids=["grown", "regrounding for a loop"])
@pytest.mark.parametrize("first", [1, 6])
def test_steps_are_forgotten_when_the_horizon_passes_them(rules, first):
    program = ReactiveProgram.from_text("#cumulative t. #external e(t). #forget t : t-2. c(t) :- e(t). #volatile t.")
    runner = StrategyRunner(program, snapshot_of(program, rules), lambda one, last: Grounding(program, one, last), 8)
    runner.ground(first)
    assert runner.run(only(Question(1, 6)), lambda: False).satisfiable
    assert [str(one) for one in runner.grounding.undefined_between(1, 6) if one.name == "e"] == ["e(5)", "e(6)"]


# ---- Blocks of steps -------------------------------------------------------------------------------------------------


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
    assert list(pieces(1, end, 4, keep_from)) == ends


def test_dropped_grounding_ends_between_two_pieces():
    looks = []
    with pytest.raises(DroppedError):
        grounding_of(EXTERNALS, 1000, dropped=lambda: looks.append(1) or len(looks) > 3)
    assert len(looks) == 4


@pytest.mark.parametrize("window", [0, -3])
def test_volatile_rule_without_steps_never_holds(window):
    solver = planner_of(f"#cumulative t. p(t). #volatile t : {window}. :- p(t). #volatile t.")
    assert [atoms(play(solver, f"#step {step}.")) for step in (1, 2)] == [["p(1)"], ["p(1)", "p(2)"]]


# ---- After a question ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("predicts", [False, True])
def test_grounding_without_references_is_freed_at_once(predicts):
    grounding = grounding_of(EXTERNALS, 3, "#volatile. sees(1).", predicts=predicts)
    assert grounding.undefined_between(1, 3)
    assert grounding.ask(Question(1, 3), lambda: False).satisfiable
    reference = weakref.ref(grounding)
    gc.disable()
    try:
        del grounding
        assert reference() is None
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
def test_stopped_search_has_an_unknown_reply(text, models):
    grounding = grounding_of(text)
    assert grounding.ask(Question(1, 1, models=models), lambda: True) == UNKNOWN
