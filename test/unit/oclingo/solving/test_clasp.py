"""Workarounds for known bugs of clasp."""

import clingo
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shipped import DATA
from solver_reference import Parts
from test_solver_properties import compare

from rosoclingo.oclingo import ReactiveProgram, ReactiveSolver, parse_term, parse_update
from rosoclingo.oclingo.progression.updates import Assert, Forget, Literal, Retract, Statement, StreamUpdate, Volatile

#: Part of a grounding of the mailbot's program (aspif) that clasp's equivalence preprocessing makes unsatisfiable.
EQUIVALENCES = DATA / "equivalences.aspif"


def add_rules(backend, lines):
    """Add the rules of a program in aspif; bodies are conjunctions or have weights."""
    atoms = {}

    def literal(number):
        """Map a literal of the file to the literal of the control."""
        atom = atoms[abs(number)] if abs(number) in atoms else atoms.setdefault(abs(number), backend.add_atom())
        return atom if number > 0 else -atom

    for line in lines:
        _, choice, size, *rest = map(int, line.split())
        head, (weighted, *body) = [literal(one) for one in rest[:size]], rest[size:]
        if weighted:
            pairs = [(literal(one), weight) for one, weight in zip(body[2::2], body[3::2])]
            backend.add_weight_rule(head, body[0], pairs, bool(choice))
        else:
            backend.add_rule(head, [literal(one) for one in body[1:]], bool(choice))


@pytest.mark.parametrize(
    "text",
    [
        "#program base. { a; b }. :- 2 { a; b }.",
        "#program cumulative(t). 1 { a(t); b(t) } 1.",
        "#program volatile(t). { a(t); b(t) }. :- #count { 1 : a(t); 2 : b(t) } > 1.",
    ],
)
def test_solver_arguments_avoid_faulty_equivalence_preprocessing(text):
    control = clingo.Control(ReactiveProgram.from_text(text).arguments())
    with control.backend() as backend:
        add_rules(backend, EQUIVALENCES.read_text(encoding="ascii").splitlines()[1:-1])
    assert control.solve().satisfiable


#: Heads of rules of a step -> possible body atoms, mostly externals of this and the previous step.
TIMED = {"b(t)": ("e(t)", "e(t-1)"), "c(t)": ("e(t)", "e(t-1)", "b(t)"), "d(t)": ("e(t)", "b(t)", "c(t)", "p(t)")}
SIGNS = st.sampled_from(("not ", "not ", ""))
RULES = st.sampled_from(sorted(TIMED)).flatmap(
    lambda head: st.lists(st.tuples(SIGNS, st.sampled_from(TIMED[head])).map("".join), min_size=1, max_size=2).map(
        lambda body: f"{head} :- {', '.join(body)}."
    )
)
WEIGHTS = st.sampled_from(
    ["d(t) :- 2 { e(t); b(t); c(t) }.", "d(t) :- 3 #sum { 1 : b(t-1); 2 : e(t); 1 : c(t) }.", "1 { p(t); q(t) } 1."]
)
ENDS = st.tuples(st.integers(1, 2), st.sampled_from([":- c(t).", ":- not c(t).", ":- not d(t), b(t).", "v(t)."]))
PARTS = st.builds(
    lambda rules, more, volatile: Parts(
        ("#defined b/1. #defined c/1. #defined d/1. #defined p/1.",), (*rules, *more), tuple(volatile), ("e(t)",), ()
    ),
    st.lists(RULES, min_size=2, max_size=4),
    st.sampled_from([(), (), ("{ p(t) }.",)]) | st.tuples(WEIGHTS),
    st.lists(ENDS, max_size=1),
)
EXTERNALS = st.sampled_from(["e(1)", "e(2)"]).map(parse_term)
CONDITIONS = st.tuples(
    st.builds(
        Literal, st.sampled_from(["e(1)", "e(2)", "b(1)", "c(1)"]).map(parse_term), st.sampled_from([False, True])
    )
)
STATEMENTS = st.builds(Statement, EXTERNALS, CONDITIONS) | st.builds(Statement, EXTERNALS)
LIFETIMES = st.sampled_from([Volatile(), Volatile(2), Assert(parse_term("x")), Retract(parse_term("x")), Forget(1, 2)])
STREAMS = st.lists(
    st.lists(STATEMENTS | STATEMENTS | LIFETIMES, min_size=1, max_size=3).map(tuple), min_size=2, max_size=3
).map(lambda updates: [StreamUpdate(step, 0, items) for step, items in enumerate(updates, 1)])


@pytest.mark.slow
@settings(max_examples=settings.default.max_examples * 4)  # about one example in a hundred reveals the bug
@given(PARTS, STREAMS)
def test_answers_after_several_updates_equal_those_from_scratch(parts, updates):
    compare(parts, updates)


REGRESSIONS = [
    # an update that asserts a fact and closes an external of the same step
    (
        "#cumulative t. #external e(t). b(t) :- not e(t). c(t) :- not e(t-1). d(t) :- e(t). d(t) :- not c(t).",
        ["#step 1 : 0. #endstep.", "#step 2 : 0. #volatile. e(1). #forget 2. #endstep."],
        ["b(2)", "c(1)", "d(1)", "d(2)", "e(1)"],
    ),
    (
        "#cumulative t. #external e(t). b(t) :- not e(t). b(t) :- not e(t-1).",
        ["#step 1 : 0. e(1) :- not e(2). #endstep.", "#step 2 : 0. e(2). #endstep."],
        ["b(1)", "b(2)", "e(2)"],
    ),
]


@pytest.mark.parametrize(("program", "updates", "answer"), REGRESSIONS)
def test_answer_contains_the_facts_of_its_update(program, updates, answer):
    solver = ReactiveSolver(ReactiveProgram.from_text(program), models=0)
    results = [solver.update(parse_update(text)) for text in updates]
    assert [sorted(map(str, one)) for one in results[-1].answers] == [answer]
