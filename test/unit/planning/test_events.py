"""Random streams with events between the updates: each answer is one of the whole history.

After any checkpoint, compaction, withdrawal or dropped update, the snapshot supports every committed action, and a
solver that begins from the whole history gives the same answers.
"""

from random import Random

import pytest
from foreign_programs import SOUND
from hypothesis import event, given, settings
from hypothesis import strategies as st
from plain_walk import EARLY, next_update
from recorded_streams import PLANNED
from stream_logs import text_of
from stream_play import check_answer, compacting, delay_plan, interrupt, stop_after

from rosoclingo.oclingo import ReactiveProgram, SolverError, StreamUpdate, commitment
from rosoclingo.oclingo.progression.updates import Expire
from rosoclingo.planning.history import AcceptedUpdate, Checkpoint, History, Plan, cycle_of
from rosoclingo.planning.solver import PlanSolver

RING = ReactiveProgram.from_text(
    """
#program base.
at(a,0). next(a,b). next(b,c). next(c,a).
#program cumulative(t).
#external blocked(t). #external _request/2.
{ _action_lib(go,Y,t) : next(X,Y) } 1 :- at(X,t-1), not blocked(t).
at(Y,t) :- _action_lib(go,Y,t).
at(X,t) :- at(X,t-1), not _action_lib(go,Y,t) : next(X,Y).
wanted(X,t) :- _request(goal(X,Id),t).
wanted(X,t) :- wanted(X,t-1), not at(X,t-1).
#program volatile(t).
:- wanted(X,t), not at(X,t).
"""
)
LINE = ReactiveProgram.from_text(EARLY)
#: The first steps have no action.
LATE = ReactiveProgram.from_text(EARLY + ":- _action_lib(A,X,t), t < 4.")
PROGRAMS = {"ring": lambda: RING, "line": lambda: LINE, "late": lambda: LATE}
PROGRAMS.update({name: PLANNED[name] for name in ("mailbot", *SOUND)})
#: Patterns of facts from outside; ``{}`` is the cycle.
FACTS = {
    "ring": "blocked({})",
    "mailbot": "_blocked(office1,office2,{})",
    "vacuum": "_locked(2,{})",
    "gripper": "_slippery(red,{})",
    "lift": "_held({})",
    "patrol": "_rain(gate,{})",
}


def goal_of(name, draw, number):
    """Return a random goal of a program, with this number."""
    if name == "ring":
        return f"goal({draw.choice('abc')},{number})"
    if name == "mailbot":
        return f"goal(office{draw.randint(1, 4)},office{draw.randint(1, 4)},{number})"
    return draw.choice(SOUND[name][1]) if name in SOUND else str(draw.randint(-3, 4))


class Trip:
    """A stream with checkpoints, compactions, withdrawals, lost updates and improvements between its updates.

    Attributes:
        solver: the solver under test; it drops updates while it is ``dropping``.
        whole: its history without checkpoints.
        committed: the executed actions that were not withdrawn.

    """

    LIMIT = 60

    def __init__(self, name, draw, plan_time, models=1):
        self.name, self.draw, self.plan_time, self.models = name, draw, plan_time, models
        limit = draw.choice([2, 10, 100])
        self.solver = self.new_solver(plan_time=plan_time, log_limit=limit)
        if plan_time is not None:  # the first plans are long, as the first grounding has many steps
            self.solver.restore(History().with_entries(AcceptedUpdate(None, draw.randint(8, 16))))
        self.whole = self.read = self.solver.log
        self.result, self.over, self.goals, self.facts, self.committed = None, 0, 0, set(), set()

    def new_solver(self, **options):
        return PlanSolver(PROGRAMS[self.name](), models=self.models, horizon_limit=self.LIMIT, **options)

    @property
    def first(self):
        """The first cycle that is not compacted."""
        return 0 if self.solver.snapshot.past is None else self.solver.snapshot.past.first

    @staticmethod
    def plans(result, first):
        """Return the actions of each answer from the cycle ``first`` on."""
        return {Plan.from_atoms(answer, result.horizon).rest(first).actions for answer in result.answers}

    def next(self):
        """Return the next update, with executed actions, goals and facts."""
        draw, cycle, atoms = self.draw, self.solver.step + 1, []
        if draw.random() < 0.4:
            self.goals += 1
            atoms.append(f"_request({goal_of(self.name, draw, self.goals)},{cycle + 1})")
        if self.name in FACTS and draw.random() < 0.2:
            atoms.append(FACTS[self.name].format(cycle + draw.choice([0, 1, -1])))
        over = [Expire(self.over)] if self.over and draw.random() < 0.5 else []
        return next_update(self.solver, *atoms, fails=draw.random() < 0.1, further=over)

    def update(self):
        """Check that the next update gets the answers of a solver that begins from the whole history.

        Of longer plans and single ones there can be others, so only their validity is checked.
        """
        update, plan, twin = self.next(), self.solver.log.plan, self.new_solver(log_limit=1000)
        twin.restore(self.whole)
        first, before = self.first, {one for one in self.committed if cycle_of(one) >= self.first}
        mine, its = self.solver.update(update), twin.update(update)
        assert mine.outcome is its.outcome, text_of(self.whole)
        assert {one.split()[1] for one in its.warnings} <= {one.split()[1] for one in mine.warnings}
        assert self.plan_time is not None or mine.horizon == its.horizon, text_of(self.whole)
        assert self.models == 1 or self.plans(mine, first) == self.plans(its, first), text_of(self.whole)
        self.result = mine
        self.committed |= update.committed
        self.facts |= {head for head in update.heads if head is not None}
        if mine.answers:
            assert its.horizon <= mine.horizon
            assert all(actions >= before | update.committed for actions in self.plans(mine, first))
            check_answer(self.solver, mine)
        else:
            assert self.solver.log.plan == plan, "the last plan stays in force"
            self.solver.restore(self.solver.log.adopt(Plan(frozenset(), self.solver.horizon)))

    def checkpoint(self):
        self.solver.checkpoint()

    def compact(self):
        self.over = max(self.over, self.solver.step - self.draw.randint(0, 2))
        over = AcceptedUpdate(StreamUpdate(items=(Expire(self.over),)), self.solver.horizon)
        self.solver.restore(self.solver.log.with_entries(over))
        self.solver.checkpoint()

    def withdraw(self):
        recent = sorted(one for one in self.facts | self.committed if one.arguments[-1].number >= self.over)
        facts = set(self.draw.sample(recent, min(len(recent), self.draw.randint(1, 2))))
        self.solver.restore(self.solver.log.withdraw(frozenset(facts)))
        self.committed -= facts
        self.facts -= facts

    def drop(self):
        before = self.solver.log
        with pytest.raises(KeyboardInterrupt):
            self.solver.search(self.next(), interrupt)
        assert self.solver.log is before

    def refuse(self):
        before = self.solver.log
        with pytest.raises(SolverError, match="beyond the horizon limit"):
            self.solver.update(StreamUpdate(self.LIMIT + 1, 0))
        assert self.solver.log is before

    def improve(self):
        if self.plan_time is None or not self.result.answers:
            return
        plan = self.solver.log.plan
        delay_plan(self.solver, self.draw.randint(0, 2))
        better = self.solver.improve(stop_after(self.draw.choice([3, None, None])))
        if better is None:
            self.solver.restore(self.solver.log.adopt(plan))
            return
        event("shorter")
        assert Plan.from_result(better) == self.solver.log.plan
        check_answer(self.solver, better)

    def check(self):
        """Check that each committed action of a closed cycle has its commitment or is compacted."""
        entries = self.solver.log.entries_after(self.read)
        self.whole = self.whole.with_entries(*(one for one in entries if not isinstance(one, Checkpoint)))
        self.read, snapshot = self.solver.log, self.solver.snapshot
        known, first = set(snapshot.permanent), self.first
        for cycle, executed in snapshot.closed.items():
            for action in executed & self.committed:
                assert cycle < first or commitment(action) in known, text_of(self.solver.log)
        kept = {one for one in self.committed if cycle_of(one) >= first}
        assert kept == {one for executed in snapshot.closed.values() for one in executed if one in kept}


EVENTS = st.lists(st.sampled_from(["checkpoint", "compact", "compact", "withdraw", "drop", "refuse"]), max_size=3)
IMPROVEMENTS = st.lists(st.sampled_from(["checkpoint", "improve", "improve", "withdraw"]), max_size=4)


def play(trip, events):
    for between in events:
        trip.update()
        trip.check()
        for name in between:
            getattr(trip, name)()
            trip.check()


@pytest.mark.usefixtures("compacts_at_once")
def test_each_event_changes_no_answer():
    play(Trip("ring", Random(1), None, models=0), [["checkpoint"], ["compact"], ["withdraw", "drop", "refuse"], []])


@pytest.mark.slow
@pytest.mark.usefixtures("compacts_at_once")
@settings(max_examples=settings.default.max_examples // 2)
@given(
    st.sampled_from(sorted({*PROGRAMS} - {"mailbot"})),
    st.integers(0, 10**6),
    st.integers(0, 1),
    st.lists(EVENTS, min_size=2, max_size=8),
)
def test_events_between_updates_change_no_answer(name, seed, models, events):
    play(Trip(name, Random(seed), None, models), events)


@pytest.mark.sampled(4)
@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(PROGRAMS))
@settings(max_examples=settings.default.max_examples // 6)
@given(st.integers(0, 10**6), st.sampled_from([1, 16]), st.lists(IMPROVEMENTS, min_size=3, max_size=8))
def test_improved_plans_are_answers_of_the_whole_history(name, seed, least_steps, events):
    """After any predicted updates, checkpoints, compactions and withdrawals since the last search."""
    with compacting(least_steps):
        play(Trip(name, Random(seed), 0.0), events)
