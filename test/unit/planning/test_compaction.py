"""Compaction: it changes no answer, and bounds the cost of long streams."""

from dataclasses import replace
from unittest import mock

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from plain_walk import LINE, next_update
from random_streams import PARTS, UPDATES, without_undeclared
from stream_logs import copied
from stream_play import atoms, compacting, planner_of, play
from workloads import sized

from rosoclingo.oclingo import ReactiveProgram, SolveOutcome, parse_atom, parse_update
from rosoclingo.oclingo.progression.updates import Expire, Forget, Literal, Statement
from rosoclingo.planning import grounding
from rosoclingo.planning import solver as solver_module
from rosoclingo.planning.grounding import Grounding
from rosoclingo.planning.question import Question
from rosoclingo.planning.snapshot import Snapshot
from rosoclingo.planning.solver import PlanSolver

pytestmark = pytest.mark.usefixtures("compacts_at_once")


def first(solver):
    """Return the first step of a grounding of the snapshot, None without compaction."""
    return None if solver.snapshot.past is None else solver.snapshot.past.first


def heads(result):
    """Return the heads in the warnings."""
    return [one.split(" ")[1] for one in result.warnings]


# ---- Random programs -------------------------------------------------------------------------------------------------


def concerns(statement, step):
    """Return whether the last arguments of all atoms in the statement are at least ``step``."""
    mentioned = [one.atom for one in statement.body] + ([] if statement.head is None else [statement.head])
    return all(not atom.arguments or atom.arguments[-1].number >= step for atom in mentioned)


def decide(draw, names):
    """Draw constraints that decide choices of the program."""
    return [Statement(None, (Literal(parse_atom(name), name[0] == "q" or draw(st.booleans())),)) for name in names]


@pytest.mark.slow
@given(PARTS.filter(lambda parts: not parts.opens), st.data(), st.integers(0, 2))
def test_compaction_gives_the_answers_of_forgetting(parts, data, margin):
    """Answers are as if the externals of the steps had been forgotten, decided or not."""
    program = ReactiveProgram.from_text(parts.text())
    compacting, forgetting = (PlanSolver(program, models=0) for _ in range(2))
    step = decided = begin = 1
    for number, update in enumerate(data.draw(st.lists(UPDATES, min_size=2, max_size=6))):
        update = without_undeclared(parts, update)
        begin = max(begin, min(step, update.step) - margin)
        step = max(step, update.step)
        items = [one for one in update.items if not isinstance(one, Statement) or concerns(one, begin)]
        forget = [Forget(1, begin - 1)] if begin > 1 else []
        names = ["a", "b"] if number == 0 and data.draw(st.booleans()) else []
        settle = decide(data.draw, [*names, *(f"{name}({one})" for one in range(decided, step + 1) for name in "pq")])
        decided = step + 1
        found = compacting.update(replace(update, items=(Expire(begin), *settle, *items), step=step))
        expected = forgetting.update(replace(update, items=(*settle, *forget, *items), step=step))
        assert found.outcome is expected.outcome
        assert set(found.answers) == set(expected.answers), (parts.text(), str(update), begin)
        if found.outcome is SolveOutcome.SATISFIABLE:
            assert found.horizon == expected.horizon
        elif found.permanent or compacting.horizon != forgetting.horizon:
            return  # the forgetting solver can detect unsatisfiability before the bound


# ---- The compacted steps ---------------------------------------------------------------------------------------------

CHOICES = "{ x ; y }. #external door. #external sees/1. #external seen/2. "
STEP = "#program cumulative(t). #external e(t). c(t) :- e(t). late(t) :- e(t-2). "
MARKS = "#theory marks { term { - : 1, unary }; &mark/0 : term, any }. "


def compact(text, *updates, steps=8, every=1):
    """Play one update per step with and without compaction, compare the answers, and return the compacting solver.

    ``every``: the number of steps after which the steps before the last one are declared over.
    """
    compacting, forgetting = planner_of(text, models=0), planner_of(text, models=0)
    for step in range(1, steps + 1):
        update = updates[step - 1] if step <= len(updates) else ""
        over = f"#over {step - 1}. " if step % every == 0 else ""
        forgotten = f"#forget 1..{step - 2}. " if step > 2 else ""
        found = play(compacting, f"#step {step} : 0. {over}{update}")
        expected = play(forgetting, f"#step {step} : 0. {forgotten}{update}")
        assert set(found.answers) == set(expected.answers), step
        assert heads(found) == heads(expected), step
    return compacting


@pytest.mark.slow
@pytest.mark.parametrize(
    ("rules", "updates", "reached"),
    [
        # facts and constraints
        ("", ["e(1).", ":- e(1), x."], 7),
        # rules of the program
        ("_action_lib(go,x,t-2) :- e(t), t > 2.", ["", "", "e(3)."], 7),
        ("door :- e(t), t = 1. gate :- e(t), t = 2. #external gate : t = 1.", ["e(1)."], 7),
        (":- late(t), 1 { x ; y }.", ["", "e(2)."], 7),
        ("p(t). #volatile t : 3. :- not p(t).", [], 6),
        # atoms that are not fixed
        (":- t = 3, #sum { 1,x : x ; 1,y : y } > 1.", [], 3),
        (f"{MARKS} p(t) :- &mark.", [], None),
        # statements with a body that define the atom of a step
        ("", ["e(1) :- x. e(1) :- y.", ":- not c(1)."], None),
        ("d(t) :- sees(t).", ["", "sees(6) :- x. :- not sees(6)."], 6),
        # lapsing statements
        ("", ["", ":- c(1). #volatile : 9. e(1) :- x."], None),
        ("s(t) :- x.", ["", "#volatile. :- not x."], None),
    ],
)
def test_compaction_keeps_answers_of_any_statements(rules, updates, reached):
    text = f"{CHOICES}{STEP}{rules} #program volatile(t)."
    assert first(compact(text, *updates)) == reached
    if sized(False, True):
        compact(text, *updates, every=4)


# ---- Long streams of a robot -----------------------------------------------------------------------------------------

#: Answers show all atoms, so that no update is predicted and each is searched.
ROBOT = LINE.replace("#show _action_lib/3.", "") + "#external blocked(t). :- blocked(t), moved(t).\n"


@pytest.mark.slow
def test_facts_of_compacted_steps_are_too_late():
    """Also for a solver that restored the history of another one."""
    solver, reader = planner_of(ROBOT), planner_of(ROBOT)
    for cycle in range(9):
        request = [f"_request({cycle // 2 % 2},{cycle + 2})"] if cycle % 2 == 0 else []
        solver.update(next_update(solver, *request, further=[Expire(max(cycle, 1))]))
    reader.restore(copied(solver.log))
    for one in (solver, reader):
        result = play(one, "#step 11. blocked(3). blocked(11). _request(1,4).")
        assert [line.split(".")[0] for line in result.warnings] == [
            "Head blocked(3) comes too late: steps before 8 are compacted",
            "Head _request(1,4) comes too late: steps before 8 are compacted",
        ]
        assert "blocked(11)" in atoms(result)


# ---- Closed steps ----------------------------------------------------------------------------------------------------

CORRIDOR = """
place(1..9). at(5,0).
#external _request/2. #external _wet/2.
#cumulative t.
#external seen(t). #external slipped(t).
{ _action_lib(go,(A-1;A+1),t) } 1 :- at(A,t-1), not _wet(A,t).
gone(t) :- _action_lib(go,B,t), not slipped(t).
at(B,t) :- _action_lib(go,B,t), place(B), not slipped(t).
at(A,t) :- at(A,t-1), not gone(t).
been(A,t) :- at(A,t), seen(t).
been(A,t) :- been(A,t-1).
wanted(A,t) :- _request(A,t).
wanted(A,t) :- wanted(A,t-1), not at(A,t-1).
#volatile t.
:- wanted(A,t), not at(A,t).
"""


def walk(solver, places, facts=(), bound=20):
    """Visit the ``places`` one per cycle, with one of the ``facts`` in each update."""
    for step, (here, place) in enumerate(zip(places, places[1:]), 2):
        done = f":- not _action_lib(go,{place},{step - 1}). " if place != here else ""
        more = " ".join(facts[step - 2 : step - 1])
        play(solver, f"#step {step} : {bound}. #closed {step - 1}..{step - 1}. {done}{more}")
    return solver


CORRIDOR_PROGRAM = ReactiveProgram.from_text(CORRIDOR)
FACTS_ABOUT_IT = st.one_of(
    st.builds("{}({}).".format, st.sampled_from(["seen", "slipped"]), st.integers(1, 9)),
    st.builds("_wet({},{}).".format, st.integers(3, 7), st.integers(1, 9)),
    st.builds("_request({},{}).".format, st.integers(1, 9), st.integers(1, 9)),
    st.builds("p({0}) :- q({0}). q({0}).".format, st.integers(1, 3)),
    st.builds(":- at({},{}).".format, st.integers(3, 7), st.integers(1, 9)),
    st.builds("#assert : a. _wet({},{}).".format, st.integers(3, 7), st.integers(1, 9)),
    st.builds("#forget {0}..{0}.".format, st.integers(1, 5)),
)


@pytest.mark.slow
@example([-1, -1], ["#forget 1..1.", "seen(1)."], 1, 0)
@given(
    st.lists(st.sampled_from([-1, 0, 1]), min_size=1, max_size=7),
    st.lists(FACTS_ABOUT_IT, max_size=7),
    st.integers(1, 3),
    st.integers(0, 3),
)
def test_closed_steps_ground_together_give_the_same_answers(moves, facts, block, over):
    """There are none if a late fact contradicts an executed action."""
    places = [5]
    for move in moves:
        places.append(places[-1] + move)
    solver = walk(PlanSolver(CORRIDOR_PROGRAM, models=0), places, facts, bound=2)
    snapshot, found = replace(solver.snapshot, keep_from=over), []
    assumable = frozenset(snapshot.permanent_facts())
    together = Snapshot.closed_until
    for closed_until, assumed in (
        (lambda self, first: first - 1, frozenset()),
        (together, frozenset()),
        (together, assumable),
    ):
        with mock.patch.object(grounding, "CLOSED_PIECE", block):
            with mock.patch.object(Snapshot, "closed_until", closed_until):
                one = Grounding(CORRIDOR_PROGRAM, snapshot, snapshot.horizon, assumed)
        for last in (snapshot.horizon, snapshot.horizon + 1):
            if last > one.horizon:
                one.grow_to(last)
            found.append(set(one.ask(Question(last, last, models=0), lambda: False).answers))
    assert found[:2] == found[2:4] == found[4:]


@pytest.mark.slow
def test_updates_without_a_plan_do_not_delay_compaction():
    """The solver goes back and drops them, as a core does."""
    solver = PlanSolver(CORRIDOR_PROGRAM, plan_time=0.0)
    solver.update(parse_update("#step 1 : 20. _request(9,2). _request(1,2). #endstep."))
    with compacting(3):
        for cycle in range(1, 20):
            log, update = solver.log, next_update(solver, further=[Expire(cycle)])
            hopeless = next_update(solver, f"_request(99,{cycle + 1})", further=[Expire(cycle)])
            assert solver.search(hopeless, lambda: False).outcome is SolveOutcome.UNSATISFIABLE
            solver.restore(log)
            assert solver.search(update, lambda: False).answers
            assert cycle < 6 or first(solver) > cycle - 3


@pytest.mark.slow
def test_past_is_compacted_while_the_robot_acts():
    """This does not require that updates are predicted."""
    solver = PlanSolver(CORRIDOR_PROGRAM, plan_time=0.0)
    solver.update(parse_update("#step 1 : 20. _request(9,2). _request(1,2). #endstep."))
    with mock.patch.object(solver_module, "MANY_STEPS", 1000):
        for cycle in range(1, 31):
            assert solver.search(next_update(solver, further=[Expire(cycle)]), lambda: False).answers
            solver.compact()
    assert first(solver) > 10
