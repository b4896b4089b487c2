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


def check_past(driver):
    """Check that each plan, feedback and answer holds the last executed actions and nothing else of the past."""
    actions = [action_of(parse_atom(text)) for text in driver.journal.actions]
    for event in (*driver.journal.of(PlanMade), *driver.journal.of(GoalProgress)):
        past = [action for action in event.actions if action.cycle < event.cycle]
        assert past == [action for action in actions if action.cycle < event.cycle][-DONE:], event
    assert {one for one in driver.core.plan.actions if one.cycle < driver.core.cycle} <= set(actions)


EVENTS = st.lists(
    st.one_of(
        st.tuples(st.just("ask"), st.sampled_from(["walk", "run", "quick", "never", "trap"])),
        st.tuples(st.just("cancel"), st.sampled_from("12345")),
        *[st.tuples(st.just("succeed"))] * 3,
        st.tuples(st.just("fail"), st.sampled_from(["failed", "timeout", "odd(thing,17)"])),
        st.tuples(st.just("idle"), st.sampled_from([1, IDLE])),
        st.tuples(st.just("halt"), st.lists(st.sampled_from(["", "slow", "left"]), min_size=1, max_size=5)),
    ),
    max_size=24,
)


class Play(Driver):
    """A core whose coming searches end by themselves, by time, or dropped: ``halts``."""

    goals, halts = 0, ()

    def __init__(self):
        super().__init__(TRAP, watch=self.watch)

    def watch(self):
        """Choose when the next search is to end."""
        word, self.halts = "".join(self.halts[:1]), self.halts[1:]
        return lambda: Halt("the test", disturbed=word == "left") if word else None

    def halt(self, words):
        """End the coming searches in these ways."""
        self.halts = words

    def ask(self, what):
        """Send another goal."""
        self.goals += 1
        self.goal(str(self.goals), f"do({what},{self.goals})")

    def idle(self, cycles):
        """Let cycles without an action pass, for facts that nobody has sent yet."""
        for _ in range(cycles):
            self.facts(f"_seen({self.core.cycle})")

    def fail(self, reason):
        """Fail the action under way, if there is one."""
        return super().fail(reason) if self.core.awaited else self


@pytest.mark.slow
@settings(max_examples=settings.default.max_examples // 4)
@given(EVENTS)
def test_plan_keeps_past_after_any_events(events):
    driver = Play()
    for name, *values in events:
        getattr(driver, name)(*values)
    driver.halt(())
    driver.finish().goal("fresh", "do(walk,99)").finish()
    assert driver.states("fresh")[-1] == "succeeded"
    check_past(driver)
    if not any(name == "halt" for name, *_ in events):
        check_replay(driver.program, driver.journal)
