"""Explanations in a worker process: the same reasons, and a deadline."""

import pytest
from stream_logs import stream_of

from rosoclingo.oclingo import DroppedError, ReactiveProgram, SolverError
from rosoclingo.planning.explaining.explainer import explain
from rosoclingo.planning.workers import explanation, process
from rosoclingo.planning.workers.explanation import explain_in_worker

PROGRAM = ReactiveProgram.from_text(
    "#program cumulative(t).\n#external on(t).\n{ up(t) }.\n:- up(t), on(t-1).\n#program volatile(t).\n:- not up(t).\n",
    "lift.lp",
)
#: Grounding step 2 does not terminate.
EXPLODING = ReactiveProgram.from_text(
    "#cumulative t.\n#external e(t).\nn(0,t) :- t > 1.\nn(X+1,t) :- n(X,t), X < 2000000000.\n#volatile t.\n:- e(1).\n"
)


@pytest.mark.slow
def test_explaining_process_finds_the_same_reasons():
    asked = stream_of("#step 2. on(2).", 1, "#step 1. on(1).")
    found = explain_in_worker(PROGRAM, asked, 300.0)
    here = explain(PROGRAM, asked)
    assert found == (here.text(), here.to_message())
    assert [one.text for one in here.stream_facts] == ["on(1).", "on(2)."]
    assert explain_in_worker(PROGRAM, stream_of("#step 1.", 1), 300.0) is None


def test_explain_blames_facts_together_with_their_actions():
    text = """\
#program base.
p(1..3).
#program cumulative(t).
#external _request/2. #external shut/2.
{ _action_lib(go,P,t) : p(P) } 1 :- _request(go,C), C <= t+1.
at(P,t) :- _action_lib(go,P,t).
:- at(P,t), shut(P,C), C <= t.
#program volatile(t).
:- _request(go,C), not at(3,t).
"""
    before = ["#step 1. _request(go,2)."]
    update = "#step 2. :- not _action_lib(go,1,1). shut(3,1). shut(3,2)."
    found = explain(ReactiveProgram.from_text(text), stream_of(update, 2, *before))
    assert [one.text for one in found.stream_facts] in (["_request(go,2).", f"shut(3,{n})."] for n in (1, 2))


@pytest.mark.slow
def test_explaining_process_ends_at_its_deadline(monkeypatch):
    monkeypatch.setattr(explanation, "PATIENCE", 0.2)
    asked = stream_of("#step 1. e(1).", 3)
    with pytest.raises(DroppedError, match="no explanation was found in 1 s"):
        explain_in_worker(EXPLODING, asked, 1.0)
    with pytest.raises(DroppedError):
        explain_in_worker(EXPLODING, asked, 300.0, lambda: True)


def test_explaining_process_that_cannot_start_raises(monkeypatch):
    def refused(*_arguments, **_more):
        raise OSError("no more processes")

    monkeypatch.setattr(process.os, "posix_spawn", refused)
    with pytest.raises(SolverError, match="no more processes"):
        explain_in_worker(PROGRAM, stream_of("#step 1.", 1), 1.0)
