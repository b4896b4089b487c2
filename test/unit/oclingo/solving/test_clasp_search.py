"""Searches of clasp: limits, stops and unsat cores."""

import clingo
import pytest

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.oclingo.solving.clasp_search import ClaspSearch, SearchLimits

PIGEONS = "1 { in(P,H) : H = 1..n-1 } 1 :- P = 1..n. :- in(P,H), in(Q,H), P < Q. #const n=12."
CHOICE = "{ a(1..n) }. :- not a(1). #const n=5."


def ask(text, stopped=lambda: False, assumed=None, models=1, conflicts=None, **constants):
    """Search a program; return the result, the core as indices of ``assumed``, and the answers."""
    program = ReactiveProgram.from_text(text, constants=constants)
    control, answers = clingo.Control(program.arguments()), []
    program.load_into(control)
    control.ground([("base", [])])
    literals = [control.symbolic_atoms[clingo.parse_term(atom)].literal for atom in assumed or ()]
    limits = SearchLimits(models, conflicts, best=True, advised=True)
    keep = lambda model: answers.append(model.symbols(atoms=True))  # noqa: E731
    result, core = ClaspSearch(control, program).run(limits, literals, keep, stopped, assumed is not None)
    return result, [literals.index(one) for one in core], answers


@pytest.mark.parametrize(
    ("text", "options", "satisfiable", "answers"),
    [
        (CHOICE, {}, True, 1),
        (CHOICE, {"models": 0}, True, 16),
        (CHOICE + " :- a(1).", {}, False, 0),
        (PIGEONS, {"n": "7"}, False, 0),
    ],
)
def test_search_finds_the_requested_answers(text, options, satisfiable, answers):
    result, _, found = ask(text, **options)
    assert (result.satisfiable, len(found)) == (satisfiable, answers)


def test_search_ends_after_a_stop():
    asked = []
    result, _, _ = ask(PIGEONS, lambda: asked.append(1) or True)
    assert result.interrupted
    assert asked


@pytest.mark.parametrize("conflicts", [1, 100])
def test_search_ends_at_the_conflict_limit(conflicts):
    result, _, _ = ask(PIGEONS, conflicts=conflicts)
    assert result.unknown
    assert not result.interrupted


def test_search_returns_an_unsat_core():
    result, core, _ = ask("{ a(1..5) }. :- a(2), a(3).", assumed=["a(4)", "a(2)", "a(3)", "a(5)"])
    assert result.satisfiable is False
    assert set(core) >= {1, 2}
    assert 3 not in core
