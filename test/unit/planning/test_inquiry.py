"""What would be, had some facts not been told: as a solver says that was never told of them, on random programs."""

from itertools import combinations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rosoclingo.oclingo import (
    ReactiveProgram,
    SolveOutcome,
    SolverError,
    commitment,
    fact,
    parse_atom,
    parse_update,
)
from rosoclingo.oclingo.progression.updates import Closed, StreamUpdate
from rosoclingo.oclingo.solving.clasp_search import ClaspSearch
from rosoclingo.planning import solver as solver_module
from rosoclingo.planning.grounding import Grounding
from rosoclingo.planning.history import Taken
from rosoclingo.planning.solver import PlanSolver

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


def some(things, most):
    return st.lists(st.sampled_from(things), max_size=most, unique=True).map("\n".join)


@st.composite
def streams(draw):
    """A program, updates, the last of which is asked about, and facts in doubt."""
    text = PROGRAM.format(
        base=draw(some(BASE, 2)), cumulative=draw(some(CUMULATIVE, 3)), volatile=draw(some(VOLATILE, 2))
    )
    updates, told = [], []
    for step in range(1, draw(st.integers(2, 4))):
        facts = draw(st.lists(FACTS, max_size=3, unique=True))
        done = draw(st.sampled_from(["", "x", "y"])) if step > 1 else ""
        if done:
            action = f"_action_lib(go,{done},{step - 1})"
            end = draw(st.sampled_from([done, "jammed"]))
            facts = [*facts, f"_return(go,{end},{step - 1})"]
        atoms = [parse_atom(one) for one in facts]
        commits = [commitment(parse_atom(action))] if done else []
        past = [Closed(step - 1, step - 1)] if step > 1 else []
        updates.append(StreamUpdate(step, draw(st.integers(1, 5)), (*past, *commits, *map(fact, atoms))))
        told += [*atoms, *(one.body[0].atom for one in commits)]
    told = list(dict.fromkeys(told))
    doubted = draw(st.lists(st.sampled_from(told), max_size=3, unique=True)) if told else []
    return text, updates, frozenset(doubted)


def solver_of(text):
    return PlanSolver(ReactiveProgram.from_text(text))


def afresh(solver, text, update, untold):
    """The outcome on a solver that was never told of what is ``untold``."""
    fresh = solver_of(text)
    entries = solver.log.entries
    log = fresh.log.then(*(Taken(one.update.less(untold), one.horizon) for one in entries))
    fresh.restore(log.without(untold))
    return fresh.update(update.less(untold)).outcome is SolveOutcome.SATISFIABLE


def subsets(things):
    return [frozenset(some) for size in range(len(things) + 1) for some in combinations(sorted(things), size)]


@pytest.mark.slow
@settings(max_examples=settings.default.max_examples * 2 // 5)
@given(streams())
def test_as_if_never_told(stream):
    text, updates, doubted = stream
    solver = solver_of(text)
    try:
        for update in updates[:-1]:
            solver.update(update)
        truth = {untold: afresh(solver, text, updates[-1], untold) for untold in subsets(doubted)}
    except SolverError:
        return
    before = solver.log
    for untold, answers in truth.items():
        verdict = solver.inquire(updates[-1], doubted, untold)
        assert verdict.satisfiable is answers, (text, [str(one) for one in updates], sorted(untold))
        assert verdict.core <= doubted
        if not answers:
            agreeing = [other for other in truth if other & verdict.core == untold & verdict.core]
            assert not any(truth[other] for other in agreeing), (text, updates, untold, verdict)
    assert solver.log is before


FAR = "#external go/0. #program cumulative(t). #program volatile(t). :- t < 150, go."
BOLT = "#external bolt/1. #external knock/1. #program base. :- bolt(a), bolt(b), not knock(c). :- knock(d)."


def test_one_grounding_for_all_questions(monkeypatch):
    solver, made = solver_of(BOLT), []
    solver.update(parse_update("#step 1 : 3. #end step."))
    make = Grounding.__init__
    monkeypatch.setattr(Grounding, "__init__", lambda *parts, **named: made.append(1) or make(*parts, **named))
    update = parse_update("#step 2 : 3. bolt(a). bolt(b). knock(c). knock(d). #end step.")
    doubted = frozenset(one.head for _, one in update.sections())
    assert all(solver.inquire(update, doubted, untold).satisfiable is not None for untold in subsets(doubted))
    assert len(made) == 1
    solver.inquire(update, doubted - {parse_atom("bolt(a)")}, frozenset())
    assert len(made) == 2


@pytest.mark.parametrize(
    ("untold", "core"),
    [("", "knock(d)"), ("knock(d) knock(c)", "bolt(a) bolt(b) knock(c)"), ("knock(d) bolt(a) knock(c)", None)],
)
def test_why_there_is_no_answer(untold, core):
    solver = solver_of(BOLT)
    update = parse_update("#step 1 : 9. bolt(a). bolt(b). knock(c). knock(d). #end step.")
    doubted = frozenset(one.head for _, one in update.sections())
    verdict = solver.inquire(update, doubted, frozenset(map(parse_atom, untold.split())))
    assert verdict.satisfiable is (core is None)
    assert verdict.core >= frozenset(map(parse_atom, (core or "").split()))


def test_as_many_steps_as_the_question_allows():
    solver = solver_of("#external go/0. #program cumulative(t). #program volatile(t). :- t < 50, go.")
    go = frozenset([parse_atom("go")])
    short, long = (parse_update(f"#step 1 : {bound}. go. #end step.") for bound in (48, 49))
    assert [solver.inquire(one, go, frozenset()).satisfiable for one in (short, long, short)] == [False, True, False]
    assert solver.inquire(short, go, go).satisfiable


def test_a_stop():
    solver, go = solver_of(FAR), frozenset([parse_atom("go")])
    update, asked = parse_update("#step 1 : 100. go. #end step."), []
    assert solver.inquire(update, go, frozenset(), lambda: True).satisfiable is None
    assert solver.inquire(update, go, frozenset(), lambda: asked.append(1) or len(asked) > 4).satisfiable is None
    assert solver.inquire(update, go, frozenset()) == (False, go)


def test_a_stop_while_the_update_is_taken():
    solver, shut = solver_of(BOLT), frozenset([parse_atom("knock(d)")])
    update = parse_update("#step 5 : 5. knock(d). #end step.")
    assert solver.inquire(update, shut, frozenset(), lambda: True) == (None, frozenset())
    assert solver.inquire(update, shut, frozenset()) == (False, shut)


@pytest.fixture
def work(monkeypatch):
    """What is ground and searched, as text: >7 for steps up to 7, 1..5 for a search."""
    done, grow_to, ask = [], Grounding.grow_to, Grounding.ask

    def grow(grounding, last):
        done.append(f">{last}")
        grow_to(grounding, last)

    def asked(grounding, question, stopped):
        done.append(f"{question.first}..{question.last}")
        return ask(grounding, question, stopped)

    monkeypatch.setattr(Grounding, "grow_to", grow)
    monkeypatch.setattr(Grounding, "ask", asked)
    return done


def test_each_search_has_twice_as_many_steps(work):
    solver, go = solver_of(FAR), frozenset([parse_atom("go")])
    assert solver.inquire(parse_update("#step 1 : 139. go. #end step."), go, frozenset()) == (False, go)
    assert " ".join(work[-9:]) == "1..1 >33 1..33 >66 1..66 >132 1..132 >140 1..140"


def test_nothing_more_is_ground_after_a_stop(work):
    solver, go = solver_of(FAR), frozenset([parse_atom("go")])
    update = parse_update("#step 1 : 139. go. #end step.")
    assert solver.inquire(update, go, frozenset(), lambda: ">66" in work).satisfiable is None
    assert work[-1] == ">66"


def test_what_was_told_since_counts():
    solver, bolt = solver_of(BOLT), frozenset([parse_atom("bolt(a)")])
    update = parse_update("#step 2 : 3. bolt(a). #end step.")
    assert solver.inquire(update, bolt, frozenset()).satisfiable
    solver.update(parse_update("#step 1 : 3. knock(d). #end step."))
    assert solver.inquire(update, bolt, frozenset()) == (False, frozenset())


def test_what_is_not_in_doubt_may_leave_no_answer():
    solver, bolt = solver_of(BOLT), frozenset([parse_atom("bolt(a)")])
    update = parse_update("#step 1 : 3. bolt(a). knock(d). #end step.")
    assert solver.inquire(update, bolt, bolt) == (False, frozenset())


#: From the third step on there is no answer without told(a), before it none with told(b) or told(c).
SHORT_LIVED = """
#external told/1.
#program cumulative(t).
:- t > 2, not told(a).
#program volatile(t).
:- t < 2, told(b).
:- t < 4, told(c).
"""


def test_answers_that_further_steps_would_end_are_found():
    solver = solver_of(SHORT_LIVED)
    told = {name: parse_atom(f"told({name})") for name in "abc"}
    update, doubted = parse_update("#step 1 : 6. told(a). told(b). told(c). #end step."), frozenset(told.values())
    assert solver.inquire(update, doubted, frozenset()).satisfiable
    refused = solver.inquire(update, doubted, frozenset([told["a"]]))
    assert not refused.satisfiable
    assert {told["a"], told["c"]} <= refused.core
    assert solver.inquire(update, doubted, frozenset([told["a"], told["c"]])).satisfiable
    assert solver.inquire(update, doubted, frozenset([told["a"], told["b"], told["c"]])).satisfiable


def test_an_update_beyond_the_limit():
    solver = PlanSolver(ReactiveProgram.from_text(BOLT), horizon_limit=3)
    with pytest.raises(SolverError, match="beyond the horizon limit"):
        solver.inquire(parse_update("#step 4. #end step."), frozenset(), frozenset())


def test_an_interrupt_ends_no_later_question():
    solver, go = solver_of(FAR), frozenset([parse_atom("go")])
    solver.interrupt()
    assert solver.inquire(parse_update("#step 1 : 100. go. #end step."), go, frozenset()) == (False, go)


def test_what_fails_is_told_and_asked_anew(monkeypatch):
    solver, shut = solver_of(BOLT), frozenset([parse_atom("knock(d)")])
    update = parse_update("#step 5 : 5. knock(d). #end step.")

    def fail(*_arguments, **_limits):
        raise RuntimeError("too large")

    solver.solve()
    with monkeypatch.context() as patched:
        patched.setattr(ClaspSearch, "run", fail)
        with pytest.raises(SolverError, match="too large"):
            solver.inquire(update, shut, frozenset())
    assert solver.inquire(update, shut, frozenset()) == (False, shut)


def test_a_retired_step_told_it(monkeypatch):
    monkeypatch.setattr(solver_module, "MOST_STEPS", 4)
    text = "#program cumulative(t). #external seal(t). bad(t) :- seal(t-1), t = 5. bad(t) :- bad(t-1). "
    text += "#program volatile(t). :- bad(t), t > 7."
    solver = solver_of(text)
    solver.update(parse_update("#step 1 : 1. #end step."))
    for step in range(2, 8):
        solver.update(parse_update(f"#step {step} : 0. seal({step}). #over {step - 1}. #end step."))
    seal = parse_atom("seal(4)")
    assert solver.snapshot.past is not None
    assert seal in solver.snapshot.past.facts
    update, doubted = StreamUpdate(8, 0, (fact(parse_atom("seal(8)")),)), frozenset([seal])
    assert not solver.inquire(update, doubted, frozenset()).satisfiable
    assert solver.inquire(update, doubted, doubted).satisfiable


def test_atoms_that_are_defined_at_each_step_may_be_in_doubt():
    """As facts they are defined again by the rules of each step, which clingo allows for facts alone."""
    text = "#external shut/1. #program cumulative(t). { in(t) }. bar :- shut(a). :- in(t), bar. "
    solver = solver_of(text + "#program volatile(t). :- not in(t), t < 90.")
    shut = frozenset([parse_atom("shut(a)")])
    update = parse_update("#step 1 : 50. shut(a). #end step.")
    assert solver.inquire(update, shut, shut).satisfiable
    assert solver.inquire(update, shut, frozenset()) == (False, shut)
    assert solver.inquire(update, shut, shut).satisfiable


WALK = """
#external _return/3. #external _failed/3.
#program cumulative(t).
{ _action_lib(go,x,t) }.
been(t) :- _action_lib(go,x,t).
been(t) :- been(t-1).
"""


@pytest.mark.parametrize("cycles", [(1,), (1, 2)])
def test_an_action_in_doubt_was_executed_or_is_in_no_plan(cycles):
    solver = solver_of(WALK + "#program volatile(t). :- not _action_lib(go,x,1), t > 1.")
    updates = [
        parse_update(f"#step {one + 1} : 3. #closed {one}. :- not _action_lib(go,x,{one}). #end step.")
        for one in cycles
    ]
    for update in updates[:-1]:
        solver.update(update)
    action = frozenset([parse_atom("_action_lib(go,x,1)")])
    assert solver.inquire(updates[-1], action, frozenset()).satisfiable
    assert solver.inquire(updates[-1], action, action) == (False, action)


def test_what_failed_did_not_where_its_return_is_untold():
    solver = solver_of(WALK + "failed(t) :- _failed(A,R,t). #program volatile(t). :- failed(1).")
    update = parse_update("#step 2 : 3. :- not _action_lib(go,x,1). _return(go,jam,1). #end step.")
    jam = frozenset([parse_atom("_return(go,jam,1)")])
    assert solver.inquire(update, jam, frozenset()) == (False, jam)
    assert solver.inquire(update, jam, jam).satisfiable


def test_what_will_lapse_may_be_in_doubt():
    solver = solver_of(BOLT)
    knock = frozenset([parse_atom("knock(d)")])
    solver.update(parse_update("#step 1 : 3. #assert : a. knock(d). #end step."))
    again = parse_update("#step 2 : 3. #end step.")
    assert [solver.inquire(again, knock, untold).satisfiable for untold in (frozenset(), knock)] == [False, True]
    over = parse_update("#step 2 : 3. #retract : a. #end step.")
    assert [solver.inquire(over, knock, untold).satisfiable for untold in (frozenset(), knock)] == [True, True]


def test_a_reason_that_no_horizon_mends_needs_no_further_steps(work):
    solver, bolt = solver_of(BOLT), frozenset([parse_atom("bolt(a)")])
    update = parse_update("#step 1 : 300. bolt(a). bolt(b). #end step.")
    assert solver.inquire(update, bolt, frozenset()) == (False, bolt)
    assert work[-1] == "1..1"


@pytest.mark.parametrize(
    "rules",
    [
        "#external go/0. #cumulative t. c(t).",  # a constraint of the update asks for c(9)
        "#external go/0. #cumulative t. #external e(t). e(t-1) :- t = 3. :- t = 2, go, not e(t).",
        "#external go/0. #cumulative t. { _action_lib(a,b,t+1) }. :- t = 2, go, not _action_lib(a,b,t+1).",
    ],
)
def test_what_only_further_steps_bring_is_waited_for(rules):
    solver, go = solver_of(rules), frozenset([parse_atom("go")])
    asks = ":- go, not c(9)." if "c(t)" in rules else ""
    update = parse_update(f"#step 2 : 20. go. {asks} #end step.")
    assert solver.inquire(update, go, frozenset()).satisfiable
    assert solver.inquire(update, go, go).satisfiable


def test_steps_that_are_refuted_are_asked_for_once(work):
    assert solver_of(FAR).update(parse_update("#step 1 : 16. go. #end step.")).outcome is SolveOutcome.UNSATISFIABLE
    assert " ".join(work[-5:]) == "1..1 >9 2..9 >17 10..17"
