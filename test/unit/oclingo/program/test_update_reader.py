"""The update reader: it adds ``_failed(A,V,C)`` to each return that differs from the parameter of its action."""

import pytest
from stream_play import atoms, planner_of, play

from rosoclingo.oclingo import ReactiveProgram, parse_atom, parse_update
from rosoclingo.oclingo.program.update_reader import with_failures, with_their_failures

PROGRAM = """
#program cumulative(t).
#external _return/3.
#external _failed/3.
1 { _action_lib(go,(a;b),t) } 1.
bad(V,t) :- _failed(go,V,t), not _action_lib(go,V,t).
#show bad/2.
"""
DONE = ":- not _action_lib(go,a,1)."


@pytest.mark.parametrize(
    ("value", "found"), [("a", []), ("b", ["bad(b,1)"]), ("stuck(b)", ["bad(stuck(b),1)"]), ("7", ["bad(7,1)"])]
)
@pytest.mark.parametrize("order", ["#step 2. {0} {1}", "#step 2. {1} {0}"])
def test_reader_treats_the_parameter_as_success(value, found, order):
    solver = planner_of(PROGRAM)
    assert atoms(play(solver, order.format(DONE, f"_return(go,{value},1)."))) == found
    solver = planner_of(PROGRAM)
    play(solver, f"#step 2. {DONE}")
    assert atoms(play(solver, f"#step 3. _return(go,{value},1).")) == found, "the commitment was in an earlier update"


@pytest.mark.parametrize(
    ("text", "read"),
    [
        (f"_seen(a,b,1). {DONE}", None),
        (f"{DONE} _return(go,a,1).", None),
        ("_return(go,b,1) :- _seen(b,b,1).", None),
        ("#volatile. _return(go,b,1).", None),
        (
            f"#over 1. {DONE} _seen(a,b,1). _return(go,b,1). _return(go,b,1) :- _seen(a,b,1).",
            f"#over 1. {DONE} _seen(a,b,1). _return(go,b,1). _failed(go,b,1). _return(go,b,1) :- _seen(a,b,1).",
        ),
    ],
)
def test_reader_adds_a_failure_after_its_return(text, read):
    found = with_failures(ReactiveProgram.from_text(PROGRAM), parse_update(f"#step 2 : 5. {text} #endstep."), ())
    assert found == parse_update(f"#step 2 : 5. {read or text} #endstep.")


def test_reader_adds_only_declared_failures():
    solver = planner_of(PROGRAM.replace("#external _failed/3.", ""))
    assert atoms(play(solver, f"#step 2. {DONE} _return(go,b,1).")) == []


def test_returns_are_withdrawn_with_their_failures():
    solver = planner_of(PROGRAM)
    assert atoms(play(solver, f"#step 2. {DONE} _return(go,b,1).")) == ["bad(b,1)"]
    assert atoms(play(solver, "#withdraw _return(go,b,1).")) == []
    facts = frozenset(map(parse_atom, ["_return(go,b,1)", "_seen(a,b,1)", "_return(go,b)"]))
    assert with_their_failures(facts) == facts | {parse_atom("_failed(go,b,1)")}
