"""A grounding in which plans exist at known horizons: it answers a strategy's questions and notes them as text."""

from types import SimpleNamespace

from rosoclingo.oclingo import parse_atom
from rosoclingo.oclingo.errors import StoppedError
from rosoclingo.planning.history import cycle_of
from rosoclingo.planning.question import UNKNOWN, Reply
from rosoclingo.planning.snapshot import Snapshot
from rosoclingo.planning.strategy_runner import StrategyRunner


def actions(*cycles):
    return frozenset(parse_atom(f"_action_lib(go,x,{cycle})") for cycle in cycles)


class FakeGrounding:
    """Plans by their horizons (a dict or pairs), each given by the cycles in which it acts.

    The steps up to ``horizon`` are ground. A question about several horizons finds the plan of the last one. Horizon
    ``h`` is refuted after ``hard[h]`` conflicts; from horizon ``dead`` on the program is hopeless. After ``halts``
    questions there is a stop, which interrupts the last one if it is ``cut``. The program ``claims`` to need so many
    steps.

    Notes in ``asked``: ``2..5/100`` for these horizons and conflicts; then ``+3`` and ``-4`` for the cycles of actions
    assumed true and false, ``!`` for the best answer (``!0`` for all), ``?`` without advice; ``>7`` for growing to 7.
    """

    is_cyclic, grows = False, True

    def __init__(self, plans, step=1, horizon=1, most=99, hard=None, **options):
        self.plans = [*plans.items()] if isinstance(plans, dict) else plans
        self.step, self.horizon, self.most, self.hard = step, horizon, most, hard or {}
        self.dead, self.halts, self.cut = options.get("dead"), options.get("halts"), options.get("cut", False)
        self.claims = options.get("claims", 0)
        advises, optimizes = options.get("advises", False), options.get("optimizes", False)
        self.program = SimpleNamespace(forgets=(), advises=advises, optimizes=optimizes, actions_go_on=False)
        self.asked, self.questions = [], 0

    def run(self, make, block):
        """Return what the strategy made by ``make(runner)`` finds, None after a stop; and the notes."""
        snapshot = Snapshot(step=self.step, min_horizon=self.step, horizon=self.horizon)
        runner = StrategyRunner(self.program, snapshot, self.build, block, self.most)
        try:
            found = runner.run(make(runner), lambda: self.halts is not None and self.questions >= self.halts)
        except StoppedError:
            found = None
        return found, " ".join(self.asked)

    def build(self, _snapshot, horizon, stopped):
        if horizon > self.horizon:
            self.grow_to(horizon)
        return self

    def piece(self):
        return 64

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
        first, last, conflicts = question.first, question.last, question.conflicts
        assert self.step <= first <= last <= self.horizon
        assert question.best or question.models == 1
        assert question.advised or self.program.advises
        self.note(question)
        self.questions += 1
        if self.cut and stopped():
            return UNKNOWN
        horizons = range(first, last + 1)
        plans = [(one, actions(*cycles)) for one, cycles in self.plans if one in horizons]
        agreeing = [(one, plan) for one, plan in plans if self.agrees(plan, question)]
        if agreeing:
            horizon, plan = max(agreeing, key=lambda pair: pair[0])
            return Reply(True, (plan,), horizon)
        if conflicts is not None and not question.given and max(self.hard.get(one, 0) for one in horizons) > conflicts:
            return UNKNOWN
        dead = self.dead is not None and last >= self.dead
        return Reply(False, hopeless=dead, permanent=dead)

    @staticmethod
    def agrees(plan, question):
        """Return whether the plan is an answer to the question at any of its horizons."""
        given = all((action in plan) == value for action, value in question.given)
        return given and (not question.lacking or not plan.issuperset(question.lacking))

    def note(self, question):
        text = f"{question.first}..{question.last}"
        text += "".join(sorted("-+"[value] + str(cycle_of(one)) for one, value in question.given))
        text += "" if question.conflicts is None else f"/{question.conflicts}"
        text += ("!" if question.models == 1 else f"!{question.models}") if question.best else ""
        self.asked.append(text + ("" if question.advised else "?"))
