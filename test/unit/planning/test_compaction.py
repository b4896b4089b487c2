"""Compaction: answers stay the same, and a long stream costs no more than a short one."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from random_streams import PARTS, UPDATES, without_strangers
from recorded_streams import STEPS, Planned
from stream_logs import copied

from rosoclingo.oclingo import (
    DroppedError,
    ReactiveProgram,
    SolveOutcome,
    SolverError,
    commitment,
    parse_atom,
    parse_update,
)
from rosoclingo.oclingo.progression.updates import Forget, Literal, Over, Statement, StreamUpdate
from rosoclingo.planning import compaction, grounding
from rosoclingo.planning import solver as solver_module
from rosoclingo.planning.history import AcceptedUpdate, Checkpoint, History
from rosoclingo.planning.solver import PlanSolver

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
def test_answers_show_the_latest_retired_steps_alone():
    answers = drive(walk(), 80, 0)
    for cycle, shown in ((10, False), (80, True)):
        assert any(atom.startswith("at(") and atom.endswith(f",{cycle})") for atom in answers[-1]) is shown
    assert sum("_action_lib" in atom for atom in answers[-1]) < 50
    assert max(map(len, answers[40:])) < 2 * max(map(len, answers[20:40])), "a long stream's answers are no larger"


PROGRAM = ReactiveProgram.from_text(WALK)


def walk():
    return PlanSolver(PROGRAM)


def past(cycle, before, margin=None):
    """The items by which the update of a cycle closes the one before; steps that lie so far back are over."""
    items = [f"#closed {cycle - 1}."] if cycle > 1 else []
    items += [f"#over {cycle - margin}."] if margin is not None and cycle > margin else []
    return " ".join([*items, *(f":- not {action}." for action in before)])


def ask(solver, text):
    """Feed an update; return the answer as text, and the actions planned for its cycle."""
    result = solver.update(parse_update(text))
    assert result.outcome is SolveOutcome.SATISFIABLE
    answer = result.answers[0]
    step = result.step
    executed = [atom for atom in answer if atom.name == "_action_lib" and atom.arguments[2].number == step]
    return sorted(map(str, answer)), executed


def drive(solver, cycles, margin, improves=False):
    """Go round and round; return all answers. In each cycle it may be looked for better plans until there are none."""
    answers, before = [], []
    for cycle in range(1, cycles + 1):
        goal = "abc"[cycle % 3]
        text = f"#step {cycle}. {past(cycle, before, margin)} "
        text += f"_request(goal({goal},{cycle}),{cycle + 1}). " if cycle % 2 else ""
        answer, before = ask(solver, text + "#endstep.")
        answers.append(answer)
        if improves:
            solver.restore(
                solver.log.adopt(solver.log.plan._replace(horizon=solver.log.plan.horizon + 3, shortest=False))
            )
            while solver.improve() is not None:
                pass
    return answers


@pytest.mark.slow
@pytest.mark.parametrize("cycles", [12, 13])
def test_steps_are_retired_after_a_vain_improvement(cycles):
    solver = PlanSolver(PROGRAM, plan_time=0.0)
    drive(solver, cycles, 0, improves=True)
    assert solver.snapshot.past.first == cycles


@pytest.mark.slow
@pytest.mark.parametrize("margin", [0, 1, 5])
def test_answers_stay_the_same(margin, monkeypatch):
    monkeypatch.setattr(compaction, "SHOWN_STEPS", 100)
    solver = walk()
    answers = drive(solver, 30, margin)
    assert solver.snapshot.past.first >= 30 - margin - 1
    assert answers == drive(walk(), 30, None)


@pytest.mark.slow
def test_snapshot_does_not_grow():
    solver = walk()
    drive(solver, 60, 2)
    snapshot = solver.snapshot
    assert len(snapshot.past.facts) < 12
    assert snapshot.size + len(snapshot.closed) < 36


@pytest.mark.slow
@pytest.mark.parametrize("offset", [-3, 0, 1, 3])
@pytest.mark.parametrize("name", ["t", "T"])
def test_snapshot_does_not_grow_wherever_a_step_has_its_actions(offset, name):
    head = f"{{ _action_lib(go,x,{name}+{offset}) }} :- now(T), t-1 < T, T <= t"
    text = f"#program cumulative(t). now(t). {head}. #program volatile(t)."
    solver = PlanSolver(ReactiveProgram.from_text(text), models=0)
    for cycle in range(1, 16):
        answers = solver.update(parse_update(f"#step {cycle} : 0. {past(cycle, (), 0)} #endstep.")).answers
        assert len(answers) == (2 if 0 <= offset < cycle else 1), "each cycle is closed without an action"
    assert solver.snapshot.past.first >= 14 - max(offset, 0)
    assert name == "T" or len(solver.snapshot.closed) <= 6


@pytest.mark.slow
def test_cycles_without_possible_actions_are_retired(monkeypatch):
    monkeypatch.setattr(grounding, "PIECE", 64)
    monkeypatch.setattr(solver_module, "BLOCK", 8)
    text = WALK.replace("not blocked(t).", "not blocked(t), t \\ 5 = 1.")
    solver = PlanSolver(ReactiveProgram.from_text(text))
    before = []
    for cycle in range(1, 41):
        text = f"#step {cycle}. {past(cycle, before, 3)} "
        text += f"_request(goal({'abc'[cycle // 5 % 3]},{cycle}),{cycle + 1}). " if cycle % 5 == 1 else ""
        _, before = ask(solver, text + "#endstep.")
    assert solver.snapshot.past.first >= 36


def test_choices_of_base_that_the_past_has_decided_stay_so():
    text = "#base.\n{ a }.\n#cumulative t.\nc(t) :- not a.\n:- c(t-1).\n#volatile t.\n"
    solver = PlanSolver(ReactiveProgram.from_text(text), models=0)
    for step in (3, 4, 5):
        answers = solver.update(parse_update(f"#step {step} : 0. #over {step}. #endstep.")).answers
        assert answers == (frozenset([parse_atom("a")]),)
    assert solver.snapshot.past.first > 2
    assert len(list(solver.snapshot.permanent)) == 1


def test_facts_of_retired_steps_are_too_late():
    """For a solver that reads the history of another one as well."""
    solver, reader = walk(), walk()
    drive(solver, 10, 2)
    reader.restore(copied(solver.log))
    assert reader.snapshot.past == solver.snapshot.past
    for one in (solver, reader):
        result = one.update(parse_update("#step 11. blocked(3). blocked(11). _request(goal(b,3),4). #endstep."))
        assert [line.split(".")[0] for line in result.warnings] == [
            "Head blocked(3) comes too late: steps before 8 are compacted",
            "Head _request(goal(b,3),4) comes too late: steps before 8 are compacted",
        ]
        assert parse_atom("blocked(11)") in result.answers[0]


def test_facts_that_later_steps_see_are_never_too_late():
    solver = walk()
    drive(solver, 10, 2)
    for step, items in ((11, "sees(x,3)."), (12, "#over 11."), (13, ""), (14, "")):
        result = solver.update(parse_update(f"#step {step}. {items} #endstep."))
        assert not result.warnings
        assert parse_atom(f"seen(x,{step})") in result.answers[0]


def test_predicted_updates_are_compacted_between_searches(searches):
    """They take no search; what they make of the history is compacted when it is shortened."""
    text = WALK.replace("next(a,b). next(b,c). next(c,a).", "next(X,X+1) :- X = 0..19.").replace("at(a,0)", "at(0,0)")
    text += "#show _action_lib/3. #program cumulative(t). #external _return/3. "
    text += "failed(t) :- _action_lib(go,X,t), _return(go,Y,t), X != Y.\n"
    solver, other = (PlanSolver(ReactiveProgram.from_text(text)) for _ in range(2))
    for one in (solver, other):
        one.update(parse_update("#step 1 : 20. _request(goal(9,1),1). #endstep."))
    asked = len(searches)
    for step in range(2, 9):
        (done,) = [one for one in solver.log.plan.actions if one.arguments[2].number == step - 1]
        told = f":- not {done}. _return(go,{done.arguments[1]},{step - 1})."
        for one, over in ((solver, f"#over {step - 1}."), (other, "")):
            one.update(parse_update(f"#step {step} : 20. #closed {step - 1}. {over} {told} #endstep."))
    assert len(searches) == asked
    solver.checkpoint()
    assert len(searches) == asked + 1, "the predicted answer is asked for, with all its actions given"
    assert solver.snapshot.past.first >= 6
    assert other.snapshot.past is None
    update = parse_update("#step 9 : 20. #closed 8. blocked(9). :- not _action_lib(go,8,8). #endstep.")
    mine, its = solver.update(update), other.update(update)
    assert (mine.outcome, mine.horizon) == (its.outcome, its.horizon) == (SolveOutcome.SATISFIABLE, 10)


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
def test_compacting_solver_answers_as_one_that_forgets(parts, data, margin):
    """Random programs: where steps are decided or not, answers are as if their externals had been forgotten."""
    program = ReactiveProgram.from_text(parts.text())
    compacting, forgetting = (PlanSolver(program, models=0) for _ in range(2))
    step = decided = first = 1
    for number, update in enumerate(data.draw(st.lists(UPDATES, min_size=2, max_size=6))):
        update = without_strangers(parts, update)
        first = max(first, min(step, update.step) - margin)
        step = max(step, update.step)
        items = [one for one in update.items if not isinstance(one, Statement) or concerns(one, first)]
        forget = [Forget(1, first - 1)] if first > 1 else []
        choices = ["a", "b"] if number == 0 and data.draw(st.booleans()) else []
        settle = [Statement(None, (Literal(parse_atom(name), data.draw(st.booleans())),)) for name in choices]
        settle += decide(data.draw, range(decided, step + 1))
        decided = step + 1
        found = compacting.update(replace(update, items=(Over(first), *settle, *items), step=step))
        expected = forgetting.update(replace(update, items=(*settle, *forget, *items), step=step))
        assert found.outcome is expected.outcome
        assert set(found.answers) == set(expected.answers), (parts.text(), str(update), first)
        if found.outcome is SolveOutcome.SATISFIABLE:
            assert compacting.horizon == forgetting.horizon
        elif found.permanent or compacting.horizon != forgetting.horizon:
            return  # the one that forgets may have seen before the bound that there is no answer


@pytest.mark.slow
@pytest.mark.once
@pytest.mark.parametrize("seed", [0, 2])
def test_withdrawal_after_checkpoint_has_verdict_of_whole_history(seed):
    """And no package is picked up without its request, unless a correction names it."""
    stream, step, items, asked, picked = Planned("mailbot", 100 + seed), 0, [], set(), set()
    compacting = stream.solver
    whole = PlanSolver(compacting.program, log_limit=1000)
    for _ in range(10):
        items += stream.events()
        stream.step = step = step + 1
        asked |= {parse_atom(one) for one in items if one.startswith("_request(goal")}
        update = parse_update(f"#step {step} : {STEPS}. " + " ".join(f"{item}." for item in items) + " #endstep.")
        over = replace(update, items=(Over(step - 4), *update.items))
        result, other = compacting.update(over), whole.update(update)
        assert result.outcome is other.outcome, str(update)
        if result.outcome is not SolveOutcome.SATISFIABLE:
            return
        compacting.checkpoint()
        for one in [one for one in asked if one.arguments[1].number > step - 3]:
            verdicts = [outcome_without(solver, one) for solver in (compacting, whole)]
            assert verdicts[0] is verdicts[1], (str(update), str(one))
            if str(one.arguments[0].arguments[-1]) in picked:
                assert verdicts[0] is SolveOutcome.UNSATISFIABLE, (str(update), str(one))
        items = stream.outcomes(result)
        returned = [parse_atom(item) for item in items if item.startswith("_return(pickup")]
        picked |= {str(one.arguments[1]) for one in returned} - {"1", "2", "777"}  # what corrections name
        assert whole.log.length > compacting.log.length


def outcome_without(solver, request):
    """The outcome after the same history without a request."""
    beside = PlanSolver(solver.program)
    beside.restore(solver.log.withdraw(frozenset([request])))
    return beside.solve().outcome


class Trip:
    """A stream on which checkpoints, compactions, withdrawals and lost updates may come between any two updates.

    Attributes:
        solver: the solver under test.
        whole: its history without any checkpoint.

    """

    LIMIT = 30

    def __init__(self, data):
        self.draw = data.draw
        self.solver = self.new_solver()
        self.whole, self.read = History(), self.solver.log
        self.step, self.over, self.planned, self.committed, self.told = 0, 1, [], set(), set()

    def new_solver(self, **options):
        return PlanSolver(PROGRAM, horizon_limit=self.LIMIT, **options)

    def text(self):
        """The next update: what was done of the plan, and what else may be told."""
        cycle, facts, draw = self.step + 1, [], self.draw
        if draw(st.booleans()):
            facts.append(f"_request(goal({draw(st.sampled_from('abc'))},{cycle}),{cycle + 1})")
        if draw(st.integers(0, 3)) == 0:
            facts.append(f"blocked({cycle + draw(st.sampled_from([0, 1, -1]))})")
        over = f"#over {self.over}." if draw(st.booleans()) else ""
        done = " ".join(f":- not {one}." for one in self.planned)
        closed = f"#closed {cycle - 1}." if self.step else ""
        return f"#step {cycle} : 6. {closed} {over} {done} {' '.join(f'{one}.' for one in facts)} #endstep."

    def update(self):
        """The solver and one that begins from the whole history give the same answer to the next update."""
        update, twin = parse_update(self.text()), self.new_solver(log_limit=1000)
        twin.restore(self.whole)
        mine, its = self.solver.update(update), twin.update(update)
        assert (mine.outcome, mine.horizon) == (its.outcome, its.horizon), self.whole.text()
        assert {warning.split()[1] for warning in its.warnings} <= {warning.split()[1] for warning in mine.warnings}
        self.step += 1
        self.committed |= update.committed
        self.told |= {head for head in update.heads if head is not None}
        actions = mine.answers[0] if mine.answers else ()
        self.planned = sorted(
            one for one in actions if one.name == "_action_lib" and one.arguments[2].number == self.step
        )

    def checkpoint(self):
        self.solver.restore(self.solver.log.checkpoint(self.solver.snapshot))

    def compact(self):
        self.over = max(self.over, self.step - self.draw(st.integers(0, 2)))
        over = AcceptedUpdate(StreamUpdate(items=(Over(self.over),)), self.solver.horizon)
        self.solver.restore(self.solver.log.with_entries(over))
        self.solver.checkpoint()

    def withdraw(self):
        recent = sorted(one for one in self.told | self.committed if one.arguments[-1].number >= self.over)
        if recent:
            facts = self.draw(st.sets(st.sampled_from(recent), min_size=1, max_size=2))
            self.solver.restore(self.solver.log.withdraw(frozenset(facts)))
            self.committed -= facts
            self.told -= facts

    def drop(self):
        before = self.solver.log
        with pytest.raises(DroppedError):
            self.solver.update(parse_update(f"sees(x,{self.step}). {self.text()}"), dropped=lambda: True)
        assert self.solver.log is before

    def refuse(self):
        before = self.solver.log
        with pytest.raises(SolverError, match="beyond the horizon limit"):
            self.solver.update(parse_update(f"#step {self.LIMIT + 1} : 0. _request(goal(a,0),2). #endstep."))
        assert self.solver.log is before

    def check(self):
        """Each committed action of a closed cycle has its commitment, or is retired."""
        entries = self.solver.log.entries_after(self.read)
        self.whole = self.whole.with_entries(*(one for one in entries if not isinstance(one, Checkpoint)))
        self.read, snapshot = self.solver.log, self.solver.snapshot
        known, first = set(snapshot.permanent), 0 if snapshot.past is None else snapshot.past.first
        for cycle, executed in snapshot.closed.items():
            for action in executed & self.committed:
                assert cycle < first or commitment(action) in known, self.solver.log.text()
        kept = {one for one in self.committed if one.arguments[2].number >= first}
        assert kept == {one for executed in snapshot.closed.values() for one in executed if one in kept}


EVENTS = st.lists(st.sampled_from(["checkpoint", "compact", "compact", "withdraw", "drop", "refuse"]), max_size=3)


@pytest.mark.slow
@given(st.data())
def test_whatever_happens_between_updates_the_whole_history_answers_alike(data):
    trip = Trip(data)
    for events in data.draw(st.lists(EVENTS, min_size=2, max_size=8)):
        trip.update()
        trip.check()
        for event in events:
            getattr(trip, event)()
            trip.check()
