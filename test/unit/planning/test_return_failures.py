"""Failures told as such: ``_failed(A,V,C)`` beside each return that is not what a committed action was about."""

import pytest

from rosoclingo.oclingo import ReactiveProgram, parse_atom, parse_update
from rosoclingo.oclingo.program.update_reader import Reader, with_their_failures
from rosoclingo.planning.solver import PlanSolver

PROGRAM = """
#program cumulative(t).
#external _return/3.
#external _failed/3.
1 { _action_lib(go,(a;b),t) } 1.
bad(V,t) :- _failed(go,V,t), not _action_lib(go,V,t).
#show bad/2.
"""


def answers(*updates, program=PROGRAM, models=1):
    solver = PlanSolver(ReactiveProgram.from_text(program), models=models)
    results = [solver.update(parse_update(text)) for text in updates]
    return solver, [sorted(str(atom) for atom in answer) for answer in results[-1].answers]


@pytest.mark.parametrize(
    ("value", "found"), [("a", []), ("b", ["bad(b,1)"]), ("stuck(b)", ["bad(stuck(b),1)"]), ("7", ["bad(7,1)"])]
)
@pytest.mark.parametrize("order", ["{0} {1}", "{1} {0}"])
def test_success_is_the_parameter_and_anything_else_a_reason(value, found, order):
    items = order.format(":- not _action_lib(go,a,1).", f"_return(go,{value},1).")
    assert answers(f"#step 2. {items} #endstep.")[1] == [found]


@pytest.mark.parametrize(
    ("text", "read"),
    [
        ("_seen(a,b,1). :- not _action_lib(go,a,1).", None),
        (":- not _action_lib(go,a,1). _return(go,a,1).", None),
        ("_return(go,b,1) :- _seen(b,b,1).", None),
        ("#volatile. _return(go,b,1).", None),
        (":- not _seen(go,b,1). _return(go,b,1).", ":- not _seen(go,b,1). _return(go,b,1). _failed(go,b,1)."),
        (
            "#over 1. :- not _action_lib(go,a,1). _seen(a,b,1). _return(go,b,1). _return(go,b,1) :- _seen(a,b,1).",
            "#over 1. :- not _action_lib(go,a,1). _seen(a,b,1). _return(go,b,1). _failed(go,b,1)."
            "_return(go,b,1) :- _seen(a,b,1).",
        ),
    ],
)
def test_a_failure_comes_behind_its_return_and_all_else_stays(text, read):
    reader = Reader(ReactiveProgram.from_text(PROGRAM), False)
    found = reader.read(parse_update(f"#step 2 : 5. {text} #endstep."), ())
    assert found == parse_update(f"#step 2 : 5. {read or text} #endstep.")


def test_of_facts_the_returns_have_failures():
    facts = frozenset(map(parse_atom, ["_return(go,b,1)", "_seen(a,b,1)", "_return(go,b)"]))
    assert with_their_failures(facts) == facts | {parse_atom("_failed(go,b,1)")}


def test_what_was_committed_before_counts():
    commitment = "#step 2. :- not _action_lib(go,a,1). #endstep."
    assert answers(commitment, "#step 3. _return(go,a,1). #endstep.")[1] == [[]]
    assert answers(commitment, "#step 3. _return(go,b,1). #endstep.")[1] == [["bad(b,1)"]]


def test_without_a_commitment_the_program_tells():
    _, found = answers("#step 1. _return(go,a,1). #endstep.", models=0)
    assert sorted(found) == [[], ["bad(a,1)"]]


def test_a_program_that_declares_none_is_told_none():
    text = PROGRAM.replace("#external _failed/3.", "")
    assert answers("#step 2. :- not _action_lib(go,a,1). _return(go,b,1). #endstep.", program=text)[1] == [[]]


def test_without_the_return_there_was_no_failure():
    solver, found = answers("#step 2. :- not _action_lib(go,a,1). _return(go,b,1). #endstep.")
    assert found == [["bad(b,1)"]]
    log = solver.log.without(frozenset([parse_atom("_return(go,b,1)")]))
    solver.restore(log)
    assert solver.solve().answers == (frozenset(),)
