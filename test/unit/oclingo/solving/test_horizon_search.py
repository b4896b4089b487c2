"""At which horizons the search for an answer asks, in which order, and when more steps are grounded."""

from types import SimpleNamespace

import pytest

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.oclingo.solving import horizon_search
from rosoclingo.oclingo.solving.assumptions import Search
from rosoclingo.oclingo.solving.horizon_search import HorizonSearch, may_idle


class World:
    """A program whose answers lie at the horizons ``answers``, grounded up to ``horizon``, at most up to ``most``.

    A search of several horizons finds an answer of the last one. ``slow`` are horizons whose searches are ended,
    ``dead`` the horizon from which on nothing makes it satisfiable any more; after ``halts`` questions it is to end.
    """

    def __init__(self, answers, step=1, horizon=1, most=9, optimizes=False, **others):
        self.answers, self.most, self.asked = set(answers), most, []
        self.slow, self.dead, self.halts = others.get("slow", ()), others.get("dead"), others.get("halts")
        self.state = SimpleNamespace(settled=step, horizon=horizon)
        self.program = SimpleNamespace(optimizes=optimizes)
        self.conflicting = False

    def halt(self):
        return self.halts is not None and len(self.asked) >= self.halts

    def may_grow(self):
        return self.state.horizon < self.most

    def grow(self, block):
        self.asked.append("grow")
        self.state.horizon = min(self.state.horizon + block, self.most)

    def ready(self):
        return self

    def claim_in(self, grounding):
        assert grounding is self

    def search(self, models, halt, first, last, claim=None):
        assert 1 <= first <= last <= self.state.horizon
        self.asked.append(f"{first}..{last}" + (f" {models}" if models != 1 else ""))
        self.conflicting = self.dead is not None and last >= self.dead
        found = [horizon for horizon in range(first, last + 1) if horizon in self.answers]
        if any(first <= horizon <= last for horizon in self.slow):
            return Search(None)
        return Search(True, (), found[-1]) if found else Search(False)


def run(world, models=1, shortest=True, hint=0, block=1):
    search = HorizonSearch(models, shortest, hint, block, world.halt)
    assert (search.seconds, search.proven) == (0.0, False)
    found = search.run(world)
    assert 0.0 <= search.seconds < 100.0
    assert search.proven is (shortest and found.satisfiable is True), "the least horizon, where that was looked for"
    return found, search


@pytest.mark.parametrize(
    ("world", "settings", "horizon", "asked"),
    [
        (World([1]), {}, 1, "1..1"),
        (World([3]), {}, 3, "1..1 grow 2..2 grow 3..3"),
        (World([3, 4]), {"block": 3}, 3, "1..1 grow 2..4 2..3 2..2"),
        (World([4]), {"block": 3}, 4, "1..1 grow 2..4 2..3"),
        (World([2, 4], horizon=5), {"hint": 4}, 2, "1..3 1..1"),
        (World([4], horizon=5), {"hint": 4}, 4, "1..3 4..4"),
        (World([5], horizon=5), {"hint": 4}, 5, "1..3 4..4 5..5"),
        (World([2, 5], horizon=5), {"hint": 1}, 2, "1..1 2..5 2..4"),
        (World([5], horizon=5), {"hint": 9}, 5, "1..4 5..5"),
        (World([5], horizon=5), {"hint": 9, "shortest": False}, 5, "5..5"),
        (World([1, 2, 4], step=3, horizon=4), {}, 4, "3..3 4..4"),
        (World([1, 4], step=2, horizon=4), {}, 4, "2..2 3..4 3..3"),
        (World([0, 4], step=7, horizon=4), {}, 4, "4..4"),
    ],
)
def test_the_least_horizon_is_found(world, settings, horizon, asked):
    found, search = run(world, **settings)
    assert found.satisfiable is True
    assert found.horizon == horizon
    assert " ".join(world.asked) == asked
    assert not search.permanent


@pytest.mark.parametrize("way", [{"models": 0}, {"optimizes": True}])
def test_all_answers_or_the_best_are_those_of_the_least_horizon(way):
    models = way.get("models", 1)
    all_of = f" {models}" if models != 1 else ""
    for world, asked in (
        (
            World([2, 3], horizon=3, **{key: way[key] for key in way if key == "optimizes"}),
            f"1..1{all_of} 2..3 2..2{all_of} 2..2{all_of}",
        ),
        (
            World([2, 3], most=3, **{key: way[key] for key in way if key == "optimizes"}),
            f"1..1{all_of} grow 2..3 2..2{all_of} 2..2{all_of}",
        ),
    ):
        found, _ = run(world, models=models, block=2)
        assert found.horizon == 2
        assert " ".join(world.asked) == asked


@pytest.mark.parametrize(
    ("world", "settings", "satisfiable", "asked"),
    [
        (World([], most=3), {}, False, "1..1 grow 2..2 grow 3..3"),
        (World([], horizon=4, most=4), {"hint": 2}, False, "1..1 2..2 3..4"),
        (World([], horizon=4, dead=2), {"hint": 2}, False, "1..1 2..2"),
        (World([9], dead=3), {}, False, "1..1 grow 2..2 grow 3..3"),
        (World([4], horizon=4, slow=[2]), {"hint": 2}, None, "1..1 2..2"),
        (World([2, 4], slow=[3]), {"block": 3}, None, "1..1 grow 2..4"),
        (World([1, 4], horizon=4, slow=[2]), {"shortest": False}, True, "4..4"),
        (World([], horizon=3, most=4), {"models": 0}, False, "1..1 0 2..3 grow 4..4 0"),
        (World([1], halts=0), {}, None, ""),
        (World([3], halts=1), {}, None, "1..1"),
        (World([2, 3, 4], horizon=4, halts=2), {"hint": 1}, None, "1..1 2..4"),
    ],
)
def test_searches_without_an_answer(world, settings, satisfiable, asked):
    found, search = run(world, **settings)
    assert found.satisfiable is satisfiable
    assert " ".join(world.asked) == asked
    assert search.permanent == (world.dead is not None)


def test_where_one_horizon_is_asked_all_its_answers_come_at_once():
    for world in (World([1]), World([2])):
        run(world, models=0)
        assert len([one for one in world.asked if one != "grow"]) == max(world.answers)


def test_a_search_that_was_ended_tells_nothing_for_good():
    found, search = run(World([], slow=[1], dead=1))
    assert found.satisfiable is None
    assert not search.permanent


def test_seconds_are_those_of_the_searches(monkeypatch):
    clock = iter(range(100))
    monkeypatch.setattr(horizon_search, "time", SimpleNamespace(perf_counter=lambda: float(next(clock))))
    search = HorizonSearch(1, True, 0, 1, lambda: False)
    search.run(World([3]))
    assert search.seconds == 3.0


IDLE = "#program cumulative(t). {{ a(t) }}. {} #program volatile(t)."


class Ended:
    """An grounding whose searches are ended."""

    def __init__(self, *_settings, shortest):
        assert shortest

    def ground_to(self, step):
        assert step == 1, "nothing was found that might stay"
        self.grounded = step

    def search(self, models, _halt, first, last, best):
        assert (models, first, last) == (1, 1, self.grounded)
        return Search(None)


def test_a_trial_that_fails_is_no_answer(monkeypatch):
    def failing(*_settings, **_more):
        raise RuntimeError("too large")

    monkeypatch.setattr(horizon_search, "Grounding", failing)
    assert may_idle(ReactiveProgram.from_text(IDLE.format("")), lambda: False) is False


@pytest.mark.parametrize(
    ("rule", "idle"),
    [("", True), (":- t = 1.", False), (":- t = 2.", False), (":- t = 4.", False), (":- t = 5.", True)],
)
def test_whether_an_answer_stays_one_with_more_steps_is_tried_once(rule, idle, monkeypatch):
    program = ReactiveProgram.from_text(IDLE.format(rule))
    with monkeypatch.context() as patched:
        patched.setattr(horizon_search, "Grounding", Ended)
        assert may_idle(program, lambda: True) is False, "that was ended, so it is not known"
    assert may_idle(program, lambda: False) is idle
    monkeypatch.setattr(horizon_search, "Grounding", None)
    assert may_idle(program, lambda: False) is idle
