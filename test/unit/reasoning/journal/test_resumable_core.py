"""A core that resumes from its record behaves like an uninterrupted one."""

import dataclasses
import json

import pytest
from core_driver import ERRANDS, first, shortest
from hypothesis import given, settings
from hypothesis import strategies as st
from stream_logs import text_of

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.reasoning.core import Core
from rosoclingo.reasoning.events import GoalUnmet, PlanMade, StateChanged
from rosoclingo.reasoning.settings import CoreSettings

SETTINGS = CoreSettings(horizon_limit=12, search_timeout=0.0, action_timeout=30.0, goals_at_once=3, overtaking_limit=3)


class Play:
    """A core and its input; after the steps in ``cuts`` it is rebuilt from its record."""

    def __init__(self, program, solver, settings, cuts=()):
        self.program, self._make, self._settings = program, lambda: solver(program), settings
        self.events, self.now, self._cuts, self._steps = [], 1.0, cuts, 0
        self._believed = None
        self.core = self._new()

    def _new(self, record=None):
        return Core(self.program, self._make, self._take, self._settings, record=record)

    def _take(self, event):
        """Collect the core's messages; a resumed core publishes its beliefs again."""
        if isinstance(event, StateChanged):
            if event.atoms == self._believed:
                return
            self._believed = event.atoms
        self.events.append(event)

    def play(self, script):
        """Play a script; return all messages."""
        self.core.start()
        self._step()
        for happened in script:
            happened(self)
            self._step()
            self._go_on()
        return [_plain(event) for event in self.events]

    def _go_on(self):
        for _ in range(60):
            self.core.poll(self.now)
            self._step()
            if not self.core.advance(self.now):
                return
            self._step()

    def _step(self):
        """Mark the end of a step, at which the core can be killed."""
        self._steps += 1
        if self._steps in self._cuts:
            self.core = self._new(json.loads(json.dumps(self.core.state())))
            self.core.start()

    def answer(self, which, value):
        """Return an action with success (None) or a value."""
        awaited = self.core.awaited
        if awaited:
            one = awaited[which % len(awaited)]
            self.core.receive("hand", [f"_return({one.interface},{value or one.parameter},{one.cycle})"])

    def wait(self, seconds):
        """Let time pass."""
        self.now += seconds


def _plain(event):
    """Strip a message of times and log text, which differ between cores."""
    if isinstance(event, PlanMade):
        return dataclasses.replace(event, ground=0.0, solve=0.0)
    if isinstance(event, GoalUnmet):
        return dataclasses.replace(event, stream=event.stream._replace(log=text_of(event.stream.log)))
    return event


SIZES = st.integers(0, 5)
COMMON = [
    st.builds(lambda which: lambda play: play.answer(which, None), SIZES),
    st.builds(lambda which: lambda play: play.answer(which, None), SIZES),
    st.builds(
        lambda which, value: lambda play: play.answer(which, value), SIZES, st.sampled_from(["failed", "blocked"])
    ),
    st.builds(lambda seconds: lambda play: play.wait(seconds), st.sampled_from([0.5, 31.0])),
    st.builds(lambda paused: lambda play: play.core.pause(paused), st.booleans()),
    st.just(lambda play: play.core.stop("is aborted: stopped")),
]


def scripts(texts, facts):
    """Generate possible input of a core: goals with these texts, and facts."""
    goals = st.builds(lambda text: lambda play: play.core.add_goal(text, text), texts)
    cancels = st.builds(lambda text: lambda play: play.core.cancel_goal(text), texts)
    others = st.builds(lambda fact: lambda play: play.core.receive("sensor", [fact]), st.sampled_from(facts))
    return st.lists(st.one_of(goals, goals, cancels, others, *COMMON), min_size=3, max_size=14)


CUTS = st.frozensets(st.integers(1, 60), min_size=1, max_size=4)
ERRAND = st.builds("do({},{})".format, st.sampled_from(["walk", "run", "quick", "never"]), st.integers(1, 6))


def compare(program, solver, script, cuts):
    """Play the script with and without rebuilding the core from its record, and compare."""
    plays = [Play(program, solver, SETTINGS, where).play(script) for where in ((), cuts)]
    assert plays[0] == plays[1]


#: Errands with beliefs of all kinds.
BELIEVED = ERRANDS + '#show done/2. at(2,0). #show at/2. #show "a,b". #show 7.'

#: Solvers for either setting of ``~plan``, without time to improve plans: two runs would improve them differently.
SOLVERS = {"shortest": shortest, "first": first}


@pytest.mark.slow
@pytest.mark.parametrize("solver", SOLVERS.values(), ids=SOLVERS)
@settings(max_examples=max(10, settings.default.max_examples // 4))
@given(script=scripts(ERRAND, ["_seen(ball)", "_seen(cup)", "_unheard(1)"]), cuts=CUTS)
def test_resumed_core_finishes_errands_like_uninterrupted_core(solver, script, cuts):
    compare(ReactiveProgram.from_text(BELIEVED), solver, script, cuts)
