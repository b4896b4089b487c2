"""Sequences of updates of all kinds: answers and ignored heads, independent of the way of grounding."""

import pytest
from stream_play import IGNORED, SOLVERS, atoms, check_stream, drop_grounding, play, solver_of

from rosoclingo.oclingo import ReactiveSolver, SolveOutcome, parse_atom, parse_update
from rosoclingo.oclingo.errors import StoppedError

E = "#cumulative t. #external e(t). c(t) :- e(t). #volatile t."
OPEN = "#external e/1. a(X) :- e(X). #cumulative t. b(X,t) :- e(X). #volatile t."
SEEN = "{ a }. #external sees/1. #cumulative t. u(t) :- sees(t). #volatile t."
XY = "{ x ; y }. #cumulative t. #volatile t."
OPPOSITES = "- | x q(1) | y -q(1)"
LOOP = "{ a }. #cumulative t. #external e(t). #external f(t). #external g(t). d(t) :- e(t), a. #volatile t."

#: A program and its updates with their answers, see check_answers.
STREAMS = [
    # open signatures, externals, and heads unknown to the program
    (OPEN, "#step 3. => -", "e(n). => a(n) b(n,1) b(n,2) b(n,3) e(n)"),
    (E, "#step 1. e(1). => c(1) e(1)", "e(1). e(1). => c(1) e(1)", "#step 2. e(1). => c(1) e(1)"),
    (E, "#step 1. e(3). #volatile. e(2). => -", "#step 3. => c(3) e(3)"),
    ("#cumulative t. #external e(t) : t != 2.", "#step 2. e(2). e(3). => - ! e(2)", "#step 3. => e(3)"),
    ("#external x. #cumulative t. #external e(t). x :- e(t), t = 1.", "#step 1.", "#step 2. x. e(2). => e(2) ! x"),
    (E, "#step 1. new. #volatile. old. => new old", "#step 2. #volatile. old. => new old", "#step 3. => new"),
    (E, "#step 1. new :- e(1). #forget 1. => -", "#step 2. => -", "#step 3. new. => - ! new"),
    # repeated definitions of a head
    ("{ a }. " + E, "#step 1. #volatile. e(1). #cumulative. e(1). :- a. => c(1) e(1)",
     "e(1) :- a. => c(1) e(1) ! e(1)"),
    (E, "#step 1. #volatile. e(1). => c(1) e(1)", "#assert : x. e(1). => c(1) e(1)", "#retract : x. => -",
     "e(1). => c(1) e(1)"),
    *(
        (E, f"#step 1. {section} e(1) :- e(1). e(1) :- not e(1), e(1). => -", "#step 2. e(1). => c(1) e(1)",
         "#step 3. e(1) :- not e(2). => c(1) e(1) ! e(1)")
        for section in ("", "#volatile.", "#assert : x.")
    ),
    *(
        (f"#cumulative t. #external {e}(t). #external a(t). c(t) :- {e}(t).", f"#step 1. {e}(3) :- a(1). => -",
         f"#step 2. {e}(3) :- a(2). a(2). => a(2)", f"#step 3. => a(2) c(3) {e}(3)")
        for e in ("e", "-e")
    ),
    # lifetimes
    ("#cumulative t. #external e(t). #forget t : t-1.", "#step 3. e(2). e(3). => e(2) e(3)",
     "#step 4. e(1). e(3). => e(2) e(3) ! e(1)"),
    ("#iinit -2. #cumulative t. #external e(t). #forget t : t-1.", "#step 1.",
     "e(-2). e(-1). e(0). e(1). => e(1) ! e(-2) e(-1) e(0)"),
    ("#external x. #cumulative t. #forget t : t-2.", "#step 2 : 0. x. => x", "#step 3 : 0. => x", "x. => x"),
    *(
        (E, f"#step 2 : 0. {section} e(1). #forget 1.", f"#step 3 : 0. {end}", "#step 3 : 0. e(1). => c(1) e(1)")
        for section, end in (("#assert : x.", "#retract : x."), ("#volatile.", ""), ("", ""))
    ),
    (E, "#step 1. e(1).", "#step 2. e(2).", "#withdraw e(1). => c(2) e(2)"),
    # bodies
    (E, "#step 1. e(1) :- fresh(x). => -", "#step 2. => -", "fresh(x). => c(1) e(1) fresh(x)"),
    ("#cumulative t. #external e(t). d(t) :- e(t). c(t) :- d(t).", "#step 1.", "#volatile. e(1) :- c(1).",
     "e(1) :- d(1). => -"),
    *(
        (LOOP, "#step 1.", f"{rules} => - | a")
        for rules in ("f(1) :- d(1). e(1) :- f(1). g(1) :- d(1).", "g(1) :- d(1). e(1) :- f(1). f(1) :- d(1).",
                      "e(1) :- f(1). f(1) :- d(1). g(1) :- d(1).")
    ),
    # opposites
    ("{ x }. #cumulative t.", "#step 1. => - | x", "-x. => -x"),
    ("{ -p(1..2) }. #external e. #cumulative t.", "#step 1. p(1). p(2) :- e. => p(1) | p(1) -p(2)"),
    (XY, f"#step 1. q(1) :- x. -q(1) :- y. => {OPPOSITES}"),
    (XY, "#step 1. q(1) :- x.", f"-q(1) :- y. => {OPPOSITES}"),
    # no answer
    ("#external x. #cumulative t. #external e(t). c(t) :- e(t). :- e(1).", "#step 1 : 0. e(1). => ",
     "#step 2 : 0. e(2). x. c(2). => ! c(2)"),
    *(
        (SEEN, "#step 1. :- sees(5), a. => - | a", update)
        for update in ("sees(5). => sees(5)", "#volatile. sees(5). => sees(5)", "sees(5) :- a. => -")
    ),
    ("{ a }. #cumulative t. #external e(t). #external f(t). #volatile t : 3. :- a, t = 1.",
     "#step 1. #volatile : 2. e(1). #forget 1. => e(1)", "#step 2. => e(1)", "#step 3. => -", "#step 4. => - | a",
     "e(1). f(1). => e(1) | a e(1) ! f(1)"),
]  # fmt: skip


@pytest.mark.parametrize("way", ["in place", "regrounding", "planner", "planner with a new solver for each update"])
@pytest.mark.parametrize("stream", STREAMS)
def test_stream_has_the_expected_answers(stream, way):
    check_stream(way, *stream)


@SOLVERS
@pytest.mark.parametrize("cycle", ["t-2", "t", "t+1"])
@pytest.mark.parametrize("before", [[], ["#step 3."]])
def test_closed_cycle_rejects_actions_of_later_steps(before, cycle, kind):
    solver = solver_of(f"#cumulative t. {{ _action_lib(go,x,{cycle}) }}. #volatile t.", kind, models=0)
    for text in before:
        play(solver, text)
    result = play(solver, "#step 5. #closed 3.")
    number = len(result.answers)
    assert number == 16 if kind is ReactiveSolver else number > 1, "a plan has no actions beyond its horizon"
    assert not any(parse_atom("_action_lib(go,x,3)") in answer for answer in result.answers)


def test_closed_cycles_contain_committed_actions_up_to_now():
    solver = solver_of("#cumulative t. { _action_lib(go,x,t) }. #volatile t.", models=0)
    result = play(solver, "#step 3. #closed 0..2. :- not _action_lib(go,x,1).")
    assert sorted(sorted(str(atom)[-2] for atom in answer) for answer in result.answers) == [["1"], ["1", "3"]]
    assert len(play(solver, "#step 4. #closed 3..9. :- not _action_lib(go,x,3).").answers) == 1
    assert len(play(solver, "#step 5.").answers) == 2
    result = play(solver, "#step 2. #anew.")
    assert (result.step, solver.horizon, len(result.answers)) == (2, 2, 4)


@SOLVERS
def test_withdrawal_restores_facts_of_unsatisfiable_streams(kind):
    text = "{ a }. #cumulative t. #external e(t). { m(t) }. c(t) :- e(t). :- e(1). #volatile t. :- a. :- m(t)."
    solver = solver_of(text, kind)
    assert play(solver, "#step 1 : 0. e(1).").permanent
    result = play(solver, "#step 3 : 0. e(3). m(3).")
    assert (result.outcome, result.warnings) == (SolveOutcome.UNSATISFIABLE, (IGNORED.format("m(3)"),))
    assert {"c(3)", "e(3)"} <= set(atoms(play(solver, "#step 3 : 0. #withdraw e(1).")))


def test_dropped_update_leaves_the_state_unchanged():
    solver = solver_of("#external e/1. #cumulative t. b(X,t) :- e(X). #volatile t.")
    play(solver, "#step 100. #volatile. new(x).")
    drop_grounding(solver)
    with pytest.raises(StoppedError):
        solver.update(parse_update("#step 100. e(1). #endstep."), lambda: True)
    assert atoms(solver.solve()) == ["new(x)"]
