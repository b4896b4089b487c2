"""Steps that are over are told as facts: answers stay the same, and a long stream costs no more than a short one."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from recorded_streams import STEPS, Planned
from stream_logs import copied, cut
from test_solver_properties import PARTS, UPDATES, without_strangers

from rosoclingo.oclingo import DroppedError, ReactiveProgram, ReactiveSolver, SolveOutcome, parse_atom, parse_update
from rosoclingo.oclingo.progression.updates import Forget, Literal, Statement
from rosoclingo.oclingo.solving import compaction, grounding
from rosoclingo.oclingo.solving import solver as solver_module
from rosoclingo.oclingo.solving.stream_log import Taken

pytestmark = pytest.mark.usefixtures("compacts_at_once")

WALK = """
#program base.
at(a,0). next(a,b). next(b,c). next(c,a).
#program cumulative(t).
#external blocked(t).
#external sees/2.
#external _request/2.
{ _action_lib(go,Y,t) : next(X,Y) } 1 :- at(X,t-1), not blocked(t).
at(Y,t) :- _action_lib(go,Y,t).
at(X,t) :- at(X,t-1), not moved(t).
moved(t) :- _action_lib(go,Y,t).
wanted(X,t) :- _request(goal(X,Id),t).
wanted(X,t) :- wanted(X,t-1), not at(X,t-1).
seen(X,t) :- sees(X,T), T <= t.
#program volatile(t).
:- wanted(X,t), not at(X,t).
"""


@pytest.mark.slow
def test_what_is_long_over_is_shown_no_more():
    answers = drive(walk(), 80, 0)
    for cycle, shown in ((10, False), (80, True)):
        assert any(atom.startswith("at(") and atom.endswith(f",{cycle})") for atom in answers[-1]) is shown
    assert sum("_action_lib" in atom for atom in answers[-1]) < 50
    assert max(map(len, answers[40:])) < 2 * max(map(len, answers[20:40])), "a long stream's answers are no larger"


def walk():
    return ReactiveSolver(ReactiveProgram.from_text(WALK), shortest=True, oclingo_strings=False)


def ask(solver, text, closing=()):
    """Feed an update and close its cycle with the action planned for it, if any; return the answer as text."""
    result = solver.update(parse_update(text))
    assert result.outcome is SolveOutcome.SATISFIABLE
    answer = result.answers[0]
    step = result.step
    executed = [atom for atom in answer if atom.name == "_action_lib" and atom.arguments[2].number == step]
    solver.close_cycle(step, [*executed, *closing])
    return sorted(map(str, answer)), executed


def drive(solver, cycles, margin, improves=False):
    """Go round and round; return all answers. In each cycle it may be looked for better plans until there are none."""
    answers, before = [], []
    for cycle in range(1, cycles + 1):
        goal = "abc"[cycle % 3]
        text = f"#step {cycle}. " + "".join(f":- not {atom}. " for atom in before)
        text += f"_request(goal({goal},{cycle}),{cycle + 1}). " if cycle % 2 else ""
        if margin is not None:
            solver.forget_before(cycle - margin)
        answer, before = ask(solver, text + "#endstep.")
        answers.append(answer)
        if improves:
            solver.log.plan = solver.log.plan._replace(horizon=solver.log.plan.horizon + 3, shortest=False)
            while solver.improve() is not None:
                pass
    return answers


@pytest.mark.slow
@pytest.mark.parametrize("cycles", [12, 13])
def test_steps_are_retired_though_a_better_plan_was_looked_for_in_vain(cycles):
    solver = ReactiveSolver(ReactiveProgram.from_text(WALK), shortest=True, oclingo_strings=False, plan_time=0.0)
    drive(solver, cycles, 0, improves=True)
    assert solver.state.past.first == cycles


@pytest.mark.slow
@pytest.mark.parametrize("margin", [0, 1, 5])
def test_answers_stay_the_same(margin, monkeypatch):
    monkeypatch.setattr(compaction, "SHOWN_STEPS", 100)
    solver = walk()
    plans = drive(solver, 30, margin)
    assert solver.state.past.first >= 30 - margin - grounding.BLOCK
    for mine, other in zip(plans, drive(walk(), 30, None)):
        assert [one for one in mine if "_action" in one] == [one for one in other if "_action" in one]
        assert mine == other


@pytest.mark.slow
def test_nothing_accumulates():
    solver = walk()
    drive(solver, 60, 2)
    state = solver.state
    assert len(state.past.facts) < 12
    assert len(state.permanent) + len(state.open_atoms) + len(state.closed_cycles) < 24
    assert len(state.forgotten) < 12


@pytest.mark.slow
@pytest.mark.parametrize("offset", range(-3, 4))
@pytest.mark.parametrize("name", ["t", "T"])
def test_nothing_accumulates_wherever_the_actions_of_a_step_lie(offset, name):
    head = f"{{ _action_lib(go,x,{name}+{offset}) }} :- now(T), t-1 < T, T <= t"
    text = f"#program cumulative(t). now(t). {head}. #program volatile(t)."
    solver = ReactiveSolver(ReactiveProgram.from_text(text), models=0, shortest=True)
    for cycle in range(1, 16):
        solver.forget_before(cycle)
        answers = solver.update(parse_update(f"#step {cycle} : 0. #endstep.")).answers
        assert len(answers) == (2 if 0 <= offset < cycle else 1), "each cycle is closed without an action"
        solver.close_cycle(cycle, [])
    assert solver.state.past.first >= 14 - max(offset, 0)
    assert name == "T" or len(solver.state.closed_cycles) <= 6


@pytest.mark.slow
def test_cycles_in_which_nothing_can_be_done_are_retired(monkeypatch):
    monkeypatch.setattr(grounding, "BLOCK", 64)
    monkeypatch.setattr(solver_module, "BLOCK", 8)
    text = WALK.replace("not blocked(t).", "not blocked(t), t \\ 5 = 1.")
    solver = ReactiveSolver(ReactiveProgram.from_text(text), shortest=True, oclingo_strings=False)
    before = []
    for cycle in range(1, 41):
        text = f"#step {cycle}. " + "".join(f":- not {atom}. " for atom in before)
        text += f"_request(goal({'abc'[cycle // 5 % 3]},{cycle}),{cycle + 1}). " if cycle % 5 == 1 else ""
        solver.forget_before(cycle - 3)
        _, before = ask(solver, text + "#endstep.")
    assert solver.state.past.first >= 36


def test_what_is_open_is_ground_as_ever():
    """A base choice that decides what the steps hold keeps them all."""
    solver = ReactiveSolver(ReactiveProgram.from_text(WALK + "#program base.\n{ odd }.\n" + TIED), shortest=True)
    drive(solver, 8, 0)
    assert solver.state.past is None


def test_what_the_past_has_decided_of_base_stays_decided():
    text = "#base.\n{ a }.\n#cumulative t.\nc(t) :- not a.\n:- c(t-1).\n#volatile t.\n"
    solver = ReactiveSolver(ReactiveProgram.from_text(text), models=0, shortest=True)
    for step in (3, 4, 5):
        solver.forget_before(step)
        answers = solver.update(parse_update(f"#step {step} : 0. #endstep.")).answers
        assert answers == (frozenset([parse_atom("a")]),)
    assert solver.state.past.first > 2
    assert len(solver.state.permanent) == 1


TIED = """
#program cumulative(t).
tied(t) :- odd, at(a,t).
"""


def test_facts_for_what_is_over_come_too_late():
    solver = walk()
    drive(solver, 10, 2)
    solver.forget_before(9)
    result = solver.update(parse_update("#step 11. blocked(3). blocked(11). _request(goal(b,3),4). #endstep."))
    assert [line.split(".")[0] for line in result.warnings] == [
        "Head blocked(3) comes too late: what concerns steps before 9 is over",
        "Head _request(goal(b,3),4) comes too late: what concerns steps before 9 is over",
    ]
    assert parse_atom("blocked(11)") in result.answers[0]


def test_what_comes_too_late_does_so_for_who_reads_the_log():
    solver, reader = walk(), walk()
    drive(solver, 10, 2)
    solver.update(parse_update("#step 10. blocked(10). #endstep."))
    reader.restore(copied(solver.log))
    result = reader.update(parse_update("#step 11. _request(goal(b,3),4). #endstep."))
    assert [line.split(":")[0] for line in result.warnings] == ["Head _request(goal(b,3),4) comes too late"]


def test_what_may_concern_later_steps_is_never_too_late():
    solver = walk()
    drive(solver, 10, 2)
    result = solver.update(parse_update("#step 11. sees(x,3). #endstep."))
    assert not result.warnings
    assert parse_atom("seen(x,11)") in result.answers[0]
    solver.forget_before(11)
    for step in (12, 13, 14):
        assert parse_atom(f"seen(x,{step})") in solver.update(parse_update(f"#step {step}. #endstep.")).answers[0]


def test_a_state_can_be_restored():
    solver, other = walk(), walk()
    drive(solver, 12, 2)
    other.restore(cut(solver))
    text = "#step 13. _request(goal(c,99),14). #endstep."
    assert set(solver.update(parse_update(text)).answers[0]) == set(other.update(parse_update(text)).answers[0])


def test_who_reads_the_log_knows_which_steps_were_retired():
    """Which ones depends on what was searched, so that the writer notes it in the log."""
    solver, reader = walk(), walk()
    drive(solver, 9, 2)
    reader.restore(copied(solver.log))
    assert reader.state.past == solver.state.past
    assert reader.state.past.first >= 6


def test_nothing_is_retired_by_reading_a_log(monkeypatch):
    """The log says what was; it would lead elsewhere if readers did more."""
    monkeypatch.setattr(compaction, "COMPACT_AFTER", 100)
    solver = walk()
    drive(solver, 8, 1)
    monkeypatch.setattr(compaction, "COMPACT_AFTER", 1)
    solver.restore(solver.log.then(Taken(parse_update("#step 9. #endstep."), 9)))
    assert (solver.state.step, solver.state.past) == (9, None)


def test_few_steps_are_retired_along_with_another_grounding(monkeypatch):
    monkeypatch.setattr(compaction, "COMPACT_AFTER", 100)
    solver = walk()
    drive(solver, 8, 1)
    assert solver.state.past is None
    solver.update(parse_update("#step 8. sees(x,3). #endstep."))
    assert solver.state.past is not None, "steps that could have seen it are ground anew"


def test_steps_stay_retired_where_the_update_is_dropped(monkeypatch):
    """What has taken time need not be done again, and is of no other worth than before."""
    monkeypatch.setattr(compaction, "COMPACT_AFTER", 100)
    solver, other = walk(), walk()
    for one in (solver, other):
        drive(one, 8, 1)
    with pytest.raises(DroppedError):
        solver.update(parse_update("#step 9. sees(x,3). #endstep."), dropped=lambda: True)
    assert solver.state.past is not None
    assert (solver.log.key, solver.state.step) == (other.log.key, 8)
    assert ask(solver, "#step 9. _request(goal(c,99),10). #endstep.") == ask(
        other, "#step 9. _request(goal(c,99),10). #endstep."
    )
    reader = walk()
    reader.restore(copied(solver.log))
    assert reader.state.past == solver.state.past, "the log tells it"


def test_steps_are_retired_while_a_better_plan_is_looked_for(monkeypatch):
    monkeypatch.setattr(compaction, "COMPACT_AFTER", 100)
    solver, other = (
        ReactiveSolver(ReactiveProgram.from_text(WALK), shortest=True, oclingo_strings=False, plan_time=0.0)
        for _ in range(2)
    )
    for one in (solver, other):
        drive(one, 8, 1)
    monkeypatch.setattr(compaction, "COMPACT_AFTER", 1)
    solver.log.plan = solver.log.plan._replace(horizon=solver.log.plan.horizon + 3, shortest=False)
    while solver.improve() is not None:
        pass
    assert solver.state.past is not None
    monkeypatch.setattr(compaction, "COMPACT_AFTER", 100)
    text = "#step 9. _request(goal(c,99),10). #endstep."
    assert ask(solver, text) == ask(other, text)


def test_solvers_that_are_not_shortest_forget_nothing():
    solver = ReactiveSolver(ReactiveProgram.from_text(WALK))
    solver.forget_before(5)
    assert solver.state.keep_from == 0


def concerns(statement, first):
    """Whether all atoms of the statement are about steps from ``first`` on, as far as one can tell."""
    atoms = [one.atom for one in statement.body] + ([] if statement.head is None else [statement.head])
    return all(not atom.arguments or atom.arguments[-1].number >= first for atom in atoms)


def decide(draw, steps):
    """Constraints that settle the program's choices at ``steps``."""
    names = [one for step in steps for one in (f"p({step})", f"q({step})")]
    atoms = [parse_atom(name) for name in names]
    return [Statement(None, (Literal(atom, atom.name == "q" or draw(st.booleans())),)) for atom in atoms]


@pytest.mark.slow
@given(PARTS.filter(lambda parts: not parts.opens), st.data(), st.integers(0, 2))
def test_answers_equal_those_of_a_solver_that_only_forgets(parts, data, margin):
    """Random programs: where steps are decided or not, answers are as if their externals had been forgotten."""
    program = ReactiveProgram.from_text(parts.text())
    compacting, forgetting = (ReactiveSolver(program, models=0, shortest=True) for _ in range(2))
    step = decided = first = 1
    for number, update in enumerate(data.draw(st.lists(UPDATES, min_size=2, max_size=6))):
        update = without_strangers(parts, update)
        first = max(first, min(step, update.step) - margin)
        step = max(step, update.step)
        items = [one for one in update.items if not isinstance(one, Statement) or concerns(one, first)]
        compacting.forget_before(first)
        forget = [Forget(1, first - 1)] if first > 1 else []
        choices = ["a", "b"] if number == 0 and data.draw(st.booleans()) else []
        settle = [Statement(None, (Literal(parse_atom(name), data.draw(st.booleans())),)) for name in choices]
        settle += decide(data.draw, range(decided, step + 1))
        decided = step + 1
        found = compacting.update(replace(update, items=(*settle, *items), step=step))
        expected = forgetting.update(replace(update, items=(*settle, *forget, *items), step=step))
        assert found.outcome is expected.outcome
        assert set(found.answers) == set(expected.answers), (parts.text(), str(update), first)
        if found.permanent:
            return


@pytest.mark.slow
@pytest.mark.once
@pytest.mark.parametrize("seed", [0, 2])
def test_a_withdrawal_after_a_checkpoint_has_the_verdict_of_the_whole_history(seed):
    """And what was picked up for a request, of a package that no correction names, was not without it."""
    stream, step, items, asked, picked = Planned("mailbot", 100 + seed), 0, [], set(), set()
    compacting = stream.solver
    whole = ReactiveSolver(compacting.program, shortest=True, oclingo_strings=False, log_limit=1000)
    for _ in range(10):
        items += stream.events()
        stream.step = step = step + 1
        asked |= {parse_atom(one) for one in items if one.startswith("_request(goal")}
        compacting.forget_before(step - 4)
        text = f"#step {step} : {STEPS}. " + " ".join(f"{item}." for item in items) + " #endstep."
        result, other = compacting.update(parse_update(text)), whole.update(parse_update(text))
        assert result.outcome is other.outcome, text
        if result.outcome is not SolveOutcome.SATISFIABLE:
            return
        compacting.begin_log_anew()
        for one in [one for one in asked if one.arguments[1].number > step - 3]:
            verdicts = [outcome_without(solver, one) for solver in (compacting, whole)]
            assert verdicts[0] is verdicts[1], (text, str(one))
            if str(one.arguments[0].arguments[-1]) in picked:
                assert verdicts[0] is SolveOutcome.UNSATISFIABLE, (text, str(one))
        items = stream.outcomes(result)
        returned = [parse_atom(item) for item in items if item.startswith("_return(pickup")]
        picked |= {str(one.arguments[1]) for one in returned} - {"1", "2", "777"}  # what corrections name
        assert whole.log.length > compacting.log.length


def outcome_without(solver, request):
    """The outcome after the same log without a request."""
    beside = ReactiveSolver(solver.program, shortest=True, oclingo_strings=False)
    beside.restore(solver.log.less(frozenset([request])))
    return beside.solve().outcome
