"""Random programs and updates for hypothesis, in the format of the reference solver."""

import clingo
from hypothesis import strategies as st
from solver_reference import Parts

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

BODY = [
    "a",
    "b",
    "p(t)",
    "p(t-1)",
    "c(t-1)",
    "e(t)",
    "e(t-1)",
    "f(x,t)",
    "f(y,t)",
    "g(Z,t)",
    "g(x,t)",
    "d(t)",
    "w(t-1)",
]
NAMES = ["x", "y", "z"]


def literals(atoms):
    return st.tuples(st.booleans(), st.sampled_from(atoms)).map(lambda pair: ("" if pair[0] else "not ") + pair[1])


def bodies(atoms):
    safe = [atom for atom in atoms if "Z" not in atom]
    return st.lists(st.one_of(literals(safe), st.sampled_from(atoms)), min_size=1, max_size=3).map(", ".join)


RULES = st.one_of(
    bodies(BODY).map("c(t) :- {}.".format),
    bodies(BODY).map("d(t) :- {}.".format),
    bodies([*BODY, "c(t)", "d(t)"]).map("w(t) :- {}.".format),
    bodies([*BODY, "c(t)", "w(t)"]).map(":- {}.".format),
    bodies([*BODY, "g(Z,t+1)"]).map("{{ q(t) }} :- {}.".format),
    st.just("h(Z,t) :- g(Z,t)."),
    st.just("h(Z,t) :- h(Z,t-1), not p(t)."),
    st.just("n(t) :- 2 { g(Z,t) ; f(x,t) }."),
    st.just("c(t) :- g(Z,U), U <= t."),
)
VOLATILE = st.tuples(
    st.integers(1, 3),
    st.one_of(
        st.sampled_from([":- not c(t).", ":- w(t).", ":- p(t).", "v(t).", ":- h(x,t), not q(t).", ":- not d(t)."]),
        bodies([*BODY, "c(t)", "w(t)"]).map(":- {}.".format),
    ),
)
PARTS = st.builds(
    lambda rules, volatile, opens, heard, forgets: Parts(
        ("{ a }.", "{ b }.", *(["k(Z) :- g(Z,U)."] if opens and heard else [])),
        ("{ p(t) }.", "#defined q/1.", *rules),
        tuple(volatile),
        ("e(t)", "f(x,t)", "f(y,t)"),
        ("g",) if opens else (),
        forgets=tuple(forgets),
    ),
    st.lists(RULES, max_size=5),
    st.lists(VOLATILE, max_size=2),
    st.booleans(),
    st.booleans(),
    st.lists(st.just("t-1"), max_size=1),
)


def function(name, *arguments):
    return clingo.Function(name, [clingo.Number(a) if isinstance(a, int) else clingo.Function(a) for a in arguments])


STEPS = st.integers(1, 5)
HEADS = st.one_of(
    st.builds(lambda step: function("e", step), STEPS),
    st.builds(lambda name, step: function("f", name, step), st.sampled_from(NAMES[:2]), STEPS),
    st.builds(lambda name, step: function("g", name, step), st.sampled_from(NAMES), STEPS),
)
ATOMS = st.one_of(
    HEADS,
    st.sampled_from([function("a"), function("b")]),
    st.builds(lambda name, step: function(name, step), st.sampled_from(["p", "c", "d", "w"]), STEPS),
)
LITERALS = st.builds(Literal, ATOMS, st.booleans())
STATEMENTS = st.one_of(
    st.builds(Statement, HEADS),
    st.builds(Statement, HEADS),
    st.builds(Statement, HEADS, st.lists(LITERALS, min_size=1, max_size=2).map(tuple)),
    st.builds(Statement, st.none(), st.lists(LITERALS, min_size=1, max_size=2).map(tuple)),
)
TERMS = st.sampled_from([function("x"), function("y")])
ITEMS = st.one_of(
    STATEMENTS,
    STATEMENTS,
    STATEMENTS,
    st.sampled_from([Cumulative(), Volatile(), Volatile(1), Volatile(2), Volatile(3)]),
    st.builds(Assert, TERMS),
    st.builds(Retract, TERMS),
    st.builds(Forget, STEPS, STEPS),
)
UPDATES = st.builds(
    StreamUpdate,
    st.integers(1, 5),
    st.integers(0, 2),
    st.lists(ITEMS, max_size=4).map(tuple),
)


def without_undeclared(parts, update):
    """Remove statements about open predicates from ``update`` if the program does not declare them."""
    if parts.opens:
        return update
    items = [one for one in update.items if not (isinstance(one, Statement) and mentions(one, "g"))]
    return StreamUpdate(update.step, update.bound, tuple(items))


def mentions(statement, name):
    atoms = [one.atom for one in statement.body] + ([] if statement.head is None else [statement.head])
    return any(atom.name == name for atom in atoms)
