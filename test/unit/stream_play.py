"""Plays updates given as text on the stream solvers, and returns or checks their answers."""

import time
from contextlib import contextmanager
from itertools import count
from types import SimpleNamespace
from unittest import mock

import pytest
from stream_logs import copied, cut, texts

from rosoclingo.oclingo import ReactiveProgram, ReactiveSolver, parse_atom, parse_update
from rosoclingo.planning import compaction
from rosoclingo.planning import solver as solver_module
from rosoclingo.planning.grounding import Grounding
from rosoclingo.planning.history import Plan, cycle_of
from rosoclingo.planning.question import Question
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.reasoning import stream_planner

IGNORED = "Head {} has not been declared external. The entire rule will be ignored."

#: The incremental solver and the planner.
SOLVERS = pytest.mark.parametrize("kind", [ReactiveSolver, PlanSolver])


def solver_of(text, kind=ReactiveSolver, **options):
    """Return a solver for a program given as text."""
    return kind(ReactiveProgram.from_text(text), **options)


def planner_of(text, **options):
    """Return a planner for a program given as text."""
    return solver_of(text, PlanSolver, **options)


def processor_clock(read):
    """Replace the processor time of the planner by ``read``."""
    clock = SimpleNamespace(perf_counter=time.perf_counter, process_time=read)
    return mock.patch.object(solver_module, "time", clock)


@contextmanager
def compacting(steps, shown=compaction.SHOWN_STEPS):
    """Let solvers compact after this number of steps, and show this number of past ones, as if a run were long."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(solver_module, "LEAST_STEPS", steps)
        patch.setattr(solver_module, "MANY_STEPS", steps)
        patch.setattr(stream_planner, "RECENT", steps)
        patch.setattr(compaction, "SHOWN_STEPS", shown)
        yield


def play(solver, text):
    """Play an update and return the result."""
    return solver.update(parse_update(text + " #endstep."))


def atoms(result):
    """Return the atoms of the first answer as sorted texts."""
    return sorted(map(str, result.answers[0]))


def plan(result):
    """Return the actions of the first answer as sorted texts."""
    return [str(one) for one in sorted(result.answers[0]) if one.name == "_action_lib"]


def check_answers(solver, line):
    """Play an update and compare its result.

    A line such as ``#step 2. e(1). => a | - ! e(1)`` has the answers after ``=>`` (``-``: an empty one), and after
    ``!`` the ignored heads.
    """
    update, _, expected = line.partition(" =>")
    result = play(solver, update)
    if expected:
        answers, _, ignored = expected.partition("!")
        assert texts(result) == {frozenset(one.split()) - {"-"} for one in answers.split("|") if one.strip()}, update
        assert [one for one in result.warnings if "declared" in one] == list(map(IGNORED.format, ignored.split()))


def check_stream(way, program, *updates):
    """Play updates in one of several ways, and compare their answers."""
    kind = PlanSolver if "planner" in way else ReactiveSolver
    solver = solver_of(program if "#volatile" in program else program + " #volatile t.", kind, models=0)
    for line in updates:
        if way == "regrounding":
            drop_grounding(solver)
        if way == "planner with a new solver for each update":
            log, solver = cut(solver), PlanSolver(solver.program, models=0)
            solver.restore(log)
        check_answers(solver, line)


def drop_grounding(solver):
    """Force an incremental solver to reground, by an update that fails."""
    with pytest.raises(KeyboardInterrupt):
        solver.update(parse_update("#step 99. #endstep."), interrupt)


def interrupt():
    """Raise an error; a stop callback that clingo does not expect."""
    raise KeyboardInterrupt


def stop_after(looks):
    """Return a stop callback that returns true after ``looks`` polls (None: never)."""
    numbers = count()
    return lambda: looks is not None and next(numbers) >= looks


def adopt(solver, actions, horizon):
    """Let the solver adopt a plan of these actions (atoms or texts), not proven to be shortest."""
    plan = Plan(frozenset(parse_atom(str(one)) for one in actions), horizon)
    solver.restore(solver.log.adopt(plan))
    return plan


def delayed(action, steps):
    """Return the action delayed by some steps."""
    kind, what, cycle = action.arguments
    return parse_atom(f"_action_lib({kind},{what},{cycle.number + steps})")


def delay_plan(solver, steps):
    """Let the solver adopt its plan with all future actions delayed by ``steps``."""
    plan, step = solver.log.plan, solver.step
    actions = [one if cycle_of(one) <= step else delayed(one, steps) for one in plan.actions]
    return adopt(solver, actions, plan.horizon + steps)


def check_answer(solver, result):
    """Check that a grounding of the whole history in a new solver has the result as an answer."""
    fresh = PlanSolver(solver.program, plan_time=0.0)
    fresh.restore(copied(solver.log))
    snapshot = fresh.snapshot
    assert snapshot.step == result.step
    assert snapshot.min_horizon <= result.horizon
    grounding = Grounding(solver.program, snapshot, max(result.horizon, solver.reached))
    found = Plan.from_result(result)
    given = found.fixing(grounding.actions(solver.program.first_step, grounding.horizon))
    reply = grounding.ask(Question(result.horizon, result.horizon, given), lambda: False)
    assert reply.satisfiable
    assert Plan.from_atoms(reply.answers[0], result.horizon)[:2] == found[:2]
    assert reply.answers[0] <= result.answers[-1]
    assert snapshot.past is not None or reply.answers[0] == result.answers[-1]
