"""Workarounds for known bugs of clasp."""

import clingo
import pytest
from shipped import DATA

from rosoclingo.oclingo import ReactiveProgram, ReactiveSolver, parse_update

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
