"""What is kept of steps that are over: the answers of two streams, of which one lets go of its steps, are the same."""

import pytest
from test_solver import atoms, play

from rosoclingo.oclingo import ReactiveProgram, ReactiveSolver, SolveOutcome, parse_atom
from rosoclingo.oclingo.solving import compaction, grounding, transaction
from rosoclingo.oclingo.solving.stream_state import Past, Setting, StreamState

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
    return ReactiveSolver(ReactiveProgram.from_text(text), models=0, shortest=True)


def warnings(result):
    """What is said but for the number of a step, which only one of two streams has retired."""
    return [one.split(" ")[1] for one in result.warnings]


def retire(text, *updates, steps=7):
    """Play the updates, one a step, with and without retiring the steps before; compare; return the retiring solver."""
    retiring, forgetting = stream(text), stream(text)
    for step in range(1, steps + 1):
        update = updates[step - 1] if step <= len(updates) else ""
        retiring.forget_before(step - 1)
        forgotten = f"#forget 1..{step - 2}. " if step > 2 else ""
        found = play(retiring, f"#step {step} : 0. {update}")
        expected = play(forgetting, f"#step {step} : 0. {forgotten}{update}")
        assert set(found.answers) == set(expected.answers), step
        assert warnings(found) == warnings(expected), step
    return retiring


def first(retiring):
    return None if retiring.state.past is None else retiring.state.past.first


@pytest.mark.parametrize(
    ("reached", "tried", "keep_from", "steps"),
    [(None, 0, 5, 4), (None, 8, 11, 3), (9, 0, 12, 3), (9, 5, 19, 10), (9, 12, 13, 1)],
)
def test_how_many_steps_are_over_and_not_tried_yet(reached, tried, keep_from, steps):
    past = None if reached is None else Past(reached, frozenset())
    state = StreamState(step=20, horizon=20, keep_from=keep_from, tried=tried, past=past)
    assert Setting(ReactiveProgram.from_text(EXTERNALS)).steps_over(state) == steps


@pytest.mark.parametrize(
    ("atom", "too_late"),
    [
        ("e(8)", True),
        ("e(9)", False),
        ("held(7)", True),
        ("held(8)", False),
        ("sees(x,7)", True),
        ("sees(x,8)", False),
        ("sees(x,30)", False),
        ("unused(1)", False),
        ("told(3)", False),
        ("other(1)", False),
    ],
)
def test_what_comes_too_late_when_the_steps_before_the_ninth_are_over(atom, too_late):
    text = (
        "#external sees/2. #external unused/1. #program cumulative(t). day(t). #external e(t). "
        "#external held(T) : day(T), T > t-2. seen(X,t) :- sees(X,T), T > t-2. a(t) :- told(t). #program volatile(t)."
    )
    setting, state = Setting(ReactiveProgram.from_text(text)), StreamState(step=12, horizon=12)
    assert setting.is_too_late(state, parse_atom(atom)) is False
    state.past = Past(9, frozenset())
    assert setting.is_too_late(state, parse_atom(atom)) is too_late


@pytest.mark.parametrize(("window", "reached"), [("1", 6), ("2", 5), ("3", 4)])
def test_steps_whose_volatile_rules_may_hold_are_not_over(window, reached):
    text = f"#cumulative t. p(t). #volatile t : {window}. :- not p(t). #volatile t. :- not p(t)."
    retiring = stream(text)
    for step in range(1, 8):
        retiring.forget_before(step)
        play(retiring, f"#step {step}.")
    assert first(retiring) == reached


def test_what_is_told_to_be_over_ahead_of_time_is_so_when_its_time_comes():
    retiring = stream(EXTERNALS)
    retiring.forget_before(2)
    for step in (1, 2, 3):
        play(retiring, f"#step {step}.")
    assert first(retiring) == 2


@pytest.mark.parametrize(("after", "times"), [(2, 4), (3, 3), (8, 1)])
def test_where_nothing_can_be_retired_it_is_not_tried_with_each_update(monkeypatch, after, times):
    monkeypatch.setattr(compaction, "COMPACT_AFTER", after)
    retiring, tries = stream("{ a }. #cumulative t. s(t) :- a. #volatile t."), set()
    for step in range(1, 11):
        retiring.forget_before(step)
        play(retiring, f"#step {step}.")
        tries.add(retiring.state.tried)
    assert first(retiring) is None
    assert len(tries - {0}) == times


def test_what_contradicts_the_stream_is_not_retired_and_can_still_be_withdrawn():
    retiring = stream("#cumulative t. #external e(t). p(t) :- e(t). p(t) :- p(t-1). #volatile t. :- p(t).")
    play(retiring, "#step 1.")
    assert play(retiring, "#step 2 : 0. e(2).").outcome is SolveOutcome.UNSATISFIABLE
    for step in (3, 4, 5):
        retiring.forget_before(step)
        assert play(retiring, f"#step {step} : 0.").outcome is SolveOutcome.UNSATISFIABLE
    assert play(retiring, "#step 6 : 0. #withdraw e(2).").outcome is SolveOutcome.SATISFIABLE


def test_externals_of_base_stay_open():
    retiring = stream("#external door. #program cumulative(t). s(t) :- door, t > 6. #program volatile(t).")
    for step in range(1, 7):
        retiring.forget_before(step)
        play(retiring, f"#step {step}.")
    assert first(retiring) == 5
    assert atoms(play(retiring, "#step 7. door.")) == ["door", "s(7)"]


def test_externals_of_steps_are_closed_up_to_the_last_one_that_is_over():
    retiring = retire(EXTERNALS)
    assert first(retiring) == 6
    retiring.forget_before(7)
    result = play(retiring, "#step 8 : 0. e(5). e(6). e(7). e(8).")
    assert (first(retiring), warnings(result)) == (7, ["e(5)", "e(6)"])
    assert atoms(result) == ["c(7)", "c(8)", "e(7)", "e(8)"]


def test_what_has_been_closed_is_not_opened_again_by_a_later_step():
    retiring = retire(SEVERAL)
    retiring.forget_before(7)
    result = play(retiring, "#step 8 : 0. e(6). e(7).")
    assert first(retiring) == 7
    assert result.warnings == (IGNORED.format("e(6)"),)


def test_what_has_been_closed_is_not_awaited_from_a_later_step():
    retiring = stream("#program cumulative(t). #external e(9) : t \\ 4 = 1. c(t) :- e(9). #program volatile(t).")
    for step in (1, 2, 3, 4, 5):
        retiring.forget_before(step - 1)
        result = play(retiring, f"#step {step} : 0." + (" e(9)." if step == 4 else ""))
        assert warnings(result) == (["e(9)"] if step == 4 else [])
    assert (first(retiring), atoms(result)) == (4, [])


@pytest.mark.parametrize("cycle", ["soon(t)", "t-2", "t+1"])
def test_actions_of_any_cycle_and_of_none_keep_no_step(cycle):
    text = EXTERNALS.replace("#program volatile", f"_action_lib(go,x,{cycle}) :- e(t), t > 2. #program volatile")
    assert first(retire(text, "", "", "e(3).")) >= 5


def test_what_the_stream_alone_has_defined_is_defined_for_good():
    assert first(retire("{ x }. " + EXTERNALS, "p(1).", "#assert : r. :- p(1), x.", "", "", "p(1) :- x.")) == 6


@pytest.mark.parametrize(("choice", "made"), [("", 6), ("{ a }. ", 1)])
def test_the_program_is_ground_anew_where_steps_are_retired_and_only_there(choice, made, monkeypatch):
    groundings = []

    def counting(*arguments):
        groundings.append(arguments)
        return grounding.build_grounding(*arguments)

    monkeypatch.setattr(transaction, "build_grounding", counting)
    retiring = stream(choice + "#program cumulative(t). #external e(t). s(t) :- a. c(t) :- e(t). #program volatile(t).")
    for step in range(1, 8):
        retiring.forget_before(step)
        play(retiring, f"#step {step}.")
    assert first(retiring) == (None if choice else 6)
    assert len(groundings) == made


def test_steps_that_are_over_before_the_present_update_are_retired_along_with_another_grounding(monkeypatch):
    monkeypatch.setattr(compaction, "COMPACT_AFTER", 100)
    text = EXTERNALS.replace("late", "s(X,t) :- sees(X). late") + " :- late(t), not e(t)."
    retiring = stream("#external sees/1. " + text)
    for step in range(1, 6):
        play(retiring, f"#step {step}.")
    retiring.forget_before(6)
    play(retiring, "#step 6. sees(y).")
    assert first(retiring) == 5


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
def test_what_constraints_have_made_of_rules_that_stay_is_not_lost(step, rules, reached):
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
def test_what_rules_of_the_stream_have_decided(rules):
    assert first(retire("{ x ; y }. " + EXTERNALS, *rules)) >= 5


@pytest.mark.parametrize(
    "rules", [["sees(a,1).", "sees(b,2) :- sees(a,1)."], ["e(1).", "sees(b,2) :- not sees(a,1), e(1). sees(a,1)."]]
)
def test_what_rules_of_the_stream_have_decided_of_open_predicates(rules):
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
def test_what_statements_mention_that_lapse_or_wait(rules):
    assert first(retire("{ x }. " + EXTERNALS, *rules)) >= 2


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
def test_rules_that_tie_what_is_over_to_what_is_open_keep_their_steps(rules):
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
def test_a_rule_that_will_lapse_keeps_the_steps_that_it_is_for(rules, reached):
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
    monkeypatch.setattr(compaction, "COMPACT_AFTER", 4)
    assert first(retire("{ x ; y }. " + EXTERNALS, *rules, steps=6)) == 5


def test_what_is_false_for_good_is_so_when_its_name_is_gone(monkeypatch):
    monkeypatch.setattr(compaction, "COMPACT_AFTER", 4)
    assert first(retire(EXTERNALS, "", "e(2) :- c(1).", "e(3) :- not c(2).", steps=6)) == 5


def test_what_steps_have_found_false_is_not_told():
    text = EXTERNALS.replace("#program volatile", "next(t) :- c(t-1). unless(t) :- not c(t-1). #program volatile")
    assert first(retire(text, "", "e(2).")) == 6


def test_what_is_not_shown_is_not_shown_when_it_is_over():
    assert first(retire(EXTERNALS + " #show c/1.", "e(1).", "e(2).")) == 6


def test_facts_that_a_later_step_declares_again_stay_facts():
    text = "#program cumulative(t). day(t). #external e(T) : day(T), T > t-4. #program volatile(t)."
    assert first(retire("{ x }. " + text, "", "", "e(3).", "", ":- e(3), x.")) == 6


def test_what_a_step_has_made_of_an_external_of_base_stays_so():
    text = EXTERNALS.replace("#program volatile", "door :- e(t), t = 1. gate :- e(t), t = 2. #program volatile")
    assert first(retire("#external door. #external gate. " + text, "e(1).")) == 6


@pytest.mark.parametrize("keep_from", [1, 3])
def test_where_nothing_is_retired_the_grounding_stays(keep_from):
    setting = Setting(ReactiveProgram.from_text("{ a }. #cumulative t. s(t) :- a. #volatile t."), shortest=True)
    ground = grounding.Grounding(setting.program, (), set(), shortest=True)
    ground.ground_to(3)
    assert ground.search(1, lambda: False, 3, 3).satisfiable
    state = StreamState(step=3, horizon=3, settled=3, keep_from=keep_from)
    assert compaction.compact(setting, state, ground) is False
    assert state.past is None


@pytest.mark.parametrize("rule", [":- x, t = 1.", ":- not x, t = 1.", ":- x, e(t).", ":- late(t), 1 { x ; y }."])
def test_what_steps_have_decided_of_choices_in_base_stays_so(rule):
    text = EXTERNALS.replace("#program volatile", rule + " #program volatile")
    assert first(retire("{ x ; y }. " + text, "", "e(2).", steps=8)) == 7


def test_a_rule_for_what_no_step_sees_keeps_none():
    assert first(retire("{ x }. #external door. " + EXTERNALS, "note :- x.", "door :- x.", ":- note.")) == 6


@pytest.mark.parametrize(
    ("step", "rules", "reached"),
    [
        ("s(t) :- door.", ["door :- x.", ":- x."], 6),
        ("", ["", "", "", "", "e(5) :- x."], 5),
        ("", ["", "", "sees(a,3) :- c(1), x."], 6),
    ],
)
def test_a_rule_for_what_is_not_of_the_steps_that_are_over_keeps_none(step, rules, reached):
    text = EXTERNALS.replace("#program volatile", step + " #program volatile")
    assert first(retire("{ x }. #external door. #external sees/2. " + text, *rules)) == reached


@pytest.mark.parametrize("body", ["c(1)", "c(1), x"])
def test_what_was_forgotten_is_false_when_its_name_is_gone(monkeypatch, body):
    monkeypatch.setattr(compaction, "COMPACT_AFTER", 4)
    retiring = retire("{ x }. " + EXTERNALS, "", f"e(2) :- {body}.", "#forget 1..2.", steps=6)
    assert first(retiring) == 5
    assert retiring.state.permanent == []


def test_what_no_rule_has_brought_yet_may_come():
    retiring = retire("{ x }. " + EXTERNALS, ":- new, x. :- other.", "new :- not c(1).", "#forget 1..1.")
    assert first(retiring) == 6
    assert sorted(map(str, retiring.state.permanent)) == [":- other.", ":- x."]


def test_what_an_open_predicate_has_been_forced_to_be_stays_so():
    text = "{ x }. #external sees/2. #program cumulative(t). d(t) :- sees(a,t). #program volatile(t)."
    assert first(retire(text, "sees(a,1) :- x.", ":- d(1).")) is None


def test_what_is_over_is_shown_once_and_what_base_says_not_at_all():
    retiring = retire(
        "a. { x }. :- not x. #external sees/2. s :- sees(y,1). " + EXTERNALS, "e(1). sees(y,1).", "e(2).", steps=8
    )
    shown = sorted(str(atom) for _, atom in retiring.state.past.shown)
    assert shown == ["c(1)", "c(2)", "e(1)", "e(2)", "late(3)", "late(4)", "sees(y,1)"]


def test_what_was_shown_is_shown_for_some_steps(monkeypatch):
    monkeypatch.setattr(compaction, "SHOWN_STEPS", 3)
    retiring = stream("#program cumulative(t). p(t). #program volatile(t).")
    for step in range(1, 10):
        retiring.forget_before(step)
        shown = atoms(play(retiring, f"#step {step} : 0."))
    assert first(retiring) == 8
    assert shown == [f"p({step})" for step in range(5, 10)]


def test_nothing_is_kept_that_no_later_step_has_a_use_for():
    retiring = retire(EXTERNALS, "e(1).", "e(2) :- c(1).", *[""] * 10, steps=12)
    state = retiring.state
    assert state.past.first == 11
    assert (state.past.facts, state.permanent, state.open_atoms) == (frozenset(), [], [])
    assert {str(atom) for atom in state.forgotten} <= {"e(9)", "e(10)", "__oclingo_volatile(1,10)"}


def test_of_what_was_told_and_done_at_retired_steps_nothing_stays_that_no_later_step_asks_for():
    solver = stream(
        "#external told/1. #external _request/2. #program cumulative(t). { _action_lib(go,(a;b),t) } 1. "
        "wanted(t) :- _request(x,t). #program volatile(t)."
    )
    for step in range(1, 6):
        solver.forget_before(step - 1)
        play(solver, f"#step {step} : 0. told({step}). {'_request(x,1). _request(x,9).' if step == 1 else ''}")
        solver.close_cycle(step, [])
    state = solver.state
    assert first(solver) == 4
    assert sorted(state.closed_cycles) == [3, 4, 5], "the last one before what is ground is told for its returns"
    assert sorted(map(str, state.permanent)) == ["_request(x,9).", "told(5)."]
    assert sorted(map(str, state.open_atoms)) == ["_request(x,9)", "told(5)"]
    shown = {str(atom): step for step, atom in state.past.shown if atom.name == "told"}
    assert shown == {"told(1)": 1, "told(2)": 1, "told(3)": 2, "told(4)": 3}, "as of the last step that is retired"
