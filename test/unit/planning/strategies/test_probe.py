"""Probes: whether there is an answer without some facts, compared with a solver that never receives them."""

from itertools import combinations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stream_play import planner_of, play

from rosoclingo.oclingo import SolveOutcome, SolverError, commitment, fact, parse_atom, parse_update
from rosoclingo.oclingo.progression.updates import CloseCycles, StreamUpdate
from rosoclingo.oclingo.solving.clasp_search import ClaspSearch
from rosoclingo.planning.grounding import Grounding
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


def atoms(text):
    return frozenset(map(parse_atom, text.split()))


def probe(solver, text, assumable, disabled="", **stops):
    """Return the verdict on an update, with assumable and disabled facts given as text."""
    found = solver.inquire(parse_update(f"{text} #endstep."), atoms(assumable), atoms(disabled), **stops)
    return Reply(found.satisfiable, core=found.core)


def verdicts(solver, text, assumable):
    """Return whether there is an answer with the assumable facts, and without them."""
    return [probe(solver, text, assumable, disabled).satisfiable for disabled in ("", assumable)]


def test_probe_sees_updates_since_the_last_probe():
    solver = planner_of(BOLT)
    assert probe(solver, "#step 2 : 3. bolt(a).", "bolt(a)").satisfiable
    play(solver, "#step 1 : 3. knock(d).")
    for disabled in ("", "bolt(a)"):
        assert probe(solver, "#step 2 : 3. bolt(a).", "bolt(a)", disabled) == Reply(False), "the core is empty"


def test_probe_respects_the_bound_of_its_update():
    solver = planner_of(FAR)
    found = [probe(solver, f"#step 1 : {bound}. go.", "go").satisfiable for bound in (148, 149, 148)]
    assert found == [False, True, False]
    assert probe(solver, "#step 1 : 148. go.", "go", "go").satisfiable


def test_probe_finds_answers_that_later_steps_exclude():
    """From step 3 on each answer requires seen(a); seen(b) and seen(c) exclude shorter ones."""
    solver = planner_of(
        "#external seen/1. #program cumulative(t). :- t > 2, not seen(a). "
        "#program volatile(t). :- t < 2, seen(b). :- t < 4, seen(c)."
    )

    def without(disabled):
        text = "#step 1 : 6. seen(a). seen(b). seen(c)."
        return probe(solver, text, "seen(a) seen(b) seen(c)", disabled)

    found = without("seen(a)")
    assert not found.satisfiable
    assert found.core >= atoms("seen(a) seen(c)")
    assert all(without(one).satisfiable for one in ("", "seen(a) seen(c)", "seen(a) seen(b) seen(c)"))


@pytest.mark.parametrize(
    ("rules", "asks"),
    [
        ("#cumulative t. c(t).", ":- go, not c(9)."),
        ("#cumulative t. #external e(t). e(t-1) :- t = 3. :- t = 2, go, not e(t).", ""),
        ("#cumulative t. { _action_lib(a,b,t+1) }. :- t = 2, go, not _action_lib(a,b,t+1).", ""),
    ],
)
def test_probe_grounds_steps_that_declare_mentioned_atoms(rules, asks):
    assert verdicts(planner_of("#external go/0. " + rules), f"#step 2 : 20. go. {asks}", "go") == [True, True]


def test_probe_assumes_asserted_facts_until_their_retraction():
    solver = planner_of(BOLT)
    play(solver, "#step 1 : 3. #assert : a. knock(d).")
    assert verdicts(solver, "#step 2 : 3.", "knock(d)") == [False, True]
    assert verdicts(solver, "#step 2 : 3. #retract : a.", "knock(d)") == [True, True]


@pytest.mark.usefixtures("compacts_at_once")
def test_probe_assumes_facts_of_compacted_steps():
    text = "#program cumulative(t). #external seal(t). bad(t) :- seal(t-1), t = 5. bad(t) :- bad(t-1). "
    solver = planner_of(text + "#program volatile(t). :- bad(t), t > 7.")
    play(solver, "#step 1 : 1.")
    for step in range(2, 8):
        play(solver, f"#step {step} : 0. seal({step}). #over {min(step - 1, 5)}.")
    assert parse_atom("seal(4)") in solver.snapshot.past.facts
    assert verdicts(solver, "#step 8 : 0. seal(8).", "seal(4)") == [False, True]


# ---- Stops and errors ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("looks", [0, 4])
def test_stopped_probe_is_unknown_and_can_be_repeated(looks):
    solver, asked = planner_of(FAR), []
    verdict = probe(solver, "#step 1 : 100. go.", "go", stopped=lambda: asked.append(1) or len(asked) > looks)
    assert verdict == UNKNOWN
    assert probe(solver, "#step 1 : 100. go.", "go") == Reply(False, core=atoms("go"))


def test_probe_regrounds_after_an_error(monkeypatch):
    def fail(*_arguments, **_limits):
        raise RuntimeError("too large")

    solver = planner_of(BOLT, horizon_limit=9)
    solver.solve()
    with pytest.raises(SolverError, match="beyond the horizon limit"):
        probe(solver, "#step 10.", "")
    with monkeypatch.context() as patched:
        patched.setattr(ClaspSearch, "run", fail)
        with pytest.raises(SolverError, match="too large"):
            probe(solver, "#step 5 : 5. knock(d).", "knock(d)")
    assert probe(solver, "#step 5 : 5. knock(d).", "knock(d)") == Reply(False, core=atoms("knock(d)"))


# ---- Work ------------------------------------------------------------------------------------------------------------


@pytest.fixture
def work(monkeypatch):
    """Record work as text: + for a new grounding, >7 for growing to step 7, 1..5 for a search."""
    done = []

    def note(name, text_of):
        method = getattr(Grounding, name)

        def noted(grounding, *arguments, **named):
            done.append(text_of(*arguments))
            return method(grounding, *arguments, **named)

        monkeypatch.setattr(Grounding, name, noted)

    note("__init__", lambda *_arguments: "+")
    note("grow_to", ">{}".format)
    note("ask", lambda question, _stopped: f"{question.first}..{question.last}")
    return done


def test_probes_of_one_update_share_a_grounding(work):
    solver, text = planner_of(BOLT), "#step 2 : 3. bolt(a). bolt(b). knock(c)."
    play(solver, "#step 1 : 3.")
    work.clear()
    for disabled in ("", "bolt(a)", "bolt(b) knock(c)"):
        probe(solver, text, "bolt(a) bolt(b) knock(c)", disabled)
    assert work.count("+") == 1
    probe(solver, text, "bolt(b)")
    assert work.count("+") == 2


def test_probe_doubles_the_steps_until_a_stop(work):
    assert not probe(planner_of(FAR), "#step 1 : 139. go.", "go").satisfiable
    assert " ".join(work[-10:]) == "1..1 >33 1..33 >66 1..66 >130 >132 1..132 >140 1..140"
    work.clear()
    stopped = probe(planner_of(FAR), "#step 1 : 139. go.", "go", stopped=lambda: ">66" in work)
    assert (stopped.satisfiable, work[-1]) == (None, ">66")


def test_probe_grounds_no_useless_further_steps(work):
    assert not probe(planner_of(BOLT), "#step 1 : 300. bolt(a). bolt(b).", "bolt(a)").satisfiable
    assert work[-1] == "1..1"
