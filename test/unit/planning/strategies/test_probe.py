"""Probes: whether there is an answer without some facts, compared with a solver that never receives them."""

from itertools import combinations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stream_play import planner_of, play, stop_after

from rosoclingo.oclingo import SolveOutcome, SolverError, commitment, fact, parse_atom, parse_update
from rosoclingo.oclingo.progression.updates import CloseCycles, StreamUpdate
from rosoclingo.oclingo.solving.clasp_search import ClaspSearch
from rosoclingo.planning.history import AcceptedUpdate
from rosoclingo.planning.question import UNKNOWN, Reply

# ---- On random streams -----------------------------------------------------------------------------------------------

PROGRAM = """
#external _request/2. #external _return/3. #external _failed/3. #external shut/1.
#program base.
{base}
#program cumulative(t).
#external off(t).
{{ _action_lib(go,(x;y),t) }} 1.
failed(A,t) :- _failed(A,R,t), not _action_lib(A,R,t).
been(P,t) :- _action_lib(go,P,t), not failed(go,t).
been(P,t) :- been(P,t-1).
want(P,t) :- _request(P,t).
want(P,t) :- want(P,t-1), not _request(cancel(P),t).
{cumulative}
#program volatile(t).
:- want(P,t), not been(P,t).
{volatile}
"""

BASE = ["wall(P) :- shut(P), not shut(z).", ":- shut(x), shut(y).", "wall(z)."]
CUMULATIVE = [
    ":- _action_lib(go,P,t), shut(P).",
    ":- _action_lib(go,P,t), failed(go,t-1).",
    ":- been(x,t), been(y,t).",
    ":- been(x,t), not want(x,t), t > 2.",
    ":- _action_lib(go,P,t), off(t-1).",
    ":- off(t), not _action_lib(go,x,t-1), t > 1.",
    "wall(P) :- shut(P), _request(P,t).",
    "barred(P) :- shut(P).\n:- barred(P), _action_lib(go,P,t).",
    ":- not _action_lib(go,x,t), not _action_lib(go,y,t).",
]
VOLATILE = [":- t < 4, want(P,t).", ":- off(t).", ":- not shut(x), want(x,t).", ":- not been(x,t)."]
PLACES = st.sampled_from(["x", "y"])
STEPS = st.integers(1, 4)
FACTS = st.one_of(
    st.builds("_request({},{})".format, PLACES, STEPS),
    st.builds("_request(cancel({}),{})".format, PLACES, STEPS),
    st.builds("shut({})".format, st.sampled_from(["x", "y", "z"])),
    st.builds("off({})".format, STEPS),
)


def some(rules, most):
    return st.lists(st.sampled_from(rules), max_size=most, unique=True).map("\n".join)


@st.composite
def streams(draw):
    """Draw a program, updates (the last one is probed) and assumable facts."""
    text = PROGRAM.format(
        base=draw(some(BASE, 2)), cumulative=draw(some(CUMULATIVE, 3)), volatile=draw(some(VOLATILE, 2))
    )
    updates, facts = [], []
    for step in range(1, draw(st.integers(2, 4))):
        texts = draw(st.lists(FACTS, max_size=3, unique=True))
        past, done = [], draw(st.sampled_from(["", "x", "y"])) if step > 1 else ""
        if step > 1:
            past.append(CloseCycles(step - 1, step - 1))
        if done:
            texts.append(f"_return(go,{draw(st.sampled_from([done, 'jammed']))},{step - 1})")
            facts.append(parse_atom(f"_action_lib(go,{done},{step - 1})"))
            past.append(commitment(facts[-1]))
        atoms = list(map(parse_atom, texts))
        updates.append(StreamUpdate(step, draw(st.integers(1, 5)), (*past, *map(fact, atoms))))
        facts += atoms
    facts = list(dict.fromkeys(facts))
    assumable = draw(st.lists(st.sampled_from(facts), max_size=3, unique=True)) if facts else []
    return text, updates, frozenset(assumable)


def without(solver, text, update, disabled):
    """Return whether a solver that never received the ``disabled`` facts has an answer."""
    fresh, entries = planner_of(text), [one for one in solver.log.entries if isinstance(one, AcceptedUpdate)]
    fresh.restore(
        fresh.log.with_entries(*(AcceptedUpdate(one.update.without_facts(disabled), one.horizon) for one in entries))
    )
    return fresh.update(update.without_facts(disabled)).outcome is SolveOutcome.SATISFIABLE


def subsets(things):
    return [frozenset(some) for size in range(len(things) + 1) for some in combinations(sorted(things), size)]


@pytest.mark.slow
@settings(max_examples=settings.default.max_examples * 2 // 5)
@given(streams())
def test_probe_agrees_with_a_solver_without_the_facts(stream):
    text, updates, assumable = stream
    solver = planner_of(text)
    try:
        for update in updates[:-1]:
            solver.update(update)
        truth = {disabled: without(solver, text, updates[-1], disabled) for disabled in subsets(assumable)}
    except SolverError:
        return
    before = solver.log
    for disabled, answers in truth.items():
        verdict = solver.inquire(updates[-1], assumable, disabled)
        assert verdict.satisfiable is answers, (text, [str(one) for one in updates], sorted(disabled))
        assert verdict.core <= assumable
        if not answers:
            agreeing = [other for other in truth if other & verdict.core == disabled & verdict.core]
            assert not any(truth[other] for other in agreeing), (text, updates, disabled, verdict)
    assert solver.log is before


# ---- Verdicts --------------------------------------------------------------------------------------------------------

FAR = "#external go/0. #program cumulative(t). #program volatile(t). :- t < 150, go."
BOLT = "#external bolt/1. #external knock/1. #program base. :- bolt(a), bolt(b), not knock(c). :- knock(d)."


def probe(solver, text, stopped=None):
    """Return the verdict on "UPDATE ? FACTS"; disabled facts begin with a minus sign."""
    update, facts = f"{text} ".split(" ? ")
    assumable = frozenset(parse_atom(one.lstrip("-")) for one in facts.split())
    disabled = frozenset(parse_atom(one[1:]) for one in facts.split() if one[0] == "-")
    found = solver.inquire(parse_update(f"{update} #endstep."), assumable, disabled, stopped)
    return Reply(found.satisfiable, core=found.core)


def atoms(text):
    return frozenset(map(parse_atom, text.split()))


STREAMS = {
    "updates since the last probe": (
        BOLT,
        "#step 2 : 3. bolt(a). ? bolt(a) -> yes",
        "#step 1 : 3. knock(d).",
        "#step 2 : 3. bolt(a). ? bolt(a) -> no",
        "#step 2 : 3. bolt(a). ? -bolt(a) -> no",
    ),
    "the bound of the update": (
        FAR,
        "#step 1 : 148. go. ? go -> no go",
        "#step 1 : 149. go. ? go -> yes",
        "#step 1 : 148. go. ? go -> no go",
        "#step 1 : 148. go. ? -go -> yes",
    ),
}


@pytest.mark.parametrize("name", STREAMS)
def test_probe_has_these_verdicts(name):
    """A verdict is followed by facts of its unsat core."""
    text, *lines = STREAMS[name]
    solver = planner_of(text)
    for line in lines:
        question, _, verdict = line.partition(" -> ")
        if not verdict:
            play(solver, line)
            continue
        found, core = probe(solver, question), atoms(verdict.partition(" ")[2])
        assert (found.satisfiable, bool(found.core)) == (verdict == "yes", bool(core)), line
        assert found.core >= core, line


@pytest.mark.usefixtures("compacts_at_once")
def test_probe_assumes_facts_of_compacted_steps():
    text = "#program cumulative(t). #external seal(t). bad(t) :- seal(t-1), t = 5. bad(t) :- bad(t-1). "
    solver = planner_of(text + "#program volatile(t). :- bad(t), t > 7.")
    play(solver, "#step 1 : 1.")
    for step in range(2, 8):
        play(solver, f"#step {step} : 0. seal({step}). #over {min(step - 1, 5)}.")
    assert parse_atom("seal(4)") in solver.snapshot.past.facts
    verdicts = [probe(solver, f"#step 8 : 0. seal(8). ? {fact}").satisfiable for fact in ("seal(4)", "-seal(4)")]
    assert verdicts == [False, True]


# ---- Stops, errors and work ------------------------------------------------------------------------------------------


def test_stopped_probe_is_unknown_and_can_be_repeated():
    solver = planner_of(FAR)
    assert probe(solver, "#step 1 : 100. go. ? go", stop_after(4)) == UNKNOWN
    assert probe(solver, "#step 1 : 100. go. ? go") == Reply(False, core=atoms("go"))


def test_probe_regrounds_after_an_error(monkeypatch):
    def fail(*_arguments, **_limits):
        raise RuntimeError("too large")

    solver = planner_of(BOLT, horizon_limit=9)
    solver.solve()
    with pytest.raises(SolverError, match="beyond the horizon limit"):
        probe(solver, "#step 10. ? ")
    with monkeypatch.context() as patched:
        patched.setattr(ClaspSearch, "run", fail)
        with pytest.raises(SolverError, match="too large"):
            probe(solver, "#step 5 : 5. knock(d). ? knock(d)")
    assert probe(solver, "#step 5 : 5. knock(d). ? knock(d)") == Reply(False, core=atoms("knock(d)"))
