"""The searches for first plans: their questions, and the time for better plans (see also test_walks.py)."""

from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from stream_play import adopt

from rosoclingo.oclingo import ReactiveProgram, parse_atom, parse_update
from rosoclingo.oclingo.errors import StoppedError
from rosoclingo.planning.history import Plan, cycle_of
from rosoclingo.planning.question import UNKNOWN, Reply
from rosoclingo.planning.snapshot import Snapshot
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.planning.strategies.shortest import shortest
from rosoclingo.planning.strategies.soon import FirstPlanSearch
from rosoclingo.planning.strategy_runner import StrategyRunner

# ---- Questions -------------------------------------------------------------------------------------------------------


def actions(*cycles):
    return frozenset(parse_atom(f"_action_lib(go,x,{cycle})") for cycle in cycles)


class FakeGrounding:
    """A grounding in which plans exist at known horizons, each given by the cycles in which it acts.

    The steps up to ``horizon`` are ground. A question about several horizons finds the plan of the last one. Horizon
    ``h`` is refuted after ``hard[h]`` conflicts; from horizon ``dead`` on the program is hopeless. The program
    ``claims`` to need so many steps.
    """

    is_cyclic, grows = False, True

    def __init__(self, plans, world):
        self.plans, self.world = plans, {"hard": {}, "dead": None, "claims": 0, **world}
        self.horizon, self.asked = world["horizon"], []
        flags = {name: world.get(name, False) for name in ("advises", "optimizes")}
        self.program = SimpleNamespace(forgets=(), actions_go_on=False, **flags)

    def run(self, make, block, halts=None):
        """Return the result of the strategy that ``make`` makes, None after a stop, which comes after ``halts``
        questions and interrupts the last of them; and all questions.
        """
        step, self.halts = self.world["step"], halts
        snapshot = Snapshot(step=step, min_horizon=step, horizon=self.horizon)
        runner = StrategyRunner(self.program, snapshot, self.build, block, self.world["most"])
        try:
            return runner.run(make(runner), lambda: halts is not None and len(self.asked) >= halts), self.asked
        except StoppedError:
            return None, self.asked

    def build(self, _snapshot, horizon, stopped):
        if horizon > self.horizon:
            self.grow_to(horizon)
        return self

    def piece(self):
        return 64

    def grow_to(self, horizon):
        assert self.horizon < horizon <= self.world["most"]
        self.horizon = horizon

    def claimed_steps(self):
        return self.world["claims"]

    def actions(self, first, last):
        assert first == self.world["step"]
        return sorted(actions(*range(first, min(last, self.horizon) + 1)))

    def ask(self, question, stopped):
        first, last, conflicts = question.first, question.last, question.conflicts
        assert self.world["step"] <= first <= last <= self.horizon
        assert question.best or question.models == 1
        assert question.advised or self.program.advises
        self.asked.append(question)
        if self.halts is not None and stopped():
            return UNKNOWN
        horizons = range(first, last + 1)
        plans = [(one, actions(*cycles)) for one, cycles in self.plans.items() if one in horizons]
        agreeing = [(one, plan) for one, plan in plans if self.agrees(plan, question)]
        if agreeing:
            horizon, plan = max(agreeing, key=lambda pair: pair[0])
            return Reply(True, (plan,), horizon)
        hardest = max(self.world["hard"].get(one, 0) for one in horizons)
        if conflicts is not None and not question.given and hardest > conflicts:
            return UNKNOWN
        dead = self.world["dead"] is not None and last >= self.world["dead"]
        return Reply(False, hopeless=dead, permanent=dead)

    @staticmethod
    def agrees(plan, question):
        """Return whether the plan is an answer to the question at any of its horizons."""
        given = all((action in plan) == value for action, value in question.given)
        return given and (not question.lacking or not plan.issuperset(question.lacking))


HORIZONS = st.integers(2, 30)
WORLDS = {
    "step": st.integers(1, 2),
    "horizon": st.integers(2, 12),
    "most": st.integers(12, 30),
    "claims": st.integers(0, 40),
}
PLANS = st.dictionaries(HORIZONS, st.lists(HORIZONS, max_size=4), max_size=3)
BLOCKS = st.sampled_from([1, 8])


@given(
    PLANS,
    st.fixed_dictionaries({**WORLDS, "dead": st.none() | HORIZONS, "optimizes": st.booleans()}),
    st.integers(0, 14),
    BLOCKS,
    st.sampled_from([0, 1]),
)
def test_shortest_finds_the_least_horizon_unless_stopped(plans, world, hint, block, models):
    least = min((one for one in plans if one <= world["most"]), default=None)
    hopeless = world["dead"] is not None and world["dead"] <= world["most"]
    hopeless = hopeless and (least is None or world["dead"] < least)

    def run(halts=None):
        found = {} if hopeless else dict.fromkeys(plans, ())
        return FakeGrounding(found, world).run(lambda runner: shortest(runner, models, hint), block, halts)

    reply, asked = run()
    assert (reply.satisfiable, reply.permanent) == (least is not None and not hopeless, hopeless)
    if reply.satisfiable:
        assert reply.horizon == least
        assert (models == 1 and not world["optimizes"]) or any(
            (one.first, one.last, one.best) == (least, least, True) for one in asked
        )
    for halts in range(len(asked)):
        assert run(halts)[0] is None


@given(
    PLANS,
    st.fixed_dictionaries(
        {
            **WORLDS,
            "hard": st.dictionaries(HORIZONS, st.integers(0, 90_000), max_size=3),
            "advises": st.booleans(),
        }
    ),
    st.none() | st.builds(lambda horizon, cycles: Plan(actions(*cycles), horizon), HORIZONS, st.sets(HORIZONS)),
    BLOCKS,
)
def test_soon_finds_a_plan_or_refutes_all_horizons(plans, world, last, block):
    """Without steps that can invalidate answers, the plan is shortest; a stop ends the search."""
    reachable = [horizon for horizon in plans if horizon <= world["most"]]

    def run(halts=None):
        found, asked = FakeGrounding(plans, world).run(
            lambda runner: FirstPlanSearch(runner, last, False).run(), block, halts
        )
        return found, found and found.reply.satisfiable and found.reply.horizon, asked

    found, horizon, asked = run()
    assert horizon in (reachable or [False])
    assert found.least <= min(reachable, default=100)
    for halts in range(len(asked)):
        stopped, horizon, _ = run(halts)
        assert stopped is None or horizon in reachable, "a stop only ends the trimming"


# ---- In the solver ---------------------------------------------------------------------------------------------------


CARTS = """
#external _running/3. #external _return/3. #external _request/2.
#program base. cart(r1). cart(r2).
#program cumulative(t).
wanted(t) :- _request(go,t).
wanted(t) :- wanted(t-1).
_action_lib(A,P,t) :- _running(A,P,t-1).
{ _action_lib(go(R),P,t) : P = 1..6 } 1 :- cart(R).
done(R,P,t) :- _action_lib(go(R),P,t), not _running(go(R),P,t).
at(R,0,0) :- cart(R), t = 1.
at(R,P,t) :- done(R,P,t).
at(R,P,t) :- at(R,P,t-1), not done(R,Q,t) : Q = 1..6.
:- _action_lib(go(R),P,t), not at(R,P-1,t-1).
#program volatile(t).
:- wanted(t), at(R,P,t), P < 4.
"""


def late_plan(searches, rule=""):
    """Return the actions planned after cycle 1, in which the second cart is late."""
    solver = PlanSolver(ReactiveProgram.from_text(CARTS + rule), plan_time=0.0)
    solver.update(parse_update("#step 1. _request(go,1). #endstep."))
    searches.clear()
    sent = ":- not _action_lib(go(r1),1,1). :- not _action_lib(go(r2),1,1)."
    news = "_running(go(r2),1,1). _return(go(r1),1,1)."
    result = solver.update(parse_update(f"#step 2. #closed 1. {sent} {news} #endstep."))
    return sorted(str(one) for one in Plan.from_result(result).actions if cycle_of(one) > 1)


def test_soon_delays_only_the_robot_whose_action_goes_on(searches):
    first = [f"_action_lib(go(r1),{place},{place})" for place in (2, 3, 4)]
    second = [f"_action_lib(go(r2),{place},{place + 1})" for place in (1, 2, 3, 4)]
    assert late_plan(searches) == first + second
    assert searches == [(5, 5)], "only the delayed plan"


def test_soon_delays_other_robots_if_one_is_in_the_way(searches):
    """The delayed plan breaks the last rule of the program."""
    found = late_plan(searches, "#program cumulative(t). :- at(r1,3,t), at(r2,2,t).")
    assert len(found) == 7, "each cart goes on"
    assert searches == [(5, 5), (5, 5), (2, 5)], "the plan with one cart late, with both, and with the one that can go"


def test_soon_drops_the_drives_that_no_goal_needs():
    """The program advises them; with several robots, its advice is not trusted."""
    needs = "#program base. needs(r1,4). needs(r2,0). #program cumulative(t). "
    advice = "#heuristic _action_lib(go(R),P,t) : cart(R), P = 1..6. [1,true]"
    text = CARTS.replace("P < 4", "P < N, needs(R,N)") + needs + advice
    result = PlanSolver(ReactiveProgram.from_text(text), plan_time=0.0).update(
        parse_update("#step 1. _request(go,1). #endstep.")
    )
    assert {str(one.arguments[0]) for one in Plan.from_result(result).actions} == {"go(r1)"}


@pytest.mark.parametrize(
    ("cycles", "rule", "found"),
    [
        ((5, 6), "#program cumulative(t). :- at(r1,P,t), at(R,P,t), R != r1, P > 0.", [4, 5]),
        ((3, 4), "", [2, 5]),
    ],
    ids=["as early as the order of carts allows", "although the other cart can hang"],
)
def test_soon_lets_carts_go(cycles, rule, found):
    """The first cart goes on to place 1; the others wait for it, unless nothing begins otherwise."""
    needs = "#program base. cart(r3). needs(r1,4). needs((r2;r3),2)."
    text = CARTS.replace("P < 4", "P < N, needs(R,N)") + needs + rule
    solver = PlanSolver(ReactiveProgram.from_text(text), plan_time=0.0)
    solver.update(parse_update("#step 1. _request(go,1). #endstep."))
    drives = [("r1", place, place) for place in (1, 2, 3, 4)]
    drives += [(cart, place, cycle) for cart in ("r2", "r3") for place, cycle in zip((1, 2), cycles)]
    adopt(solver, [f"_action_lib(go({cart}),{place},{cycle})" for cart, place, cycle in drives], 6)
    running = "#closed 1. :- not _action_lib(go(r1),1,1). _running(go(r1),1,1)."
    result = solver.update(parse_update(f"#step 2. {running} #endstep."))
    planned = {f"go({cart})": [] for cart in ("r1", "r2", "r3")}
    for one in sorted(Plan.from_result(result).actions, key=cycle_of):
        planned[str(one.arguments[0])].append(cycle_of(one))
    assert planned == {"go(r1)": [1, 2, 3, 4, 5], "go(r2)": found, "go(r3)": found}
