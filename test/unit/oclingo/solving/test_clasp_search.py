"""Questions to clasp: what is quick is answered in place, whatever may take long hears of a stop."""

import clingo
import pytest

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.oclingo.solving.clasp_search import FEW_CONFLICTS, SMALL, ClaspSearch, Limits

PIGEONS = "1 { in(P,H) : H = 1..n-1 } 1 :- P = 1..n. :- in(P,H), in(Q,H), P < Q. #const n=12."
CHOICE = "{ a(1..n) }. :- not a(1). #const n=5."


def never():
    raise AssertionError("nobody looks for a stop")


def ask(text, limits, stopped, blames=False, assumed=(), **constants):
    """The result, the core, and the answers that were found."""
    program = ReactiveProgram.from_text(text, constants=constants)
    control, answers = clingo.Control(program.arguments()), []
    program.load_into(control)
    control.ground([("base", [])])
    symbols = control.symbolic_atoms
    literals = [symbols[clingo.parse_term(atom)].literal * sign for atom, sign in assumed]
    search = ClaspSearch(control, program)
    keep = lambda model: answers.append(model.symbols(atoms=True))  # noqa: E731
    result, core = search.run(limits, literals, keep, stopped, blames)
    return result, [literals.index(one) for one in core], answers


def test_what_is_quick_is_answered_in_place():
    result, _, answers = ask(CHOICE, Limits(1, None, best=True, advised=True), never)
    assert result.satisfiable
    assert len(answers) == 1
    result, _, answers = ask(CHOICE + " :- a(1).", Limits(1, None, best=True, advised=True), never)
    assert result.satisfiable is False
    assert answers == []


def test_what_is_hard_hears_of_a_stop_though_it_is_small():
    asked = []
    result, _, _ = ask(PIGEONS, Limits(1, None, best=True, advised=True), lambda: asked.append(1) or True)
    assert result.interrupted
    assert asked


@pytest.mark.parametrize("conflicts", [1, FEW_CONFLICTS, FEW_CONFLICTS + 1])
def test_a_limit_is_kept_to_at_either_place(conflicts):
    result, _, _ = ask(PIGEONS, Limits(1, conflicts, best=True, advised=True), lambda: False)
    assert result.unknown
    assert not result.interrupted


def test_what_a_few_conflicts_do_not_decide_is_decided_with_more():
    result, _, _ = ask(PIGEONS, Limits(1, None, best=True, advised=True), lambda: False, n="7")
    assert result.satisfiable is False


@pytest.mark.parametrize(
    ("text", "constants", "limits"),
    [
        (CHOICE, {"n": str(SMALL + 1)}, Limits(1, None, best=True, advised=True)),
        (CHOICE, {"n": "60"}, Limits(0, None, best=True, advised=True)),
        (CHOICE + "#minimize { X,X : a(X) }.", {}, Limits(1, None, best=True, advised=True)),
    ],
    ids=["many atoms", "all answers", "the best"],
)
def test_what_may_take_long_without_a_conflict_hears_of_a_stop(text, constants, limits, monkeypatch):
    monkeypatch.setattr(ClaspSearch, "run_in_place", lambda *rest: never())
    result, _, answers = ask(text, limits, lambda: True, **constants)
    assert result.interrupted or answers


def test_who_is_to_blame_is_told():
    assumed, text = [("a(4)", 1), ("a(2)", 1), ("a(3)", 1), ("a(5)", 1)], "{ a(1..5) }. :- a(2), a(3)."
    result, core, _ = ask(text, Limits(1, None, best=True, advised=True), lambda: False, True, assumed)
    assert result.satisfiable is False
    assert set(core) >= {1, 2}
    assert 3 not in core
