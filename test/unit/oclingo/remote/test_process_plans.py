"""Plans and questions by way of a solver's process: as those of a solver in this process."""

from children import kill
from plain_walk import program_text

from rosoclingo.oclingo import ReactiveProgram, ReactiveSolver, parse_atom, parse_update
from rosoclingo.oclingo.remote.solver_process import SolverProcess
from rosoclingo.oclingo.solving.stream_log import Plan, cycle_of


def test_plans_are_shortened_in_a_process_as_well():
    """A child that has read the log anew shortens the plan that the caller goes by; a stop ends that."""
    program = ReactiveProgram.from_text(program_text())
    with SolverProcess(program, shortest=True, oclingo_strings=False, plan_time=0.0) as process:
        solver = process.solver()
        assert solver.improve() is None
        solver.update(parse_update("#step 1. _request(3,1). #endstep."))
        (action,) = (one for one in solver.log.plan.actions if cycle_of(one) == 1)
        worse = Plan(solver.log.plan.later().actions | {action}, solver.log.plan.horizon + 1)
        solver.log.plan = worse
        kill(process)
        assert solver.improve(lambda: True) is None
        assert solver.log.plan == worse
        while (result := solver.improve()) is not None:
            assert result.plan == solver.log.plan
        assert solver.log.plan.horizon == 3
        assert action in solver.log.plan.actions
        assert solver.update(parse_update(f"#step 2. :- not {action}. #endstep.")).horizon == 3


def test_plans_soon_come_from_a_process_as_well():
    """A time for plans goes to the child, what is proven comes back, and a new child is told the last plan."""
    program = ReactiveProgram.from_text(program_text())
    options = {"shortest": True, "oclingo_strings": False}
    ask = parse_update("#step 1. _request(3,1). _request(-2,1). #endstep.")
    with SolverProcess(program, plan_time=0.0, **options) as process:
        solver = process.solver()
        soon = solver.update(ask)
        assert not soon.shortest
        assert solver.log.plan == soon.plan
        (action,) = (one for one in soon.plan.actions if cycle_of(one) == 1)
        worse = Plan(soon.plan.later().actions | {action}, soon.horizon + 1)
        solver.log.plan = worse
        kill(process)
        again = solver.update(parse_update(f"#step 2. :- not {action}. fail(1). #endstep."))
        assert again.plan.since(2).actions == worse.since(2).actions
    with SolverProcess(program, **options) as process:
        shortest = process.solver().update(ask)
        assert shortest.shortest
        assert shortest.horizon <= soon.horizon


def test_what_would_be_is_asked_of_the_process_as_well():
    text = "#external e/1.\n#program cumulative(t).\n:- e(1), e(2), not e(3).\n"
    here = ReactiveSolver(ReactiveProgram.from_text(text), shortest=True)
    update = parse_update('#step 2 : 1. e(1). e(2). e("3"). #end step.')
    doubted = frozenset(map(parse_atom, ["e(1)", "e(2)", 'e("3")']))
    with SolverProcess(ReactiveProgram.from_text(text), shortest=True) as process:
        solver = process.solver()
        solver.update(parse_update("#step 1 : 1. #end step."))
        here.update(parse_update("#step 1 : 1. #end step."))
        log = solver.log
        for untold in (frozenset(), frozenset([parse_atom("e(1)")])):
            assert solver.inquire(update, doubted, untold) == here.inquire(update, doubted, untold)
        assert solver.inquire(update, doubted, frozenset()).core == doubted - {parse_atom('e("3")')}
        assert solver.log is log
