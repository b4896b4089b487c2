"""Which questions the search for a plan soon asks, in which order, and when it has to do with the plan it knows."""

from types import SimpleNamespace

import pytest

from rosoclingo.oclingo import parse_atom
from rosoclingo.planning.asking import Asking
from rosoclingo.planning.history import Plan, cycle_of
from rosoclingo.planning.question import UNKNOWN, Reply, StoppedError
from rosoclingo.planning.snapshot import Snapshot
from rosoclingo.planning.strategies import soon
from rosoclingo.planning.strategies.soon import Soon, TimeLimit

FOREVER = float("inf")


@pytest.fixture(autouse=True)
def few_conflicts(monkeypatch):
    """The first plan is looked for with as few conflicts as a shorter one, where a test does not say otherwise.

    Plans stay as they are found: test_trimming.py has the questions by which they are trimmed.
    """

    def as_found(found, *_rest, **_options):
        return found
        yield

    monkeypatch.setattr(soon, "EFFORT", 0)
    monkeypatch.setattr(soon, "trimmed", as_found)


def actions(*cycles):
    return frozenset(parse_atom(f"_action_lib(go,x,{cycle})") for cycle in cycles)


def plan(horizon, *cycles, shortest=False):
    return Plan(actions(*cycles), horizon, shortest)


class World:
    """A grounding with plans by their horizons, given by the cycles in which they act.

    It is ground up to ``horizon``, at most to ``most``. The reply about several horizons has the plan of the last one.
    ``hard`` tells how many conflicts it takes to refute a horizon where nothing is given; from horizon ``dead`` on
    nothing makes the program satisfiable any more. After ``halts`` questions there is a stop; if they are ``cut`` it
    interrupts the last one. Questions are noted as text: 2..5/100 all 0 for these horizons, so many conflicts and all
    answers, with + and - for the cycles whose actions are given as true and as false, a ? where the program's advice
    does not count; and >7 for the steps that were ground. The program ``claims`` that so many steps are needed, and has
    so many ``atoms`` per step.
    """

    is_cyclic = False

    def __init__(self, plans, step=1, horizon=1, most=99, hard=None, **others):
        self.plans, self.most, self.hard, self.asked = plans, most, hard or {}, []
        self.step, self.horizon = step, horizon
        self.program = SimpleNamespace(
            forgets=(), optimizes=others.get("optimizes", False), advises=others.get("advises", False)
        )
        self.dead, self.halts = others.get("dead"), others.get("halts")
        self.cut = others.get("cut", False)
        self.claims, self.atoms_per_step = others.get("claims", 0), others.get("atoms", 10**6)
        self.questions = 0

    def asking(self, block):
        snapshot = Snapshot(step=self.step, settled=self.step, horizon=self.horizon)
        return Asking(self.program, snapshot, self.build, block, self.most)

    def build(self, _snapshot, horizon):
        if horizon > self.horizon:
            self.grow_to(horizon)
        return self

    def halt(self):
        return self.halts is not None and self.questions >= self.halts

    def time(self):
        """Each question takes a second."""
        return 1000.0 + self.questions

    def grow_to(self, horizon):
        assert self.horizon < horizon <= self.most
        self.asked.append(f">{horizon}")
        self.horizon = horizon

    def claimed_steps(self):
        return self.claims

    def actions(self, first, last):
        assert first == self.step
        return sorted(actions(*range(first, min(last, self.horizon) + 1)))

    def ask(self, question, stopped):
        first, last, conflicts, given = question.first, question.last, question.conflicts, question.given
        assert self.step <= first <= last <= self.horizon
        assert question.best or question.models == 1
        assert question.advised or self.program.advises
        marks = "".join(sorted("-+"[value] + str(cycle_of(one)) for one, value in given))
        limits = ("" if conflicts is None else f"/{conflicts}") + (f" all {question.models}" if question.best else "")
        self.asked.append(f"{first}..{last}{marks}{limits}{'' if question.advised else '?'}")
        self.questions += 1
        if self.cut and (stopped() or (question.until is not None and question.until())):
            return UNKNOWN
        found = [one for one in range(first, last + 1) if one in self.plans and self._agrees(one, given)]
        if found:
            return Reply(True, (actions(*self.plans[found[-1]]),), found[-1])
        needed = 0 if given else max(self.hard.get(one, 0) for one in range(first, last + 1))
        if conflicts is not None and needed > conflicts:
            return UNKNOWN
        dead = self.dead is not None and last >= self.dead
        return Reply(False, hopeless=dead, permanent=dead)

    def _agrees(self, horizon, given):
        return all((cycle_of(one) in self.plans[horizon]) == value for one, value in given)


def run(world, last=None, seconds=FOREVER, block=8, models=1, foreseen=False):
    """Return the plan's horizon, False for none and None if that is not known, whether it is proven, and questions."""
    asking = world.asking(block)
    strategy = Soon(asking, models, last, TimeLimit(seconds, foreseen, world.time))
    try:
        reply, proven, _ = asking.run(strategy.run(), world.halt)
    except StoppedError:
        return None, False, " ".join(world.asked)
    return reply.satisfiable and reply.horizon, proven, " ".join(world.asked)


@pytest.mark.parametrize(
    ("world", "horizon", "asked"),
    [
        (World({1: []}), 1, "1..1/100"),
        (World({3: [1, 2, 3]}), 3, "1..1/100 >9 2..9/100"),
        (World({60: [60]}, horizon=41), 60, "1..41/100 >61 42..61/100"),
        (World({52: [52]}, step=2, horizon=42), 52, "2..42/100 >62 43..62/100"),
        (World({50: [50]}, horizon=41, hard={41: 150}), 50, "1..41/100 >51 1..51/200"),
        (World({251: [251]}, horizon=201, most=400), 251, "1..201/100 >251 >301 202..301/100"),
        (World({12: [12]}, most=12), 12, "1..1/100 >9 2..9/100 >12 10..12"),
        (World({20: [20]}, hard={9: 150}), 20, "1..1/100 >9 2..9/100 >17 2..17/200 >25 18..25/200"),
        (
            World({20: [20]}, hard={9: 150}, advises=True, most=20),
            20,
            "1..1/100 >9 2..9/100 2..9/100? >17 2..17/100 2..9/200? 10..17/200? >20 18..20/200",
        ),
    ],
)
def test_any_plan_is_found_by_more_steps(world, horizon, asked):
    """A quarter more of those to come, or a block."""
    assert run(world, seconds=0)[::2] == (horizon, asked)


@pytest.mark.parametrize(
    ("steps", "needed", "advises", "asked"),
    [
        (20, 999, True, "1..20/1000 >29 21..29/689"),
        (39, 480, False, "1..39/512 >58 40..58/344"),
        (20, 9999, True, "1..20/1000 1..20/1000? >28 1..28/714 1..20/2000? >36 1..36/555 1..20/4000?"),
        (20, 9999, False, "1..20/1000 >28 1..28/1428 >36 1..36/2220"),
        (100, 9999, True, "1..100/200 1..100/200? >124 1..124/161 1..100/400?"),
        (101, 9999, True, "1..101/198 >126 1..126/158"),
        (300, 99, True, "1..300/100"),
    ],
    ids=["few", "more", "too hard", "the harder", "few without advice", "too many for that", "many"],
)
def test_the_fewer_the_steps_the_more_conflicts_a_first_plan_may_take(monkeypatch, steps, needed, advises, asked):
    monkeypatch.setattr(soon, "EFFORT", 20_000)
    world = World({}, horizon=steps, hard={1: needed}, most=600, advises=advises, halts=asked.count("/"))
    assert run(world)[::2] == (None, asked)


@pytest.mark.parametrize(
    ("world", "horizon", "asked"),
    [
        (World({22: [22]}, claims=20), 22, "1..1/100 >25 2..25/100 2..19/100 20..21/100"),
        (World({22: [22]}, step=5, horizon=6, claims=16), 22, "5..6/100 >24 7..24/100 7..19/100 20..21/100"),
        (World({22: [22]}, claims=12), 22, "1..1/100 >15 2..15/100 >23 16..23/100 16..21/100"),
        (World({22: [22]}, claims=20, most=18), False, "1..1/100 >18 2..18"),
        (World({9: [9]}, claims=40), 9, "1..1/100 >50 2..50/100 2..8/100"),
        (World({30: [30]}, horizon=40, claims=50), 30, "1..40/100 1..29/100"),
        (
            World({180: [180]}, claims=160, most=300),
            180,
            "1..1/100 >68 >134 >200 2..200/100 2..159/100 160..179/100",
        ),
        (
            World({180: [180]}, claims=160, atoms=2000, most=300),
            180,
            "1..1/100 >101 >200 2..200/100 2..159/100 160..179/100",
        ),
        (
            World({180: [180]}, claims=160, atoms=1800, most=300),
            180,
            "1..1/100 >200 2..200/100 2..159/100 160..179/100",
        ),
    ],
)
def test_as_many_steps_as_the_program_claims_and_a_quarter_more_are_ground_at_once(world, horizon, asked):
    """What it claims is asked, too: nobody believes it."""
    found, proven, questions = run(world)
    assert (found, questions) == (horizon, asked)
    assert proven == bool(found)


def test_where_steps_are_ground_one_by_one_a_claim_is_passed_over():
    assert run(World({3: [3]}, claims=9), block=1)[::2] == (3, "1..1 >2 2..2 >3 3..3")


@pytest.mark.parametrize(
    ("world", "settings", "asked"),
    [
        (World({}, most=12), {}, "1..1/100 >9 2..9/100 >12 10..12"),
        (World({}, most=9, hard={9: 150}), {}, "1..1/100 >9 2..9"),
        (World({}, most=9, hard={9: 150}, advises=True), {}, "1..1/100 >9 2..9/100 2..9/100? 2..9/200"),
        (
            World({}, horizon=9, most=9, hard={9: 250}, advises=True),
            {},
            "1..9/100 1..9/100? 1..9/200 1..9/200? 1..9/400",
        ),
        (World({50: [50]}, dead=9), {}, "1..1/100 >9 2..9/100"),
        (World({50: [50]}, horizon=2, dead=2), {"last": plan(1, 1)}, "1..1+1-2/100 2..2+2-1/100 1..2+1/100"),
    ],
)
def test_without_a_plan_all_horizons_are_refuted(world, settings, asked):
    assert run(world, **settings) == (False, False, asked)


def test_where_an_answer_may_not_outlive_further_steps_each_horizon_is_decided_before_the_next():
    assert run(World({13: [13]}, horizon=11, hard={12: 150}), block=1) == (13, True, "1..11 >12 12..12 >13 13..13")
    last = plan(4, 1, 2, 3, 4)
    world = World({4: [2, 3, 4]}, step=2, horizon=3)
    assert run(world, last, block=1) == (4, True, "2..3+2+3+4/100 2..3+2+3+4+5/100 2..3 >4 4..4+2+3+4/100")


def test_steps_are_added_in_blocks():
    world = World({5: [5]}, hard={2: 150})
    assert run(world, seconds=0, block=2) == (5, False, "1..1/100 >3 2..3/100 >5 2..5/200")


LONG = {9: [9], 7: [7], 3: [3]}


@pytest.mark.parametrize(
    ("seconds", "horizon", "shortest", "asked"),
    [
        (1, 9, False, "1..9/100"),
        (2, 7, False, "1..9/100 1..8/100"),
        (3, 7, False, "1..9/100 1..8/100 1..1/100"),
        (4, 3, False, "1..9/100 1..8/100 1..1/100 2..6/100"),
        (5, 3, True, "1..9/100 1..8/100 1..1/100 2..6/100 2..2/100"),
    ],
)
def test_shorter_ones_are_looked_for_while_time_lasts(seconds, horizon, shortest, asked):
    assert run(World(LONG, horizon=9), seconds=seconds) == (horizon, shortest, asked)


def test_shorter_ones_are_looked_for_without_advice_too():
    world = World({9: [9], 5: [5]}, hard={1: 150}, advises=True)
    asked = "1..1/100 1..1/100? >9 1..9/100 1..8/100 1..1/100 1..4/100 1..4/100? 1..1/100 1..4/200"
    assert run(world) == (5, True, asked)


def test_what_is_looked_for_ends_with_the_time():
    assert run(World(LONG, horizon=9, cut=True), seconds=2) == (9, False, "1..9/100 1..8/100")


@pytest.mark.parametrize(
    ("plans", "hard", "asked"),
    [
        ({9: [9], 1: [1]}, {}, "1..8/100"),
        ({9: [9], 7: [7]}, {3: 150}, "1..8/100 1..1/100 2..6/100 2..2/100 3..6/100 3..3/100 3..6/200"),
        ({9: [9], 7: [7]}, {1: 150}, "1..8/100 1..1/100 1..6/100 1..1/100 1..6/200"),
        ({9: [9], 8: [8]}, {1: 150}, "1..8/100 1..1/100 1..7/100 1..1/100 1..7/200"),
        (
            {9: [9], 4: [4]},
            {1: 150, 2: 350},
            "1..8/100 1..1/100 1..3/100 1..1/100 1..3/200 1..1/200 2..3/200 2..2/200 2..3/400",
        ),
    ],
)
def test_what_is_hard_may_take_twice_as_many_conflicts_the_next_time(plans, hard, asked):
    horizon, shortest, questions = run(World(plans, horizon=9, hard=hard))
    assert (horizon, shortest) == (min(plans), True)
    assert questions == f"1..9/100 {asked}"


@pytest.mark.parametrize("cut", [False, True])
@pytest.mark.parametrize(
    ("world", "last", "halts"),
    [
        ({"plans": {9: [9]}}, None, 0),
        ({"plans": {9: [9]}}, None, 1),
        ({"plans": {}}, None, 2),
        ({"plans": {}, "horizon": 201, "most": 300}, None, 1),
        ({"plans": {}, "step": 2, "horizon": 4, "most": 4}, plan(3, 1, 2, 3), 1),
        ({"plans": {}, "step": 2, "horizon": 4, "most": 4}, plan(3, 1, 2, 3), 2),
        ({"plans": {}, "step": 2, "horizon": 4, "most": 4}, plan(3, 1, 2, 3), 3),
        ({"plans": {}, "step": 2, "horizon": 4, "most": 4}, plan(3, 1, 2, 3), 4),
    ],
)
def test_what_was_stopped_without_a_plan_tells_nothing(world, last, halts, cut):
    """However much of it was refuted, as long as there are horizons that were not."""
    world = World(**world, halts=halts, cut=cut)
    satisfiable, shortest, _ = run(world, last)
    assert (satisfiable, shortest, world.questions) == (None, False, halts)
    assert world.horizon <= 201


@pytest.mark.parametrize(
    ("halts", "cut", "horizon", "shortest"),
    [(2, True, 9, False), (2, False, 7, False), (4, True, 7, False), (5, True, 3, False), (5, False, 3, True)],
)
def test_what_was_stopped_with_a_plan_has_the_best(halts, cut, horizon, shortest):
    world = World(LONG, horizon=9, halts=halts, cut=cut)
    assert run(world)[:2] == (horizon, shortest)
    assert world.questions == halts


@pytest.mark.parametrize(
    ("world", "settings", "asked"),
    [
        (World({9: [9]}, step=9, horizon=9), {"models": 0}, "9..9/100 9..9 all 0"),
        (World({9: [9]}, horizon=9), {"models": 0}, "1..9/100 1..8/100 9..9 all 0"),
        (World({9: [9]}, horizon=9), {"models": 2, "seconds": 0}, "1..9/100 9..9 all 2"),
        (World({9: [9]}, horizon=9, optimizes=True), {}, "1..9/100 1..8/100 9..9 all 1"),
        (World({9: [9]}, horizon=9, optimizes=True), {"seconds": 1}, "1..9/100"),
        (World({9: [9]}, horizon=9, halts=1), {"models": 0}, "1..9/100"),
    ],
)
def test_all_answers_or_the_best_are_those_of_the_plans_horizon(world, settings, asked):
    assert run(world, **settings)[::2] == (9, asked)


@pytest.mark.parametrize(
    ("world", "last", "horizon", "asked"),
    [
        (World({3: [1, 2, 3]}, step=2, horizon=5), plan(3, 1, 2, 3), 3, "3..3+2+3-4/100"),
        (World({4: [2, 3, 4]}, step=2, horizon=3), plan(4, 1, 2, 3, 4), 4, ">4 4..4+2+3+4/100"),
        (World({3: [2, 3]}, step=2, horizon=5), plan(4, 1, 2, 3), 3, "3..4+2+3-4-5/100"),
        (World({2: []}, step=2, horizon=3), plan(3, 1), 2, "2..3-2-3/100"),
        (World({7: []}, step=7, horizon=7), plan(3, 1), 7, "7..7-7/100"),
        (World({5: [3, 4, 5]}, step=3, horizon=4), plan(4, 1, 2, 3, 4), 5, "4..4+3+4/100 >5 5..5+3+4+5/100"),
        (World({4: [2, 4]}, step=2, horizon=4), plan(2, 1, 2), 4, "2..2+2-3/100 3..3+2+3-4/100 2..4+2/100"),
        (World({4: [3, 4]}, step=3, horizon=4), plan(3, 2, 3), 4, "3..3+3-4/100 4..4+3+4/100"),
        (World({3: [2, 3]}, step=2, horizon=3), plan(2, 1, 2, 9), 3, "2..3+2+9/100 2..3+10+2+3/100 2..3/100"),
        (World({3: [3]}, step=2, horizon=3, most=3), plan(4, 1, 2, 3, 4), 3, "2..3+2+3+4/100 2..3+2+3+4+5/100 2..3"),
        (World({3: [3]}, step=2, horizon=3), plan(1, 1), 3, "2..2-2-3/100 2..2+2-3/100 2..3+2/100 2..3/100"),
        (World({2: [2]}, step=2, horizon=3), plan(1, 1), 2, "2..2-2-3/100 2..2+2-3/100"),
    ],
)
def test_the_rest_of_the_last_plan_comes_first(world, last, horizon, asked):
    """As it is, or one step later, without anything else; then with more actions; then any plan."""
    assert run(world, last, seconds=0)[::2] == (horizon, asked)


@pytest.mark.parametrize(
    ("shortest", "foreseen", "least"), [(False, True, 9), (True, True, 7), (False, False, 3), (True, False, 3)]
)
def test_a_plan_that_goes_on_as_foreseen_has_had_its_time(shortest, foreseen, least):
    """Where it was the shortest, that is tried to prove again for a tenth of the time."""
    world = World({9: [9], 7: [7], 3: [3]}, horizon=9)
    assert run(world, plan(9, 9, shortest=shortest), seconds=20, foreseen=foreseen)[0] == least


@pytest.mark.parametrize("last", [None, plan(5, 5), plan(8, 8), plan(3, 2, shortest=True)])
def test_what_is_no_longer_a_plan_leaves_the_time_as_it_is(last):
    world = World({9: [9], 7: [7], 3: [3]}, horizon=9)
    assert run(world, last, seconds=20, foreseen=True)[0] == 3
