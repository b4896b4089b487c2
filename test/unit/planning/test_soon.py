"""Plans soon: each is a plan, the shortest where there is time, the last one where it still is one."""

from itertools import count

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from plain_walk import Walk, program_text

from rosoclingo.oclingo import ReactiveProgram, SolveOutcome, StreamUpdate, parse_update
from rosoclingo.planning.grounding import Grounding
from rosoclingo.planning.history import Plan, cycle_of
from rosoclingo.planning.solver import PlanSolver

PROGRAMS = {advice: ReactiveProgram.from_text(program_text(advice)) for advice in (False, True)}
FOREVER = float("inf")

#: What comes with each step: places that are wanted, and whether the action before has failed.
NEWS = st.tuples(st.lists(st.integers(-3, 4), max_size=2), st.booleans())


def ticking():
    """A clock that goes on by one with each look."""
    ticks = count()
    return lambda: float(next(ticks))


def solver_of(advice, plan_time, **options):
    return PlanSolver(PROGRAMS[advice], plan_time=plan_time, clock=ticking(), **options)


def actions_from(result, step):
    return Plan.in_result(result).since(step).actions


def play(solver, news, bound=None):
    """Play a stream in which the plan is executed; yield the walk, the result and what was left after each update."""
    walk, result, left = Walk(), None, frozenset()
    for wanted, fails in news:
        done = {one for one in left if cycle_of(one) == walk.step}
        before = None if result is None else (frozenset(left - done), result.horizon)
        update = walk.update(wanted, fails, done, bound)
        if walk.step > 1:
            solver.close_cycle(walk.step - 1, done)
        result = solver.update(update)
        assert result.step == walk.step
        if Plan.in_result(result) is None:
            yield walk, result, before
            return
        left = actions_from(result, walk.step)
        yield walk, result, before


@settings(max_examples=settings.default.max_examples // 5)
@given(st.booleans(), st.integers(0, 12), st.lists(NEWS, min_size=1, max_size=5))
def test_every_answer_is_one_and_the_shortest_where_it_says_so(advice, plan_time, news):
    for walk, result, _ in play(solver_of(advice, plan_time), news):
        assert result.outcome is SolveOutcome.SATISFIABLE
        assert walk.allows(result.horizon, actions_from(result, walk.step))
        if result.shortest:
            assert walk.least(walk.step, result.horizon) == result.horizon


@pytest.mark.slow
@settings(max_examples=settings.default.max_examples // 5)
@given(st.booleans(), st.lists(NEWS, min_size=1, max_size=5))
def test_with_time_enough_plans_are_shortest(advice, news):
    for walk, result, before in play(solver_of(advice, FOREVER), news):
        assert result.shortest
        assert walk.least(walk.step, result.horizon) == result.horizon
        assert before is None or result.horizon >= walk.step


@settings(max_examples=settings.default.max_examples // 5)
@given(st.booleans(), st.lists(NEWS, min_size=2, max_size=6))
def test_a_plan_that_still_is_one_is_kept_where_there_is_no_time(advice, news):
    for walk, result, before in play(solver_of(advice, 0.0), news):
        if before is not None:
            rest, horizon = before
            if walk.allows(max(horizon, walk.step), rest):
                assert actions_from(result, walk.step) == rest
                assert result.horizon <= max(horizon, walk.step)


@settings(max_examples=settings.default.max_examples // 5)
@given(st.booleans(), st.integers(0, 6), st.integers(0, 5), st.lists(NEWS, min_size=1, max_size=4))
def test_what_is_refused_is_refuted_up_to_the_bound(advice, plan_time, bound, news):
    for walk, result, _ in play(solver_of(advice, plan_time), news, bound):
        if result.outcome is SolveOutcome.UNSATISFIABLE:
            assert walk.least(walk.step, walk.step + bound) is None
        else:
            assert walk.allows(result.horizon, actions_from(result, walk.step))


@pytest.mark.slow
@settings(max_examples=settings.default.max_examples // 5)
@given(st.booleans(), st.lists(NEWS, min_size=2, max_size=5))
def test_a_solver_that_reads_the_log_gives_answers_as_well(advice, news):
    solver = solver_of(advice, 0.0, log_limit=2)
    for walk, result, _ in play(solver, news):
        fresh = solver_of(advice, 0.0)
        fresh.restore(type(solver.log).parse(solver.log.text()))
        assert fresh.log.plan is None, "no part of the history"
        again = fresh.solve()
        assert walk.allows(again.horizon, actions_from(again, walk.step))
        assert solver.log.plan == Plan.in_result(result)


def test_a_plan_in_which_an_action_failed_goes_on_one_step_later():
    solver = solver_of(True, 0.0)
    first = solver.update(parse_update("#step 1. _request(3,1). _request(-2,1). #endstep."))
    (action,) = (one for one in Plan.in_result(first).actions if cycle_of(one) == 1)
    solver.close_cycle(1, [action])
    later = solver.update(parse_update(f"#step 2. :- not {action}. fail(1). #endstep."))
    assert Plan.in_result(later).since(2).actions == Plan.in_result(first).later().actions
    assert later.horizon == first.horizon + 1


def test_new_goals_are_fitted_behind_the_plan():
    solver = solver_of(True, 0.0)
    first = solver.update(parse_update("#step 1. _request(2,1). #endstep."))
    second = solver.update(parse_update("#step 1. _request(-1,1). #endstep."))
    assert Plan.in_result(first).actions < Plan.in_result(second).actions
    assert (first.horizon, second.horizon) == (2, 5)


#: Holes and one pigeon more in each step before the sixth: hard to refute, and no plan is shorter.
PIGEONS = """
#program cumulative(t).
#external _request/2.
#const holes = 10.
{{ _action_lib(go,t,t) }}.
1 {{ in(P,H,t) : H = 1..holes }} 1 :- P = 1..holes+1, t < {free}.
:- in(P,H,t), in(Q,H,t), P < Q, hard(t).
{{ hard(t) }}.
ended(t) :- _action_lib(go,t,t).
wanted(t) :- _request(X,t).
wanted(t) :- wanted(t-1).
#program volatile(t).
:- wanted(t), not ended(t).
:- wanted(t), not hard(t).
"""
WANTED = parse_update("#step 1. _request(x,1). #endstep.")


def pigeons(free, **options):
    program = ReactiveProgram.from_text(PIGEONS.format(free=free))
    return PlanSolver(program, **options)


def after(looks):
    """A stop request from that look on."""
    seen = count(1)
    return lambda: next(seen) > looks


def test_a_search_that_is_stopped_without_a_plan_is_interrupted():
    solver = pigeons(free=1000, plan_time=0.0)
    result = solver.update(WANTED, after(looks=40))
    assert (result.outcome, result.answers, result.shortest) == (SolveOutcome.INTERRUPTED, (), False)
    assert Plan.in_result(result) is None
    assert solver.log.update == WANTED, "the update is in force"


def test_a_search_that_is_stopped_with_a_plan_has_it(monkeypatch):
    solver, horizons, ask = pigeons(free=6, plan_time=FOREVER), [0], Grounding.ask

    def asked(grounding, question, stopped):
        reply = ask(grounding, question, stopped)
        horizons.append(reply.horizon if reply.satisfiable else 0)
        return reply

    monkeypatch.setattr(Grounding, "ask", asked)
    result = solver.update(WANTED, lambda: max(horizons) >= 6)
    assert (result.outcome, result.shortest) == (SolveOutcome.SATISFIABLE, False)
    assert result.horizon >= 6


def test_no_plan_is_given_up_for_time_where_none_is_known():
    result = pigeons(free=6, plan_time=0.0, clock=ticking()).update(WANTED)
    assert (result.outcome, result.shortest) == (SolveOutcome.SATISFIABLE, False)
    assert result.horizon >= 6


@pytest.mark.parametrize("news", ["", "_request(0,2)."])
def test_a_plan_that_goes_on_as_foreseen_has_had_its_time(news, searches):
    time = iter([0.0, 2.0])  # it stands still from then on
    solver = PlanSolver(PROGRAMS[True], plan_time=1.0, clock=lambda: next(time, 2.0))
    first = solver.update(parse_update("#step 1. _request(3,1). _request(-2,1). #endstep."))
    assert not first.shortest
    (action,) = (one for one in Plan.in_result(first).actions if cycle_of(one) == 1)
    solver.close_cycle(1, [action])
    searches.clear()
    result = solver.update(parse_update(f"#step 2. :- not {action}. {news} #endstep."))
    assert (len(searches) == 1, result.shortest) == ((True, False) if not news else (False, True))
    assert Plan.in_result(result).actions == Plan.in_result(first).actions or result.horizon < first.horizon


def test_the_best_of_the_plans_horizon_where_the_program_optimizes():
    text = "#program cumulative(t). { a(t) }. { b(t) }. #program volatile(t). :- not a(t). #minimize { 1,t : b(t) }."
    solver = PlanSolver(ReactiveProgram.from_text(text), plan_time=FOREVER)
    result = solver.update(StreamUpdate(1))
    assert [sorted(map(str, answer)) for answer in result.answers] == [["a(1)"]]


def test_all_answers_of_the_plans_horizon_where_all_are_asked_for():
    solver = PlanSolver(PROGRAMS[True], models=0, plan_time=FOREVER)
    result = solver.update(parse_update("#step 1. _request(1,1). _request(-1,1). #endstep."))
    assert result.horizon == 3
    assert len(result.answers) == 2


def test_the_best_that_was_found_where_there_is_no_time_to_prove_it(monkeypatch):
    """To prove that fourteen pigeons in thirteen holes can't all sit alone takes for ever."""
    text = """
        #program base. pigeon(1..14). hole(1..13).
        #program cumulative(t). 1 { sits(P,H,t) : hole(H) } 1 :- pigeon(P).
        #minimize { 1,P,Q,t : sits(P,H,t), sits(Q,H,t), P < Q }.
        #program volatile(t). :- t < 1.
    """
    before, ask = [], Grounding.ask

    def asked(grounding, question, stopped):
        if question.best:
            before.extend((grounding, grounding.shown))
        return ask(grounding, question, stopped)

    def clock():
        """The time is over as soon as the search for the best has a plan."""
        return float(bool(before) and before[0].shown is not before[1])

    monkeypatch.setattr(Grounding, "ask", asked)
    solver = PlanSolver(ReactiveProgram.from_text(text), plan_time=1.0, clock=clock)
    result = solver.update(StreamUpdate(1))
    assert result.outcome is SolveOutcome.SATISFIABLE
    assert result.answers[0] == before[0].shown != before[1]
