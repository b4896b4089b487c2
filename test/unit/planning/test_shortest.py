"""At which horizons the search for a shortest plan asks, in which order, and when more steps are ground."""

from types import SimpleNamespace

import pytest

from rosoclingo.oclingo import ReactiveProgram, SolverError
from rosoclingo.planning import idling
from rosoclingo.planning.asking import Asking
from rosoclingo.planning.grounding import Grounding
from rosoclingo.planning.idling import may_idle
from rosoclingo.planning.question import UNKNOWN, Reply, StoppedError
from rosoclingo.planning.snapshot import Snapshot
from rosoclingo.planning.strategies.shortest import shortest


class World:
    """A grounding with answers at the horizons ``answers``, ground up to ``horizon``, at most up to ``most``.

    The reply about several horizons has an answer of the last one. A stop interrupts the search of a ``slow`` horizon;
    from horizon ``dead`` on nothing makes the program satisfiable any more; after ``halts`` questions there is a stop.
    """

    is_cyclic, atoms_per_step = False, 1

    def __init__(self, answers, step=1, horizon=1, most=9, optimizes=False, **others):
        self.answers, self.most, self.asked = set(answers), most, []
        self.slow, self.dead, self.halts = others.get("slow", ()), others.get("dead"), others.get("halts")
        self.step, self.horizon = step, horizon
        self.program = SimpleNamespace(optimizes=optimizes, forgets=())
        self.questions, self.stopped = 0, False

    def halt(self):
        return self.stopped or (self.halts is not None and self.questions >= self.halts)

    def grow_to(self, horizon):
        assert self.horizon < horizon <= self.most
        self.asked.append(f">{horizon}")
        self.horizon = horizon

    def ask(self, question, stopped):
        first, last = question.first, question.last
        assert 1 <= first <= last <= self.horizon
        assert question.models == 1 or question.best
        self.asked.append(f"{first}..{last}" + (f" {question.models}" if question.models != 1 else ""))
        self.questions += 1
        self.stopped = any(first <= horizon <= last for horizon in self.slow)
        if self.stopped:
            return UNKNOWN
        found = [horizon for horizon in range(first, last + 1) if horizon in self.answers]
        dead = self.dead is not None and last >= self.dead
        return Reply(True, (), found[-1]) if found else Reply(False, hopeless=dead, permanent=dead)


def run(world, models=1, hint=0, block=1):
    """Return what was found, None after a stop; and the questions."""
    snapshot = Snapshot(step=world.step, settled=world.step, horizon=world.horizon)
    asking = Asking(world.program, snapshot, lambda *_: world, block, world.most)
    assert asking.seconds == 0.0
    try:
        found = asking.run(shortest(asking, models, hint), world.halt)
    except StoppedError:
        found = None
    assert found is None or found.proven is (found.reply.satisfiable is True)
    assert 0.0 <= asking.seconds < 100.0
    return found, " ".join(world.asked)


@pytest.mark.parametrize(
    ("world", "settings", "horizon", "asked"),
    [
        (World([1]), {}, 1, "1..1"),
        (World([3]), {}, 3, "1..1 >2 2..2 >3 3..3"),
        (World([3, 4]), {"block": 3}, 3, "1..1 >4 2..4 2..3 2..2"),
        (World([4]), {"block": 3}, 4, "1..1 >4 2..4 2..3"),
        (World([4], most=4), {"block": 8}, 4, "1..1 >4 2..4 2..3"),
        (World([2, 4], horizon=5), {"hint": 4}, 2, "1..3 1..1"),
        (World([4], horizon=5), {"hint": 4}, 4, "1..3 4..4"),
        (World([5], horizon=5), {"hint": 4}, 5, "1..3 4..4 5..5"),
        (World([2, 5], horizon=5), {"hint": 1}, 2, "1..1 2..5 2..4"),
        (World([5], horizon=5), {"hint": 9}, 5, "1..4 5..5"),
        (World([1, 2, 4], step=3, horizon=4), {}, 4, "3..3 4..4"),
        (World([1, 4], step=2, horizon=4), {}, 4, "2..2 3..4 3..3"),
    ],
)
def test_the_least_horizon_is_found(world, settings, horizon, asked):
    found, questions = run(world, **settings)
    assert found.reply.satisfiable is True
    assert (found.reply.horizon, questions) == (horizon, asked)


@pytest.mark.parametrize(("models", "optimizes"), [(0, False), (1, True)])
@pytest.mark.parametrize(
    ("options", "asked"), [({"horizon": 3}, "1..1 2..3 2..2 2..2{0}"), ({"most": 3}, "1..1{0} >3 2..3 2..2 2..2{0}")]
)
def test_all_answers_or_the_best_are_those_of_the_least_horizon(models, optimizes, options, asked):
    found, questions = run(World([2, 3], optimizes=optimizes, **options), models=models, block=2)
    assert found.reply.horizon == 2
    assert questions == asked.format(" 0" if models == 0 else "")


@pytest.mark.parametrize(
    ("world", "settings", "satisfiable", "asked"),
    [
        (World([], most=3), {}, False, "1..1 >2 2..2 >3 3..3"),
        (World([], horizon=4, most=4), {"hint": 2}, False, "1..1 2..2 3..4"),
        (World([], horizon=4, dead=2), {"hint": 2}, False, "1..1 2..2"),
        (World([9], dead=3), {}, False, "1..1 >2 2..2 >3 3..3"),
        (World([], horizon=3, most=4), {"models": 0}, False, "1..1 2..3 >4 4..4 0"),
        (World([4], horizon=4, slow=[2]), {"hint": 2}, None, "1..1 2..2"),
        (World([2, 4], slow=[3]), {"block": 3}, None, "1..1 >4 2..4"),
        (World([], slow=[1], dead=1), {}, None, "1..1"),
        (World([1], halts=0), {}, None, ""),
        (World([3], halts=1), {}, None, "1..1"),
        (World([2, 3, 4], horizon=4, halts=2), {"hint": 1}, None, "1..1 2..4"),
    ],
)
def test_searches_without_an_answer(world, settings, satisfiable, asked):
    found, questions = run(world, **settings)
    assert (found and found.reply.satisfiable, questions) == (satisfiable, asked)
    assert found is None or found.reply.permanent == (world.dead is not None)


# ---- Whether answers outlive further steps ---------------------------------------------------------------------------

IDLE = "#program cumulative(t). {{ a(t) }}. {} #program volatile(t)."


def test_may_idle_is_false_where_the_program_is_refused(monkeypatch):
    def failing(*_settings, **_more):
        raise SolverError("too large")

    monkeypatch.setattr(idling, "Grounding", failing)
    assert may_idle(ReactiveProgram.from_text(IDLE.format("")), lambda: False) is False


@pytest.mark.parametrize(
    ("rule", "idle"),
    [("", True), (":- t = 1.", False), (":- t = 2.", False), (":- t = 4.", False), (":- t = 5.", True)],
)
def test_may_idle_is_found_out_once_for_a_program(rule, idle, monkeypatch):
    program = ReactiveProgram.from_text(IDLE.format(rule))
    with monkeypatch.context() as patched:
        patched.setattr(Grounding, "ask", lambda *_asked: UNKNOWN)
        assert may_idle(program, lambda: True) is False, "that was interrupted, so it is not known"
    assert may_idle(program, lambda: False) is idle
    monkeypatch.setattr(idling, "Grounding", None)
    assert may_idle(program, lambda: False) is idle
