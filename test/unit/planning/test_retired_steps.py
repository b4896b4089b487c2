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
IGNORED = "Head {} has not been declared external. The entire rule will be ignored."


@pytest.fixture(autouse=True)
def at_once(compacts_at_once, monkeypatch):
    """Retire at once, and go on showing what was retired."""
    monkeypatch.setattr(compaction, "SHOWN_STEPS", 100)


def stream(text):
    return planner_of(text, models=0)


def warnings(result):
    """What is said but for the number of a step, which only one of two streams has retired."""
    return [one.split(" ")[1] for one in result.warnings]


def retire(text, *updates, steps=7):
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


@pytest.mark.parametrize(("window", "reached"), [("1", 7), ("2", 6), ("3", 5)])
def test_steps_whose_volatile_rules_may_hold_are_not_over(window, reached):
    text = f"#cumulative t. p(t). #volatile t : {window}. :- not p(t). #volatile t. :- not p(t)."
    retiring = stream(text)
    for step in range(1, 8):
        play(retiring, f"#step {step}. #over {step}.")
    assert first(retiring) == reached


def test_steps_that_are_over_too_early_are_retired_later():
    retiring = stream(EXTERNALS)
    for text in ("#step 1. #over 2.", "#step 2.", "#step 3."):
        play(retiring, text)
    assert first(retiring) == 2


def test_contradicting_facts_are_not_retired_and_can_be_withdrawn():
    retiring = stream("#cumulative t. #external e(t). p(t) :- e(t). p(t) :- p(t-1). #volatile t. :- p(t).")
    play(retiring, "#step 1.")
    assert play(retiring, "#step 2 : 0. e(2).").outcome is SolveOutcome.UNSATISFIABLE
    for step in (3, 4, 5):
        assert play(retiring, f"#step {step} : 0. #over {step}.").outcome is SolveOutcome.UNSATISFIABLE
    assert play(retiring, "#step 6 : 0. #withdraw e(2).").outcome is SolveOutcome.SATISFIABLE


def test_externals_of_base_stay_open():
    retiring = stream("#external door. #program cumulative(t). s(t) :- door, t > 6. #program volatile(t).")
    for step in range(1, 7):
        play(retiring, f"#step {step}. #over {step}.")
    assert first(retiring) == 6
    assert atoms(play(retiring, "#step 7. door.")) == ["door", "s(7)"]


def test_externals_of_retired_steps_are_closed():
    retiring = retire(EXTERNALS)
    assert first(retiring) == 6
    play(retiring, "#step 8 : 0. #over 7.")
    result = play(retiring, "#step 8 : 0. e(5). e(6). e(7). e(8).")
    assert (first(retiring), warnings(result)) == (7, ["e(5)", "e(6)"])
    assert atoms(result) == ["c(7)", "c(8)", "e(7)", "e(8)"]


def test_later_steps_do_not_reopen_closed_externals():
    retiring = retire(SEVERAL)
    play(retiring, "#step 8 : 0. #over 7.")
    result = play(retiring, "#step 8 : 0. e(6). e(7).")
    assert first(retiring) == 7
    assert result.warnings == (IGNORED.format("e(6)"),)


def test_closed_externals_do_not_wait_for_later_steps():
    retiring = stream("#program cumulative(t). #external e(9) : t \\ 4 = 1. c(t) :- e(9). #program volatile(t).")
    for step in (1, 2, 3, 4, 5):
        result = play(retiring, f"#step {step} : 0. #over {step - 1}." + (" e(9)." if step == 4 else ""))
        assert warnings(result) == (["e(9)"] if step == 4 else [])
    assert (first(retiring), atoms(result)) == (4, [])


@pytest.mark.parametrize("cycle", ["soon(t)", "t-2", "t+1"])
def test_actions_of_any_cycle_keep_no_step(cycle):
    text = EXTERNALS.replace("#program volatile", f"_action_lib(go,x,{cycle}) :- e(t), t > 2. #program volatile")
    assert first(retire(text, "", "", "e(3).")) >= 5


def test_heads_of_the_stream_alone_are_retired():
    assert first(retire("{ x }. " + EXTERNALS, "p(1).", "#assert : r. :- p(1), x.", "", "", "p(1) :- x.")) == 6


@pytest.mark.mostly_slow
@pytest.mark.parametrize(
    ("step", "rules", "reached"),
    [
        ("d(t) :- sees(t).", ["", "sees(6) :- x. :- sees(6)."], 6),
        ("d(t) :- sees(t).", ["", "sees(6) :- x. :- not sees(6)."], 6),
        ("d(t) :- sees(t).", ["", "sees(6) :- x. note :- sees(6). :- note."], 6),
        ("d(t) :- sees(t).", ["", "sees(6) :- x. sees(8) :- sees(6). :- sees(8)."], 6),
        ("d(t) :- sees(t).", ["e(1).", "sees(6) :- c(1), x. :- not sees(6)."], 6),
        ("d(t) :- sees(t).", ["e(1).", "sees(6). sees(6) :- x. e(2) :- sees(6), c(1)."], 7),
        ("d(t) :- sees(t).", ["", "sees(6) :- c(1). #assert : r. sees(6) :- x. #cumulative. :- sees(6)."], 6),
        ("", ["", "", "", "", "e(5) :- x. :- e(5)."], 5),
        ("", ["", "", "", "", "e(5) :- x. :- not e(5)."], 5),
        ("s(t) :- door, t > 1. :- door, t = 1.", ["", "door :- x."], 7),
        ("s(t) :- door, t > 1. :- not door, t = 3.", ["", "door :- x."], 7),
        ("s(t) :- door, t > 1. :- door, t = 1.", ["", "door :- c(1). door :- x."], 7),
        ("s(t) :- door, t > 1.", ["", "door :- c(1). door :- x."], 2),
        ("s(t) :- door, t > 6.", ["", "door :- x. door :- c(1).", "sees(6) :- door."], 7),
    ],
)
def test_rules_that_constraints_have_decided_are_kept(step, rules, reached):
    text = EXTERNALS.replace("#program volatile", step + " #program volatile")
    assert first(retire("{ x }. #external door. #external sees/1. " + text, *rules, steps=8)) == reached


@pytest.mark.mostly_slow
@pytest.mark.parametrize(
    "rules",
    [
        ["e(1).", "e(2) :- c(1)."],
        ["", "e(2) :- c(1)."],
        ["", "e(2) :- not c(1)."],
        ["e(1).", "e(2) :- e(1).", "e(3) :- e(2), not c(2)."],
        ["", "e(2) :- not e(1)."],
        ["e(1).", ":- e(1), x."],
        ["", ":- not e(1), x.", ":- c(2), not x."],
        ["", ":- not x, not y.", ":- c(2), not x, y."],
        ["e(1).", "e(2) :- c(1), e(1).", ":- x, e(2), c(2)."],
        ["e(1).", "e(3) :- c(1), not e(2).", ":- x, e(3)."],
    ],
)
def test_rules_of_the_stream_decide_steps(rules):
    assert first(retire("{ x ; y }. " + EXTERNALS, *rules)) >= 5


@pytest.mark.parametrize(
    "rules", [["sees(a,1).", "sees(b,2) :- sees(a,1)."], ["e(1).", "sees(b,2) :- not sees(a,1), e(1). sees(a,1)."]]
)
def test_rules_decide_atoms_of_open_predicates(rules):
    text = (
        "#external sees/2. #program cumulative(t). #external e(t). c(X,t) :- sees(X,T), T <= t. #program volatile(t)."
    )
    assert first(retire(text, *rules)) >= 5


@pytest.mark.parametrize(
    "rules",
    [
        ["e(1).", "#volatile : 5. :- c(1), x."],
        ["e(1).", "#assert : r. :- not e(1), x. :- c(1), not x."],
        ["e(1).", "#assert : r. :- not c(1). e(2).", "#retract : r."],
        ["e(1).", "e(4) :- c(1), not e(2).", ":- x, e(3)."],
    ],
)
def test_lapsing_and_waiting_statements_keep_their_meaning(rules):
    assert first(retire("{ x }. " + EXTERNALS, *rules)) >= 2


def test_statements_keep_their_order():
    """An asserted head is not closed by a rule that came later."""
    retire("{ x }. " + EXTERNALS, "#assert : r. e(4).", "", "", "e(4) :- x.", steps=8)


@pytest.mark.parametrize(
    "rules",
    [
        ["e(1) :- x.", ":- c(1)."],
        ["e(1) :- x.", "", ":- c(2).", ":- e(1)."],
        ["e(1) :- x.", ":- not c(1)."],
        ["e(1) :- x. e(1) :- y.", ":- not c(1)."],
        ["e(1) :- fresh.", ":- c(1).", "", "fresh :- x."],
    ],
)
def test_rules_between_past_and_open_atoms_keep_their_steps(rules):
    assert first(retire("{ x ; y }. " + EXTERNALS, *rules)) is None


@pytest.mark.parametrize(
    ("rules", "reached"),
    [
        (["", ":- c(1). #volatile : 9. e(1) :- x."], None),
        (["", ":- c(1). #volatile : 3. e(1) :- x."], 6),
        (["", ":- not c(1). #volatile : 3. e(1)."], None),
        (["", ":- c(1). #assert : r. e(1) :- x.", "", "", "#retract : r."], 6),
    ],
)
def test_lapsing_rule_keeps_its_steps(rules, reached):
    assert first(retire("{ x }. " + EXTERNALS, *rules)) == reached


@pytest.mark.parametrize(
    "rules",
    [
        ["e(1).", "e(2) :- c(1)."],
        ["e(1).", "e(2) :- c(1). e(3) :- e(2), not e(4)."],
        ["", "e(2) :- c(1), x. e(3) :- e(2), y."],
    ],
)
def test_several_steps_are_retired_at_once(monkeypatch, rules):
    monkeypatch.setattr(solver, "MOST_STEPS", 4)
    assert first(retire("{ x ; y }. " + EXTERNALS, *rules, steps=6)) == 5


def test_dropped_names_count_as_false(monkeypatch):
    monkeypatch.setattr(solver, "MOST_STEPS", 4)
    assert first(retire(EXTERNALS, "", "e(2) :- c(1).", "e(3) :- not c(2).", steps=6)) == 5


def test_false_atoms_of_retired_steps_stay_false():
    text = EXTERNALS.replace("#program volatile", "next(t) :- c(t-1). unless(t) :- not c(t-1). #program volatile")
    assert first(retire(text, "", "e(2).")) == 6


def test_hidden_atoms_stay_hidden_when_retired():
    assert first(retire(EXTERNALS + " #show c/1.", "e(1).", "e(2).")) == 6


def test_facts_that_a_later_step_declares_again_stay_facts():
    text = "#program cumulative(t). day(t). #external e(T) : day(T), T > t-4. #program volatile(t)."
    assert first(retire("{ x }. " + text, "", "", "e(3).", "", ":- e(3), x.")) == 6


def test_externals_of_base_that_steps_define_stay_true():
    text = EXTERNALS.replace("#program volatile", "door :- e(t), t = 1. gate :- e(t), t = 2. #program volatile")
    assert first(retire("#external door. #external gate. " + text, "e(1).")) == 6


@pytest.mark.parametrize("rule", [":- x, t = 1.", ":- not x, t = 1.", ":- x, e(t).", ":- late(t), 1 { x ; y }."])
def test_choices_of_base_that_steps_decide_stay_decided(rule):
    text = EXTERNALS.replace("#program volatile", rule + " #program volatile")
    assert first(retire("{ x ; y }. " + text, "", "e(2).", steps=8)) == 7


def test_rule_whose_head_no_step_sees_keeps_none():
    assert first(retire("{ x }. #external door. " + EXTERNALS, "note :- x.", "door :- x.", ":- note.")) == 6


@pytest.mark.parametrize(
    ("step", "rules", "reached"),
    [
        ("s(t) :- door.", ["door :- x.", ":- x."], 6),
        ("", ["", "", "", "", "e(5) :- x."], 5),
        ("", ["", "", "sees(a,3) :- c(1), x."], 6),
    ],
)
def test_rule_for_later_steps_keeps_none(step, rules, reached):
    text = EXTERNALS.replace("#program volatile", step + " #program volatile")
    assert first(retire("{ x }. #external door. #external sees/2. " + text, *rules)) == reached


@pytest.mark.parametrize("body", ["c(1)", "c(1), x"])
def test_forgotten_atoms_stay_false_without_a_name(monkeypatch, body):
    monkeypatch.setattr(solver, "MOST_STEPS", 4)
    retiring = retire("{ x }. " + EXTERNALS, "", f"e(2) :- {body}.", "#forget 1..2.", steps=6)
    assert first(retiring) == 5
    assert list(retiring.snapshot.permanent) == []


def test_atoms_that_nothing_defines_yet_may_come():
    retiring = retire("{ x }. " + EXTERNALS, ":- new, x. :- other.", "new :- not c(1).", "#forget 1..1.")
    assert first(retiring) == 6
    assert sorted(map(str, list(retiring.snapshot.permanent))) == [":- other.", ":- x."]


def test_forced_atoms_of_open_predicates_stay_so():
    text = "{ x }. #external sees/2. #program cumulative(t). d(t) :- sees(a,t). #program volatile(t)."
    assert first(retire(text, "sees(a,1) :- x.", ":- d(1).")) is None


def test_retired_atoms_are_shown_once_without_those_of_base():
    retiring = retire(
        "a. { x }. :- not x. #external sees/2. s :- sees(y,1). " + EXTERNALS, "e(1). sees(y,1).", "e(2).", steps=8
    )
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
    retiring = retire(EXTERNALS, "e(1).", "e(2) :- c(1).", *[""] * 10, steps=12)
    snapshot = retiring.snapshot
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
