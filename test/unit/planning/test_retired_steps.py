"""What is kept of retired steps: a stream that retires steps has the answers of one that keeps them."""

import pytest
from stream_play import atoms, planner_of, play

from rosoclingo.oclingo import SolveOutcome
from rosoclingo.planning import compaction, solver

EXTERNALS = "#program cumulative(t). #external e(t). c(t) :- e(t). late(t) :- e(t-2). #program volatile(t)."
SEVERAL = (
    "#program cumulative(t). day(t). #external e(T) : day(T), T > t-3. c(T,t) :- e(T), day(T), T > t-3. "
    "#program volatile(t)."
)
CHOICES = "{ x ; y }. #external door. #external sees/1. #external seen/2. "
IGNORED = "Head {} has not been declared external. The entire rule will be ignored."


@pytest.fixture(autouse=True)
def at_once(compacts_at_once, monkeypatch):
    """Retire at once, and go on showing what was retired."""
    monkeypatch.setattr(compaction, "SHOWN_STEPS", 100)


def stream(text):
    return planner_of(text, models=0)


def with_rules(step):
    """The program with further rules in each step."""
    return CHOICES + EXTERNALS.replace("#program volatile", step + " #program volatile")


def warnings(result):
    """What is said but for the number of a step, which only one of two streams has retired."""
    return [one.split(" ")[1] for one in result.warnings]


def retire(text, *updates, steps=8):
    """Play the updates, one a step, with and without retiring the steps before; compare; return the retiring solver."""
    retiring, forgetting = stream(text), stream(text)
    for step in range(1, steps + 1):
        update = updates[step - 1] if step <= len(updates) else ""
        forgotten = f"#forget 1..{step - 2}. " if step > 2 else ""
        found = play(retiring, f"#step {step} : 0. #over {step - 1}. {update}")
        expected = play(forgetting, f"#step {step} : 0. {forgotten}{update}")
        assert set(found.answers) == set(expected.answers), step
        assert warnings(found) == warnings(expected), step
    return retiring


def first(retiring):
    return None if retiring.snapshot.past is None else retiring.snapshot.past.first


# ---- When steps are over ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("window", "reached"), [("1", 7), ("3", 5)])
def test_steps_whose_volatile_rules_can_hold_are_not_over(window, reached):
    text = f"#cumulative t. p(t). #volatile t : {window}. :- not p(t). #volatile t. :- not p(t)."
    retiring = stream(text)
    for step in range(1, 8):
        play(retiring, f"#step {step}. #over {step}.")
    assert first(retiring) == reached


def test_steps_that_are_over_too_early_are_retired_later():
    retiring = stream(EXTERNALS)
    for step in (1, 2, 3):
        play(retiring, f"#step {step}. #over 2.")
    assert first(retiring) == 2


def test_contradicting_facts_are_not_retired_and_can_be_withdrawn():
    retiring = stream("#cumulative t. #external e(t). p(t) :- e(t). p(t) :- p(t-1). #volatile t. :- p(t).")
    play(retiring, "#step 1.")
    assert play(retiring, "#step 2 : 0. e(2).").outcome is SolveOutcome.UNSATISFIABLE
    for step in (3, 4, 5):
        assert play(retiring, f"#step {step} : 0. #over {step}.").outcome is SolveOutcome.UNSATISFIABLE
    assert play(retiring, "#step 6 : 0. #withdraw e(2).").outcome is SolveOutcome.SATISFIABLE


# ---- Externals -------------------------------------------------------------------------------------------------------


def test_externals_of_base_stay_open():
    retiring = retire("#external door. #program cumulative(t). s(t) :- door, t > 7. #program volatile(t).", steps=7)
    assert first(retiring) == 6
    assert atoms(play(retiring, "#step 8. door.")) == ["door", "s(8)"]


@pytest.mark.parametrize("text", [EXTERNALS, SEVERAL], ids=["of one step", "of several steps"])
def test_externals_of_retired_steps_are_closed(text):
    retiring = retire(text)
    play(retiring, "#step 9 : 0. #over 8.")
    result = play(retiring, "#step 9 : 0. e(7). e(8). e(9).")
    assert (first(retiring), warnings(result)) == (8, ["e(7)"])
    assert {"e(8)", "e(9)"} <= set(atoms(result))


def test_closed_externals_do_not_wait_for_later_steps():
    retiring = stream("#program cumulative(t). #external e(9) : t \\ 4 = 1. c(t) :- e(9). #program volatile(t).")
    for step in (1, 2, 3, 4, 5):
        result = play(retiring, f"#step {step} : 0. #over {step - 1}." + (" e(9)." if step == 4 else ""))
        assert warnings(result) == (["e(9)"] if step == 4 else [])
    assert (first(retiring), atoms(result)) == (4, [])


# ---- Statements ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("step", "updates"),
    [
        ("", ["e(1).", ":- e(1), x."]),
        ("", ["", ":- not e(1), x.", ":- c(2), not x."]),
        ("", ["", ":- not x, not y.", ":- c(2), not x, y."]),
        ("", ["e(1).", "e(2)."]),
        ("", ["p(1).", ":- p(1), x."]),
        ("", ["", "", "seen(a,3) :- c(1), x."]),
        ("", ["", "note :- x.", ":- note."]),
        ("#show c/1.", ["e(1).", "e(2)."]),
        ("_action_lib(go,x,soon(t)) :- e(t), t > 2.", ["", "", "e(3)."]),
        ("_action_lib(go,x,t-2) :- e(t), t > 2.", ["", "", "e(3)."]),
        ("_action_lib(go,x,t+1) :- e(t), t > 2.", ["", "", "e(3)."]),
        ("next(t) :- c(t-1). unless(t) :- not c(t-1).", ["", "e(2)."]),
        ("door :- e(t), t = 1. gate :- e(t), t = 2. #external gate : t = 1.", ["e(1)."]),
        ("d(X,t) :- seen(X,T), T <= t.", ["seen(a,1).", "seen(b,2)."]),
        (":- x, t = 1.", ["", "e(2)."]),
        (":- not x, t = 1.", ["", "e(2)."]),
        (":- x, e(t).", ["", "e(2)."]),
        (":- late(t), 1 { x ; y }.", ["", "e(2)."]),
    ],
)
def test_decided_steps_are_retired_and_answers_stay_the_same(step, updates):
    assert first(retire(with_rules(step), *updates)) == 7


@pytest.mark.parametrize(
    ("step", "updates", "reached"),
    [
        ("", ["e(1) :- x.", ":- c(1)."], None),
        ("", ["e(1) :- x. e(1) :- y.", ":- not c(1)."], None),
        ("", ["", "", "", "", "e(5) :- x. :- not e(5)."], 5),
        ("", ["e(1).", "e(2) :- c(1)."], None),
        ("", ["", "", "e(3) :- not c(2)."], 3),
        ("d(t) :- sees(t).", ["", "sees(6) :- x. :- not sees(6)."], 6),
        ("s(t) :- door, t > 1.", ["", "door :- c(1). door :- x."], 2),
        ("s(t) :- door, t > 6.", ["", "door :- x. door :- c(1).", "sees(6) :- door."], 7),
        ("", ["", ":- c(1). #volatile : 9. e(1) :- x."], None),
        ("", ["", ":- c(1). #volatile : 3. e(1) :- x."], 7),
        ("", ["", ":- c(1). #assert : r. e(1) :- x.", "", "", "#retract : r."], 7),
        ("s(t) :- x.", ["", "#assert : r. :- not x.", "", "", "#retract : r."], None),
        ("s(t) :- x.", ["", "#volatile. :- not x."], None),
    ],
)
def test_rules_of_the_stream_and_statements_that_lapse_keep_steps(step, updates, reached):
    assert first(retire(with_rules(step), *updates)) == reached


@pytest.mark.mostly_slow
@pytest.mark.parametrize(
    ("step", "updates"),
    [
        ("d(t) :- sees(t).", ["", "sees(6) :- x. note :- sees(6). :- note."]),
        ("d(t) :- sees(t).", ["e(1).", "sees(6). sees(6) :- x. e(2) :- sees(6), c(1)."]),
        ("d(t) :- sees(t).", ["", "sees(6) :- c(1). #assert : r. sees(6) :- x. #cumulative. :- sees(6)."]),
        ("s(t) :- door, t > 1. :- not door, t = 3.", ["", "door :- x."]),
        ("s(t) :- door, t > 1. :- door, t = 1.", ["", "door :- c(1). door :- x."]),
        ("s(t) :- door.", ["door :- x.", ":- x."]),
        ("", ["e(1).", "e(2) :- e(1).", "e(3) :- e(2), not c(2)."]),
        ("", ["", ":- c(2), not x, y.", "e(4) :- c(1), not e(2).", ":- x, e(3)."]),
        ("", ["e(1).", "#volatile : 5. :- c(1), x."]),
        ("", ["e(1).", "#assert : r. :- not c(1). e(2).", "#retract : r."]),
        ("", ["#assert : r. e(4).", "", "", "e(4) :- x."]),
        ("", ["e(1) :- fresh.", ":- c(1).", "", "fresh :- x."]),
        ("", ["", "e(2) :- c(1), x.", "#forget 1..2."]),
        ("", [":- new, x. :- other.", "new :- not c(1).", "#forget 1..1."]),
        ("d(t) :- seen(a,t).", ["seen(a,1) :- x.", ":- d(1)."]),
    ],
)
@pytest.mark.parametrize("steps", [1, 4])
def test_answers_stay_the_same_with_any_statements(monkeypatch, step, updates, steps):
    monkeypatch.setattr(solver, "LEAST_STEPS", steps)
    retire(with_rules(step), *updates)


def test_facts_that_a_later_step_declares_again_stay_facts():
    text = "{ x }. #program cumulative(t). day(t). #external e(T) : day(T), T > t-4. #program volatile(t)."
    assert first(retire(text, "", "", "e(3).", "", ":- e(3), x.")) == 7


# ---- What is kept ----------------------------------------------------------------------------------------------------


def test_retired_atoms_are_shown_once_without_those_of_base():
    retiring = retire("a. { x }. :- not x. #external sees/2. s :- sees(y,1). " + EXTERNALS, "e(1). sees(y,1).", "e(2).")
    shown = sorted(str(atom) for _, atom in retiring.snapshot.past.shown)
    assert shown == ["c(1)", "c(2)", "e(1)", "e(2)", "late(3)", "late(4)", "sees(y,1)"]


def test_retired_atoms_are_shown_for_some_steps(monkeypatch):
    monkeypatch.setattr(compaction, "SHOWN_STEPS", 3)
    retiring = stream("#program cumulative(t). p(t). #program volatile(t).")
    for step in range(1, 10):
        shown = atoms(play(retiring, f"#step {step} : 0. #over {step}."))
    assert first(retiring) == 9
    assert shown == [f"p({step})" for step in range(5, 10)]


def test_nothing_is_kept_that_no_later_step_uses():
    snapshot = retire(EXTERNALS, "e(1).", "e(2). :- not c(1).", *[""] * 10, steps=12).snapshot
    assert snapshot.past.first == 11
    assert (snapshot.past.facts, list(snapshot.statements)) == (frozenset(), [])
    assert snapshot.size <= 4


def test_facts_and_actions_of_retired_steps_go_if_no_later_step_asks_for_them():
    stream = planner_of(
        "#external told/1. #external _request/2. #program cumulative(t). { _action_lib(go,(a;b),t) } 1. "
        "wanted(t) :- _request(x,t). #program volatile(t).",
        models=0,
    )
    for step in range(1, 6):
        past = f"#over {step - 1}. #closed {step}."
        play(stream, f"#step {step} : 0. {past} told({step}). {'_request(x,1). _request(x,9).' if step == 1 else ''}")
    snapshot = stream.snapshot
    assert first(stream) == 4
    assert sorted(snapshot.closed) == [3, 4, 5], "the last one before what is ground is told for its returns"
    assert sorted(map(str, snapshot.permanent)) == ["_request(x,9)."]
    shown = {str(atom): step for step, atom in snapshot.past.shown if atom.name == "told"}
    assert shown == {f"told({step})": max(1, step - 2) for step in range(1, 6)}, "as of the last step that is retired"
