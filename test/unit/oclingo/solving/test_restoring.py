"""A stream's state is all there is: a solver restored from it answers as the one that it came from."""

from hypothesis import given
from hypothesis import strategies as st
from solver_reference import Parts, Reference
from test_solver_properties import LITERALS, RULES, VOLATILE, function

from rosoclingo.oclingo import ReactiveProgram, ReactiveSolver, SolveOutcome, parse_update
from rosoclingo.oclingo.progression.updates import (
    Assert,
    Cumulative,
    Forget,
    Literal,
    Retract,
    Statement,
    StreamUpdate,
    Volatile,
)
from rosoclingo.oclingo.remote.state_wire import state_from_message, state_to_message
from rosoclingo.oclingo.remote.wire import Lines, encode

PROGRAM = """
#cumulative t.
#external e(t).
#volatile t.
"""


def test_a_restored_solver_knows_who_depends_on_whom():
    solver = ReactiveSolver(ReactiveProgram.from_text(PROGRAM), models=0)
    solver.update(parse_update("x(1) :- e(1). #endstep."))
    twin = restored(solver)
    for text in ("#volatile. e(1) :- y(1). #endstep.", "e(1) :- x(1). #endstep."):
        assert solver.update(parse_update(text)).answers == twin.update(parse_update(text)).answers == (frozenset(),)


def restored(solver):
    """Return a fresh solver with the state of ``solver``, as if it had come from another process."""
    twin = ReactiveSolver(solver.program, models=solver.models)
    state = solver.snapshot()
    twin.restore(state_from_message(Lines().feed(encode(state_to_message(state)))[0]))
    return twin


LOOPS = st.sampled_from(
    [
        "c(t) :- e(t).",
        "c(t) :- f(x,t).",
        "d(t) :- c(t).",
        "d(t) :- d(t-1), not p(t).",
        "w(t) :- d(t-1), e(t).",
        ":- c(t), not d(t).",
    ]
)
PARTS = st.builds(
    lambda loops, rules, volatile: Parts(
        ("{ a }.", "{ b }."),
        ("{ p(t) }.", "#defined q/1.", "#defined g/2.", "#defined c/1.", "#defined d/1.", *loops, *rules),
        tuple(volatile),
        ("e(t)", "f(x,t)", "f(y,t)"),
        (),
        ("x", "y"),
    ),
    st.lists(LOOPS, max_size=4),
    st.lists(RULES.filter(lambda rule: "g(" not in rule), max_size=2),
    st.lists(VOLATILE, max_size=1),
)
STEPS = st.integers(1, 3)
HEADS = st.sampled_from([function(name, 1) for name in "exy"] + [function("e", 2), function("f", "x", 1)])
ATOMS = st.one_of(HEADS, HEADS, st.builds(lambda name, step: function(name, step), st.sampled_from("cdw"), STEPS))
SUPPORTS = st.one_of(ATOMS.map(Literal), ATOMS.map(Literal), ATOMS.map(Literal), LITERALS)
STATEMENTS = st.one_of(
    st.builds(Statement, HEADS, SUPPORTS.map(lambda one: (one,))),
    st.builds(Statement, HEADS, SUPPORTS.map(lambda one: (one,))),
    st.builds(Statement, HEADS, st.lists(SUPPORTS, max_size=2).map(tuple)),
    st.builds(Statement, st.none(), st.lists(LITERALS, min_size=1, max_size=2).map(tuple)),
)
TERMS = st.sampled_from([function("u"), function("v")])
ITEMS = st.one_of(
    STATEMENTS,
    STATEMENTS,
    STATEMENTS,
    st.sampled_from([Cumulative(), Volatile(), Volatile(2)]),
    st.builds(Assert, TERMS),
    st.builds(Retract, TERMS),
    st.builds(Forget, STEPS, STEPS),
)
UPDATES = st.builds(StreamUpdate, STEPS, st.integers(0, 2), st.lists(ITEMS, max_size=4).map(tuple))


@given(PARTS, st.lists(UPDATES, min_size=1, max_size=6), st.sets(st.integers(0, 5)))
def test_restored_solvers_answer_as_their_originals_and_as_ones_from_scratch(parts, updates, moves):
    """``moves`` are the updates before which the one solver is replaced by a restored one."""
    reference = Reference(parts)
    original = twin = ReactiveSolver(ReactiveProgram.from_text(parts.text()), models=0)
    for number, update in enumerate(updates):
        satisfiable, answers, horizon, _ = reference.update(update)
        twin = restored(twin) if number in moves or twin is original else twin
        mine, its = original.update(update), twin.update(update)
        assert texts(mine) == texts(its) == answers, (parts.text(), str(update))
        assert mine.outcome is its.outcome
        assert (mine.outcome is SolveOutcome.SATISFIABLE) == satisfiable
        if mine.permanent or its.permanent:
            return
        assert mine.horizon == its.horizon == horizon
        # whether a fact that follows from others is passed over in silence depends on what has been searched
        for warning in set(mine.warnings) ^ set(its.warnings):
            if "nothing depends on it" in warning:
                continue  # told once for all solvers of the program
            assert all(warning.split()[1] in answer for answer in answers)


def texts(result):
    return {frozenset(map(str, answer)) for answer in result.answers}
