"""Late, repeated and false messages: each action and each end is right, and nothing on the robot is lost."""

from random import Random

import pytest
from carrying_world import HOUSE, OFFICE, ROBOT, Play
from hypothesis import given, settings
from hypothesis import strategies as st
from shipped import shipped
from workloads import sized

from rosoclingo.planning.solver import PlanSolver
from rosoclingo.reasoning.core import Core
from rosoclingo.reasoning.events import ActionsDispatched, GoalChanged, Problem
from rosoclingo.reasoning.settings import CoreSettings
from rosoclingo.reasoning.stream_planner import Halt

FILES = {"office": ("mailbot.lp", "office.lp"), "house": ("house.lp", "home.lp")}
DOMAINS = {"office": OFFICE, "house": HOUSE}


class Stage:
    """A core in this process, and the world that plays against it."""

    def __init__(self, name, seed, goals):
        program = shipped(*FILES[name])
        self.play = Play(DOMAINS[name], self, Random(seed), goals)
        self._commands, self._ends, self.problems = [], [], []
        make = lambda: PlanSolver(program)  # noqa: E731
        settings = CoreSettings(horizon_limit=40)
        self.core = Core(program, make, self._note, settings, watch_recovery=self.some_attempts)
        self.core.start()

    def some_attempts(self):
        """Fix the number of a recovery's attempts, independent of the machine's speed; a patient core makes more."""
        left = iter(range(8 * self.core.queue.patience))
        return lambda: None if next(left, None) is not None else Halt("the test")

    def send(self, key, text):
        self.core.add_goal(key, text)
        self.play.live[key].known = self.play.live[key].heard = True

    def cancel(self, key):
        self.core.cancel_goal(key)

    def tell(self, facts):
        self.core.receive("world", facts)

    def _note(self, event):
        if isinstance(event, ActionsDispatched):
            self._commands += [str(action.atom) for action in event.actions]
        elif isinstance(event, GoalChanged) and event.outcome is not None:
            self._ends.append((event.key, event.outcome.name.lower(), event.message))
        elif isinstance(event, Problem) and not event.origin:
            self.problems.append(f"cycle {event.cycle}: {event.message}")
            self.play._say("problem " + event.message)

    def run(self):
        """Play until all goals have ended."""
        for _ in range(100_000):
            ends, self._ends = self._ends, []
            for end in ends:
                self.play.ended(*end)
            if self._commands:
                self.play.command(self._commands.pop())
            elif not self.core.advance(0.0) and not self._ends and not self._commands:
                if self.play.over:
                    return
                before = len(self.play.log)
                self.play.stir()
                assert len(self.play.log) > before or not self.play.live, "it has come to rest with goals"
        raise AssertionError("the play does not end")


def check(name, seed, goals):
    stage = Stage(name, seed, goals)
    stage.run()
    for _ in range(20):
        if not stage.play.request_all_things_on_board():
            break
        stage.run()
    assert ROBOT not in {one.place for one in stage.play.things.values()}, stage.play.story
    assert stage.play.faults == [], stage.play.story
    assert [one for one in stage.problems if "no answer, even without" in one] == []
    return stage


@pytest.mark.slow
@settings(max_examples=max(1, settings.default.max_examples // 25), deadline=None)
@given(st.sampled_from(sorted(DOMAINS)), st.integers(0, 10**6))
def test_carrying_world_loses_nothing_and_reports_the_truth(name, seed):
    check(name, seed, goals=sized(5, 8))
