"""What updates may say of atoms, one after the other and within one, and what a search that is left leaves behind."""

import pytest
from stream_logs import copied, cut, texts
from stream_play import SOLVERS, WALK, atoms, drop_grounding, play, solver_of

from rosoclingo.oclingo import DroppedError, ReactiveSolver, SolveOutcome, SolverError, parse_atom, parse_update
from rosoclingo.planning.solver import PlanSolver

IGNORED = "Head {} has not been declared external. The entire rule will be ignored."


@pytest.fixture
def external():
    return solver_of("{ a }. #cumulative t. #external e(t). c(t) :- e(t). #volatile t.")


def test_a_fact_may_be_told_again(external):
    play(external, "#step 1. e(1).")
    for update in ("e(1).", "e(1). e(1).", "#step 2. e(1)."):
        assert play(external, update).warnings == ()


def test_what_the_parser_ignored_is_told_with_the_answer(external):
    (told, ignored) = play(external, "#step 1. #step 3. c(1).").warnings
    assert "#step 3." in told
    assert ignored == IGNORED.format("c(1)")


@pytest.mark.parametrize("again", [False, True])
def test_what_a_rule_has_defined_for_good_is_closed(external, again):
    play(external, "#step 1. e(1) :- a.")
    if again:
        drop_grounding(external)
    assert play(external, "e(1).").warnings == (IGNORED.format("e(1)"),)


@pytest.mark.parametrize("update", ["#volatile. e(1). #cumulative. e(1).", "e(1). #volatile. e(1)."])
def test_a_definition_for_the_moment_and_one_for_good_in_one_update(external, update):
    assert atoms(play(external, f"#step 1. {update} :- a.")) == ["c(1)", "e(1)"]
    result = play(external, "e(1) :- a.")
    assert result.warnings == (IGNORED.format("e(1)"),)
    assert atoms(result) == ["c(1)", "e(1)"]


@SOLVERS
def test_what_a_step_defines_no_update_may_define(kind):
    solver = solver_of("#external door. #cumulative t. #external e(t). door :- e(t), t = 1.", kind)
    play(solver, "#step 1.")
    assert play(solver, "#step 2. door. e(2).").warnings == (IGNORED.format("door"),)


def test_externals_are_known_when_nothing_can_be_satisfied_any_more():
    solver = solver_of("#external door. #cumulative t. #external e(t). c(t) :- e(t). :- e(1). #volatile t.")
    result = play(solver, "#step 1 : 0. e(1).")
    assert result.outcome is SolveOutcome.UNSATISFIABLE
    result = play(solver, "#step 2 : 0. e(2). door. c(2).")
    assert (result.outcome, result.warnings) == (SolveOutcome.UNSATISFIABLE, (IGNORED.format("c(2)"),))


def test_what_is_told_and_its_opposite_cannot_both_be():
    solver = solver_of("{ -p(1..2) }. #external e. #cumulative t. #volatile t.", models=0)
    found = play(solver, "#step 1. p(1). p(2) :- e.")
    assert set(found.answers) == {frozenset(map(parse_atom, held)) for held in (["p(1)"], ["p(1)", "-p(2)"])}


@pytest.mark.parametrize(
    "updates",
    [
        ["#step 1. q(1) :- x. -q(1) :- y."],
        ["#step 1. q(1) :- x.", "-q(1) :- y."],
        ["#step 1. -q(1) :- y.", "#step 2. q(1) :- x."],
        ["#step 1. #volatile. q(1) :- x.", "#step 2. -q(1) :- y. q(1) :- x.", "#step 3."],
    ],
)
def test_opposites_that_the_stream_alone_knows_cannot_both_be(updates):
    solver = solver_of("{ x ; y }. #cumulative t. #volatile t.", models=0)
    for update in updates:
        result = play(solver, update)
    assert texts(result) == {frozenset(), frozenset(["q(1)", "x"]), frozenset(["-q(1)", "y"])}


def test_what_the_stream_alone_knows_may_be_told_again_when_it_has_lapsed(external):
    for update in ("#step 1. #volatile. new(x).", "#volatile. new(x).", "#step 2. new(x).", "#step 3."):
        assert "new(x)" in atoms(play(external, update)), update


def test_a_body_may_mention_what_a_later_update_defines(external):
    assert atoms(play(external, "#step 1. e(1) :- fresh(x). :- a.")) == []
    assert atoms(play(external, "#step 2.")) == []
    assert atoms(play(external, "fresh(x).")) == ["c(1)", "e(1)", "fresh(x)"]


@SOLVERS
@pytest.mark.parametrize(
    ("update", "answers"),
    [("sees(5).", [["sees(5)"]]), ("#volatile. sees(5).", [["sees(5)"]]), ("sees(5) :- a.", [[]])],
)
def test_a_body_may_mention_what_a_later_update_of_the_same_step_tells_of_an_open_predicate(kind, update, answers):
    solver = solver_of("{ a }. #external sees/1. #cumulative t. u(t) :- sees(t). #volatile t.", kind, models=0)
    play(solver, "#step 1. :- sees(5), a.")
    assert sorted(map(sorted, texts(play(solver, update)))) == answers


def test_a_body_may_mention_what_a_later_step_defines():
    solver = solver_of("#cumulative t. #external e(t). d(t). #volatile t.")
    assert atoms(play(solver, "#step 1. e(1) :- d(3).")) == ["d(1)"]
    assert atoms(play(solver, "#step 2.")) == ["d(1)", "d(2)"]
    assert atoms(play(solver, "#step 3.")) == ["d(1)", "d(2)", "d(3)", "e(1)"]


@pytest.mark.parametrize("cycle", ["t-2", "t-1", "t", "t+1", "t+2"])
def test_actions_of_a_closed_cycle_that_come_with_a_later_grounding_are_forbidden(cycle):
    solver = solver_of(f"#cumulative t. {{ _action_lib(go,x,{cycle}) }}. #volatile t.", models=0)
    play(solver, "#step 3. #closed 3.")
    result = play(solver, "#step 5.")
    assert len(result.answers) == 16
    assert not any(parse_atom("_action_lib(go,x,3)") in answer for answer in result.answers)


def test_what_no_rule_can_bring_about_is_no_action_of_a_closed_cycle():
    text = "d(x,t). c(t). c(t) :- d(x,t), not _action_lib(go,y,t). { _action_lib(go,Y,t) : d(Y,t) } :- c(t)."
    solver = solver_of(f"#cumulative t. {text} #volatile t.", models=0)
    play(solver, "#step 1. #closed 1.")
    assert len(play(solver, "#step 2.").answers) == 2


def test_cycles_that_an_update_closes_are_clipped_to_the_present_and_hold_what_it_commits_to():
    solver = solver_of("#cumulative t. { _action_lib(go,x,t) }. #volatile t.", models=0)
    result = play(solver, "#step 3. #closed 0..2. :- not _action_lib(go,x,1).")
    assert sorted(sorted(str(atom)[-2] for atom in answer) for answer in result.answers) == [["1"], ["1", "3"]]
    assert len(play(solver, "#step 4. #closed 3..9. :- not _action_lib(go,x,3).").answers) == 1
    assert len(play(solver, "#step 5.").answers) == 2
    result = play(solver, "#step 2. #anew.")
    assert (result.step, solver.horizon, len(result.answers)) == (2, 2, 4)


def test_what_holds_up_to_a_horizon_that_is_past_is_not_taken(external):
    play(external, "#step 3.")
    for window, taken in ((1, []), (2, []), (3, ["c(1)", "e(1)"])):
        result = play(external, f"#step 1. :- a. #volatile : {window}. e(1).")
        assert (atoms(result), result.warnings) == (taken, ())


@SOLVERS
def test_what_is_told_while_there_is_no_answer_for_good_counts_once_that_is_withdrawn(kind):
    text = "{ a }. #cumulative t. #external e(t). { m(t) }. c(t) :- e(t). :- e(1). #volatile t. :- a. :- m(t)."
    solver = solver_of(text, kind)
    assert play(solver, "#step 1 : 0. e(1).").permanent
    result = play(solver, "#step 3 : 0. e(3). m(3).")
    assert (result.outcome, result.warnings) == (SolveOutcome.UNSATISFIABLE, (IGNORED.format("m(3)"),))
    assert {"c(3)", "e(3)"} <= set(atoms(play(solver, "#step 3 : 0. #withdraw e(1).")))


def test_what_its_own_step_has_not_declared_will_not_come():
    solver = solver_of("#cumulative t. #external e(t) : t != 2. #volatile t.")
    assert play(solver, "#step 2. e(2).").warnings == (IGNORED.format("e(2)"),)
    assert play(solver, "#step 2. e(3).").warnings == ()
    assert atoms(play(solver, "#step 3.")) == ["e(3)"]


def test_what_a_step_says_before_its_own_one_declares_it_will_not_come():
    solver = solver_of("#cumulative t. #external e(t). { e(t+1) }. #volatile t.")
    play(solver, "#step 1.")
    assert play(solver, "e(2).").warnings == (IGNORED.format("e(2)"),)


def test_what_an_update_has_defined_is_closed_when_its_name_is_gone(external):
    play(external, "#step 1. new :- e(1). #forget 1.")
    play(external, "#step 2.")
    result = play(external, "#step 3. new.")
    assert "new" not in atoms(result)
    assert result.warnings == (IGNORED.format("new"),)


LOOP = ["f(1) :- d(1).", "e(1) :- f(1).", "g(1) :- d(1)."]


@pytest.mark.parametrize("rules", [LOOP, LOOP[::-1], [LOOP[1], LOOP[0], LOOP[2]]])
def test_rules_of_one_update_that_close_a_loop_with_one_of_the_program_support_nothing(rules):
    solver = solver_of(
        "{ a }. #cumulative t. #external e(t). #external f(t). #external g(t). d(t) :- e(t), a. #volatile t.", models=0
    )
    play(solver, "#step 1.")
    result = play(solver, " ".join(rules))
    assert (texts(result), result.warnings) == ({frozenset(), frozenset(["a"])}, ())


@SOLVERS
def test_what_a_step_forgets_are_externals_that_nothing_defines(kind):
    text = "{ a }. #cumulative t. #external e(t). #external f(t). #volatile t : 3. :- a, t = 1."
    solver = solver_of(text, kind, models=0)
    assert texts(play(solver, "#step 1. #volatile : 2. e(1). #forget 1.")) == {frozenset(["e(1)"])}
    assert texts(play(solver, "#step 2.")) == {frozenset(["e(1)"])}
    assert texts(play(solver, "#step 3.")) == {frozenset()}
    assert texts(play(solver, "#step 4.")) == {frozenset(), frozenset(["a"])}
    result = play(solver, "e(1). f(1).")
    assert [warning.split()[1] for warning in result.warnings] == ["f(1)"]


def test_withdrawn_facts_were_never_told(external):
    play(external, "#step 1. :- a. e(1).")
    play(external, "#step 2. e(2).")
    assert atoms(play(external, "#withdraw e(1).")) == ["c(2)", "e(2)"]


def test_updates_taken_again_ground_no_more_than_a_stopped_search(external):
    looks = iter([False] * 3)
    update = parse_update("#step 9. e(9). #endstep.")
    assert external.update(update, lambda: next(looks, True)).outcome is SolveOutcome.INTERRUPTED
    reader = ReactiveSolver(external.program)
    reader.take_again(update, external.horizon)
    assert reader.horizon == external.horizon < 9
    assert {"c(9)", "e(9)"} <= set(atoms(play(reader, "#step 9.")))


@pytest.mark.parametrize("ahead", ["", "q(t) :- p(t+1)."])  # which no step sees that is ground alone
def test_updates_taken_again_ground_as_much_as_the_search_did(ahead):
    solver = solver_of(f"#cumulative t. p(t). {ahead} #volatile t. :- t < 5.")
    update = parse_update("#step 1. #endstep.")
    found = solver.update(update)
    reader = ReactiveSolver(solver.program)
    reader.take_again(update, solver.horizon)
    assert reader.horizon == solver.horizon >= 5
    assert atoms(reader.solve()) == atoms(found)


def test_cycles_before_the_first_are_not_closed():
    solver = solver_of("#cumulative t. _action_lib(go,x,t-1). #volatile t.")
    result = play(solver, "#step 2. #closed 0..1. :- not _action_lib(go,x,1).")
    assert result.outcome is SolveOutcome.SATISFIABLE
    assert sorted(solver.state.closed) == [1]


def test_what_was_executed_in_a_cycle_that_an_update_closes_is_kept():
    solver = solver_of("#cumulative t. { _action_lib(go,(x;y),t) }. #volatile t.", models=0)
    play(solver, "#step 1.")
    for _ in range(2):
        answers = play(solver, "#step 2 : 0. #closed 1..1. :- not _action_lib(go,x,1).").answers
        assert len(answers) == 4
        assert not any(parse_atom("_action_lib(go,y,1)") in answer for answer in answers)
        drop_grounding(solver)


ALWAYS, IF_A, NEVER = (
    [["a", "r(x,2)", "w(x,2)"], ["r(x,2)", "w(x,2)"]],
    [[], ["a", "r(x,2)", "w(x,2)"]],
    [[], ["a"]],
)


@pytest.mark.parametrize(
    ("update", "now", "later"),
    [
        ("r(x,2).", ALWAYS, ALWAYS),
        ("r(x,2) :- a.", IF_A, IF_A),
        ("r(x,2) :- a. r(x,2).", ALWAYS, ALWAYS),
        ("r(x,2). r(x,2) :- a.", ALWAYS, ALWAYS),
        ("r(x,2) :- y.", NEVER, NEVER),
        ("#volatile. r(x,2).", ALWAYS, NEVER),
        ("#volatile : 1. r(x,2).", ALWAYS, NEVER),
        ("#volatile : 2. r(x,2).", ALWAYS, ALWAYS),
        ("#volatile. r(x,2). #cumulative. r(x,2) :- a.", ALWAYS, IF_A),
        ("r(x,2) :- a. #volatile. r(x,2).", ALWAYS, IF_A),
        ("#assert : z. r(x,2).", ALWAYS, ALWAYS),
        ("r(x,2). #retract : z.", ALWAYS, ALWAYS),
        ("#withdraw r(x,2). r(x,2).", ALWAYS, ALWAYS),
        ("#anew. r(x,2).", ALWAYS, ALWAYS),
    ],
)
@pytest.mark.parametrize("before", [[], ["#step 1."]])
@pytest.mark.parametrize("rule", ["w(X,t) :- r(X,t).", ""])
@SOLVERS
def test_what_an_update_may_say_of_an_open_predicate(kind, rule, before, update, now, later):
    """Whether the program is ground up to that step before or with the update; the same updates lead readers there."""
    solver = solver_of(f"{{ a }}. #external r/2. #cumulative t. {rule} #volatile t.", kind, models=0)
    if not rule:
        now, later = ([[atom for atom in one if atom[0] != "w"] for one in answers] for answers in (now, later))
    for text in (*before, f"#step 2. {update}"):
        result = play(solver, text)
    assert sorted(map(sorted, texts(result))) == now
    assert not any("declared external" in warning for warning in result.warnings)
    for one in (solver, *readers_of(solver, [*before, f"#step 2. {update}"])):
        assert sorted(map(sorted, texts(one.solve()))) == now
        assert sorted(map(sorted, texts(play(one, "#step 3.")))) == later


def readers_of(solver, played):
    """Solvers that know what was played without a search of it."""
    readers = [type(solver)(solver.program, models=0) for _ in range(2)]
    if isinstance(solver, PlanSolver):
        for reader, log in zip(readers, (copied(solver.log), cut(solver))):
            reader.restore(log)
        return readers
    for text in played:
        for reader in readers:
            reader.take_again(parse_update(text + " #endstep."), solver.horizon)
    drop_grounding(readers[1])
    return readers


def test_what_is_told_of_an_open_predicate_again_and_again_is_kept_once():
    solver = solver_of("#external r/2. #cumulative t. w(X,t) :- r(X,t). #volatile t.")
    for step in (1, 2, 3):
        play(solver, f"#step {step}. #volatile. r(x,1).")
    assert len(solver.state.items) == 1


def test_the_last_step_that_may_be_grounded():
    solver = solver_of(WALK, horizon_limit=3)
    assert play(solver, "#step 3.").outcome is SolveOutcome.SATISFIABLE
    with pytest.raises(SolverError, match="step 4 is beyond the horizon limit 3"):
        play(solver, "#step 4.")
    assert solver.step == 3
    assert play(solver, "_request(0,3).").outcome is SolveOutcome.SATISFIABLE, "an update without a step stays at it"
    assert solver.solve().outcome is SolveOutcome.SATISFIABLE


def test_a_dropped_update_leaves_what_was_in_force():
    solver = solver_of("#external e/1. #cumulative t. b(X,t) :- e(X). #volatile t.")
    play(solver, "#step 1. #volatile. new(x).")
    with pytest.raises(DroppedError):
        solver.update(parse_update("#step 1. e(1). #endstep."), None, lambda: True)
    assert atoms(solver.solve()) == ["new(x)"]
