"""Plans soon: the questions that are asked, and plans of whole streams against a plain reading of the program."""

from itertools import count

import pytest
from fake_grounding import FakeGrounding, actions
from hypothesis import given, settings
from hypothesis import strategies as st
from plain_walk import Walk, program_text
from stream_logs import copied

from rosoclingo.oclingo import ReactiveProgram, SolveOutcome, StreamUpdate, parse_update
from rosoclingo.planning.grounding import Grounding
from rosoclingo.planning.history import Plan, cycle_of
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.planning.strategies import soon
from rosoclingo.planning.strategies.soon import Soon, TimeLimit

FOREVER = float("inf")
PROGRAMS = {advice: ReactiveProgram.from_text(program_text(advice)) for advice in (False, True)}

# ---- Questions -------------------------------------------------------------------------------------------------------


@pytest.fixture
def plain(monkeypatch):
    """The first plan may take as few conflicts as a shorter one, and plans are not trimmed (see test_trimming.py)."""

    def as_found(found, *_rest, **_options):
        return found
        yield

    monkeypatch.setattr(soon, "EFFORT", 0)
    monkeypatch.setattr(soon, "trimmed", as_found)


def plan(horizon, *cycles, shortest=False):
    return Plan(actions(*cycles), horizon, shortest)


def run(world, last=None, seconds=FOREVER, block=8, models=1, foreseen=False):
    """Return the plan's horizon, False for none and None after a stop; whether it is proven; and the questions."""
    limit = TimeLimit(seconds, foreseen, world.time)
    found, asked = world.run(lambda asking: Soon(asking, models, last, limit).run(), block)
    if found is None:
        return None, False, asked
    return found.reply.satisfiable and found.reply.horizon, found.proven, asked


def questions(*cases):
    """Cases of a grounding's plans, its options, and what is asked until there is a plan."""
    return pytest.mark.parametrize(("plans", "options", "asked"), cases)


@pytest.mark.usefixtures("plain")
@questions(
    ({3: [1, 2, 3]}, {}, "1..1/100 >9 2..9/100"),
    ({60: [60]}, {"horizon": 41}, "1..41/100 >61 42..61/100"),
    ({50: [50]}, {"horizon": 41, "hard": {41: 150}}, "1..41/100 >51 1..51/200"),
    ({12: [12]}, {"most": 12}, "1..1/100 >9 2..9/100 >12 10..12"),
    (
        {20: [20]},
        {"hard": {9: 150}, "advises": True, "most": 20},
        "1..1/100 >9 2..9/100 2..9/100? >17 2..17/100 2..9/200? 10..17/200? >20 18..20/200",
    ),
)
def test_soon_grows_by_a_quarter_of_the_steps(plans, options, asked):
    """By half of them where all are refuted, and by a block at least."""
    assert run(FakeGrounding(plans, **options), seconds=0) == (max(plans), False, asked)


@pytest.mark.usefixtures("plain")
@questions(
    ({20: []}, {"claims": 20}, "1..1/100 >25 2..25/100 2..19/100"),
    ({22: [22]}, {"claims": 12}, "1..1/100 >15 2..15/100 >23 16..23/100 16..21/100"),
    ({9: [9]}, {"claims": 40}, "1..1/100 >50 2..50/100 2..8/100"),
    ({180: []}, {"claims": 160, "most": 300}, "1..1/100 >68 >134 >200 2..200/100 2..159/100 160..179/100"),
    ({180: []}, {"claims": 160, "atoms": 1800, "most": 300}, "1..1/100 >200 2..200/100 2..159/100 160..179/100"),
)
def test_soon_grounds_steps_that_the_program_claims(plans, options, asked):
    """And a quarter more, in pieces; but the claim is not believed."""
    assert run(FakeGrounding(plans, **options)) == (max(plans), True, asked)


@pytest.mark.parametrize(
    ("steps", "needed", "advises", "asked"),
    [
        (20, 999, True, "1..20/1000 >29 21..29/689"),
        (20, 9999, True, "1..20/1000 1..20/1000? >28 1..28/714 1..20/2000? >36 1..36/555 1..20/4000?"),
        (20, 9999, False, "1..20/1000 >28 1..28/1428 >36 1..36/2220"),
        (101, 9999, True, "1..101/198 >126 1..126/158"),
        (300, 99, True, "1..300/100"),
    ],
)
def test_soon_spends_more_conflicts_on_fewer_steps(steps, needed, advises, asked):
    world = FakeGrounding({}, horizon=steps, hard={1: needed}, most=600, advises=advises, halts=asked.count("/"))
    assert run(world)[::2] == (None, asked)


@pytest.mark.usefixtures("plain")
@pytest.mark.parametrize(
    ("world", "last", "asked"),
    [
        (FakeGrounding({}, most=12), None, "1..1/100 >9 2..9/100 >12 10..12"),
        (FakeGrounding({}, most=18, claims=20), None, "1..1/100 >18 2..18"),
        (
            FakeGrounding({}, horizon=9, most=9, hard={9: 250}, advises=True),
            None,
            "1..9/100 1..9/100? 1..9/200 1..9/200? 1..9/400",
        ),
        (FakeGrounding({50: [50]}, horizon=2, dead=2), plan(1, 1), "1..1+1-2/100 2..2+2-1/100 1..2+1/100"),
    ],
)
def test_soon_refutes_all_horizons_without_a_plan(world, last, asked):
    assert run(world, last) == (False, False, asked)


@pytest.mark.usefixtures("plain")
def test_soon_decides_each_horizon_if_answers_may_not_idle():
    world = FakeGrounding({13: [13]}, horizon=11, hard={12: 150}, claims=99)
    assert run(world, block=1) == (13, True, "1..11 >12 12..12 >13 13..13")
    world = FakeGrounding({4: [2, 3, 4]}, step=2, horizon=3)
    asked = "2..3+2+3+4/100 2..3+2+3+4+5/100 2..3 >4 4..4+2+3+4/100"
    assert run(world, plan(4, 1, 2, 3, 4), block=1) == (4, True, asked)


LONG = {9: [9], 7: [7], 3: [3]}


@pytest.mark.usefixtures("plain")
@pytest.mark.parametrize(
    ("seconds", "horizon", "shortest", "asked"),
    [
        (1, 9, False, "1..9/100"),
        (3, 7, False, "1..9/100 1..8/100 1..1/100"),
        (5, 3, True, "1..9/100 1..8/100 1..1/100 2..6/100 2..2/100"),
    ],
)
def test_soon_looks_for_shorter_plans_in_time(seconds, horizon, shortest, asked):
    assert run(FakeGrounding(LONG, horizon=9), seconds=seconds) == (horizon, shortest, asked)


@pytest.mark.usefixtures("plain")
@questions(
    ({9: [9], 7: [7]}, {"hard": {3: 150}}, "1..8/100 1..1/100 2..6/100 2..2/100 3..6/100 3..3/100 3..6/200"),
    (
        {9: [9], 4: [4]},
        {"hard": {1: 150, 2: 350}},
        "1..8/100 1..1/100 1..3/100 1..1/100 1..3/200 1..1/200 2..3/200 2..2/200 2..3/400",
    ),
    (
        {9: [9], 5: [5]},
        {"hard": {1: 150}, "advises": True},
        "1..8/100 1..1/100 1..4/100 1..4/100? 1..1/100 1..4/200",
    ),
)
def test_soon_doubles_conflicts_for_hard_questions(plans, options, asked):
    horizon, shortest, found = run(FakeGrounding(plans, horizon=9, **options))
    assert (horizon, shortest) == (min(plans), True)
    assert found == f"1..9/100 {asked}"


@pytest.mark.usefixtures("plain")
@pytest.mark.parametrize("cut", [False, True])
@pytest.mark.parametrize(
    ("plans", "last", "halts"),
    [({9: [9]}, None, 0), ({9: [9]}, None, 1), ({}, plan(3, 1, 2, 3), 1), ({}, plan(3, 1, 2, 3), 4)],
)
def test_soon_knows_nothing_if_stopped_without_a_plan(plans, last, halts, cut):
    """However much of it was refuted, as long as there are horizons that were not."""
    world = FakeGrounding(plans, step=2, horizon=4, most=9, halts=halts, cut=cut)
    assert run(world, last)[:2] == (None, False)
    assert world.questions == halts


@pytest.mark.usefixtures("plain")
@pytest.mark.parametrize(
    ("halts", "cut", "horizon", "shortest"), [(2, True, 9, False), (2, False, 7, False), (5, False, 3, True)]
)
def test_soon_returns_the_best_plan_if_stopped(halts, cut, horizon, shortest):
    assert run(FakeGrounding(LONG, horizon=9, halts=halts, cut=cut))[:2] == (horizon, shortest)


@pytest.mark.usefixtures("plain")
@pytest.mark.parametrize(
    ("options", "limits", "asked"),
    [
        ({}, {"models": 0}, "1..9/100 1..8/100 9..9!0"),
        ({}, {"models": 2, "seconds": 0}, "1..9/100 9..9!2"),
        ({"optimizes": True}, {}, "1..9/100 1..8/100 9..9!"),
        ({"optimizes": True}, {"seconds": 1}, "1..9/100"),
        ({"halts": 1}, {"models": 0}, "1..9/100"),
    ],
)
def test_soon_asks_for_the_best_of_its_horizon(options, limits, asked):
    assert run(FakeGrounding({9: [9]}, horizon=9, **options), **limits)[::2] == (9, asked)


@pytest.mark.usefixtures("plain")
@pytest.mark.parametrize(
    ("plans", "options", "last", "asked"),
    [
        ({3: [2, 3]}, {"horizon": 5}, plan(4, 1, 2, 3), "3..4+2+3-4-5/100"),
        ({4: [2, 3, 4]}, {"horizon": 3}, plan(4, 1, 2, 3, 4), ">4 4..4+2+3+4/100"),
        ({2: []}, {"horizon": 3}, plan(3, 1), "2..3-2-3/100"),
        ({5: [3, 4, 5]}, {"step": 3, "horizon": 4}, plan(4, 1, 2, 3, 4), "4..4+3+4/100 >5 5..5+3+4+5/100"),
        ({4: [2, 4]}, {"horizon": 4}, plan(2, 1, 2), "2..2+2-3/100 3..3+2+3-4/100 2..4+2/100"),
        ({3: [2, 3]}, {"horizon": 3}, plan(2, 1, 2, 9), "2..3+2+9/100 2..3+10+2+3/100 2..3/100"),
        ({3: [3]}, {"horizon": 3, "most": 3}, plan(4, 1, 2, 3, 4), "2..3+2+3+4/100 2..3+2+3+4+5/100 2..3"),
        ({3: [3]}, {"horizon": 3}, plan(1, 1), "2..2-2-3/100 2..2+2-3/100 2..3+2/100 2..3/100"),
    ],
)
def test_soon_tries_the_rest_of_the_last_plan_first(plans, options, last, asked):
    """As it is, or one step later, without anything else; then with more actions; then any plan."""
    world = FakeGrounding(plans, **{"step": 2, **options})
    assert run(world, last, seconds=0)[::2] == (max(plans), asked)


@pytest.mark.usefixtures("plain")
@pytest.mark.parametrize(
    ("last", "foreseen", "least"),
    [
        (plan(9, 9), True, 9),
        (plan(9, 9, shortest=True), True, 7),
        (plan(9, 9), False, 3),
        (plan(5, 5), True, 3),
        (plan(3, 2, shortest=True), True, 3),
    ],
)
def test_soon_proves_a_predicted_plan_again_in_a_tenth_of_the_time(last, foreseen, least):
    """None of it if it was not the shortest; one that is no longer a plan leaves the time as it is."""
    assert run(FakeGrounding(LONG, horizon=9), last, seconds=20, foreseen=foreseen)[0] == least


# ---- Streams ---------------------------------------------------------------------------------------------------------

#: What comes with each step: places that are wanted, and whether the action before has failed.
NEWS = st.tuples(st.lists(st.integers(-3, 4), max_size=2), st.booleans())


def solver_of(advice, plan_time, **options):
    ticks = count()
    return PlanSolver(PROGRAMS[advice], plan_time=plan_time, clock=lambda: float(next(ticks)), **options)


def play(solver, news, bound=None):
    """Play a stream in which the plan is executed; yield the walk, the result and what was left before each update."""
    walk, left = Walk(), None
    for wanted, fails in news:
        done = frozenset(one for one in left.actions if cycle_of(one) == walk.step) if left else frozenset()
        before = left and left._replace(actions=left.actions - done)
        result = solver.update(walk.update(wanted, fails, done, bound))
        assert result.step == walk.step
        yield walk, result, before
        if not result.answers:
            return
        left = Plan.in_result(result).since(walk.step)


@settings(max_examples=settings.default.max_examples * 4 // 5)
@given(
    st.booleans(),
    st.sampled_from([0.0, 0.0, FOREVER]) | st.integers(0, 12),
    st.none() | st.integers(0, 5),
    st.lists(NEWS, min_size=1, max_size=6),
)
def test_soon_plans_hold_in_random_streams(advice, plan_time, bound, news):
    """Each is a plan, the shortest if there is time; without time the last one is kept if it is one still."""
    solver = solver_of(advice, plan_time, log_limit=2)
    for walk, result, before in play(solver, news, bound):
        if result.outcome is SolveOutcome.UNSATISFIABLE:
            assert walk.least(walk.step, walk.step + bound) is None
            return
        found = Plan.in_result(result)
        assert solver.log.plan == found
        assert walk.allows(found.horizon, found.since(walk.step).actions)
        assert result.shortest or plan_time < FOREVER
        if result.shortest:
            assert walk.least(walk.step, result.horizon) == result.horizon
        if plan_time == 0 and before and walk.allows(max(before.horizon, walk.step), before.actions):
            assert found.since(walk.step).actions == before.actions
            assert found.horizon <= max(before.horizon, walk.step)
        if plan_time == 0 and bound is None:
            reader = solver_of(advice, 0.0)
            reader.restore(copied(solver.log))
            again = Plan.in_result(reader.solve())
            assert walk.allows(again.horizon, again.since(walk.step).actions)


def first_plan(solver, goals):
    """The plan for some goals, and its first action."""
    result = solver.update(parse_update(f"#step 1. {goals} #endstep."))
    found = Plan.in_result(result)
    (action,) = (one for one in found.actions if cycle_of(one) == 1)
    return result, found, action


def test_soon_retries_a_failed_action_one_step_later():
    solver = solver_of(True, 0.0)
    _, first, action = first_plan(solver, "_request(3,1). _request(-2,1).")
    later = solver.update(parse_update(f"#step 2. #closed 1. :- not {action}. fail(1). #endstep."))
    assert Plan.in_result(later).since(2).actions == first.later().actions
    assert later.horizon == first.horizon + 1


def test_soon_fits_new_goals_behind_the_plan():
    solver = solver_of(True, 0.0)
    _, first, _ = first_plan(solver, "_request(2,1).")
    second = Plan.in_result(solver.update(parse_update("#step 1. _request(-1,1). #endstep.")))
    assert first.actions < second.actions
    assert (first.horizon, second.horizon) == (2, 5)


@pytest.mark.parametrize("news", ["", "_request(0,2)."])
def test_soon_has_no_time_for_a_predicted_plan(news, searches):
    time = iter([0.0, 2.0])  # it stands still from then on
    solver = PlanSolver(PROGRAMS[True], plan_time=1.0, clock=lambda: next(time, 2.0))
    first, _, action = first_plan(solver, "_request(3,1). _request(-2,1).")
    assert not first.shortest
    searches.clear()
    result = solver.update(parse_update(f"#step 2. #closed 1. :- not {action}. {news} #endstep."))
    assert (len(searches) == 1, result.shortest) == (not news, bool(news))


def test_soon_finds_the_best_or_all_answers_of_its_horizon():
    text = "#program cumulative(t). { a(t) }. { b(t) }. #program volatile(t). :- not a(t). #minimize { 1,t : b(t) }."
    result = PlanSolver(ReactiveProgram.from_text(text), plan_time=FOREVER).update(StreamUpdate(1))
    assert [sorted(map(str, answer)) for answer in result.answers] == [["a(1)"]]
    solver = PlanSolver(PROGRAMS[True], models=0, plan_time=FOREVER)
    result = solver.update(parse_update("#step 1. _request(1,1). _request(-1,1). #endstep."))
    assert (result.horizon, len(result.answers)) == (3, 2)


def test_soon_takes_the_best_answer_that_was_found_in_time(monkeypatch):
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
