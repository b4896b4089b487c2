"""Executed actions stay in the published plan, even after the solver has compacted them."""

import pytest
from core_driver import ERRANDS, Driver
from hypothesis import given, settings
from hypothesis import strategies as st
from stream_replay import check_replay

from rosoclingo.oclingo import parse_atom
from rosoclingo.reasoning.events import GoalProgress, PlanMade
from rosoclingo.reasoning.keywords import action_of
from rosoclingo.reasoning.returns import DONE
from rosoclingo.reasoning.stream_planner import Halt

#: Cycles without an action after which the solver no longer grounds the cycle before them.
IDLE = 40

#: Nothing can follow an errand ``do(trap,Id)``: the program restarts after it.
TRAP = ERRANDS + "#program cumulative(t).\n:- _action_lib(trap,I,t-2).\n"


def be_idle(driver, cycles=IDLE):
    """Let cycles without an action pass, for facts that nobody has sent yet."""
    for _ in range(cycles):
        driver.facts(f"_seen({driver.core.cycle})")


def check_past(driver):
    """Check that each plan, feedback and answer holds the last executed actions and nothing else of the past."""
    actions = [action_of(parse_atom(text)) for text in driver.journal.actions]
    for event in (*driver.journal.of(PlanMade), *driver.journal.of(GoalProgress)):
        past = [action for action in event.actions if action.cycle < event.cycle]
        assert past == [action for action in actions if action.cycle < event.cycle][-DONE:], event
    assert {one for one in driver.core.plan.actions if one.cycle < driver.core.cycle} <= set(actions)


EVENTS = st.lists(
    st.one_of(
        st.tuples(st.just("goal"), st.sampled_from(["walk", "run", "quick", "never", "trap"])),
        st.tuples(st.just("cancel"), st.integers(1, 5)),
        st.tuples(st.just("succeed"), st.integers(1, 5)),
        st.tuples(st.just("fail"), st.sampled_from(["failed", "timeout", "odd(thing,17)"])),
        st.tuples(st.just("idle"), st.sampled_from([1, IDLE])),
        st.tuples(st.just("halt"), st.lists(st.sampled_from(["", "slow", "left"]), min_size=1, max_size=5)),
    ),
    max_size=20,
)


class Play:
    """Applies events; ``halts`` are the ends of the coming searches: by themselves, by time, or dropped."""

    def __init__(self):
        self.goals, self.halts = 0, []
        self.driver = Driver(TRAP, watch=self.watch)

    def watch(self):
        """Choose when the next search is to end."""
        word = self.halts.pop(0) if self.halts else ""
        return lambda: Halt("the test", disturbed=word == "left") if word else None

    def do(self, kind, what):
        """Apply one event."""
        if kind == "goal":
            self.goals += 1
            self.driver.goal(str(self.goals), f"do({what},{self.goals})")
        elif kind == "cancel":
            self.driver.cancel(str(what))
        elif kind == "idle":
            be_idle(self.driver, what)
        elif kind == "halt":
            self.halts = what
        elif kind == "succeed":
            for _ in range(what):
                self.driver.succeed()
        elif self.driver.core.awaited:
            self.driver.fail(what)


@pytest.mark.slow
@settings(max_examples=settings.default.max_examples // 4)
@given(EVENTS)
def test_plan_keeps_past_after_any_events(events):
    play = Play()
    for event in events:
        play.do(*event)
    play.halts = []
    play.driver.finish().goal("fresh", "do(walk,99)").finish()
    assert play.driver.states("fresh")[-1] == "succeeded"
    check_past(play.driver)
    if not any(kind == "halt" for kind, _ in events):
        check_replay(play.driver.program, play.driver.journal)
