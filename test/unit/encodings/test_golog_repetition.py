"""Control programs that are cancelled, aborted, sent again and withdrawn in any order, with the pure core."""

from functools import lru_cache

import pytest
from busy_driver import BusyDriver
from core_driver import Driver
from core_scripts import play
from golog_scripts import domain_with
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

PROGRAMS = """
proc short { a; b; }
proc tidied { do { a; b; } on cancel { tidy; calm; } }
proc waiting { a; do { await f; b; } on cancel { tidy; } }
proc doubtful { do { a; b; } on cancel { tidy; test g; calm; } }
proc caught { try { a; b; } else { c; } }
proc again { retry 1 { do { a; b; } on cancel { tidy; } } }
proc whole { alone { do { a; b; c; } on cancel { tidy; calm; } } }
proc both { interleave { short; } with { tidied; } }
proc open { interrupts { when not f { c; await f; } } until f; b; }
proc late { await g; c; }
proc patient { do { a; b; } on cancel { await f; tidy; } }
proc nothing { }
"""
NAMES = [line.split()[1] for line in PROGRAMS.splitlines() if line]


@lru_cache(maxsize=None)
def program():
    """Return the domain with these programs."""
    return domain_with(PROGRAMS)


@pytest.mark.slow
def test_golog_program_not_yet_begun_can_be_withdrawn():
    driver = BusyDriver(program=program(), most=2).goal("g", "run(waiting,1)").succeed().goal("h", "run(late,2)")
    driver.most = 1
    driver.facts("_set(g,now)")
    assert [goal.key for goal in driver.core.queue.waiting] == ["h"]
    play(driver, "facts _set(f,now); finish; is g succeeded; is h succeeded")
    assert [action.split(",")[1] for action in driver.journal.actions] == ["a", "b", "c"]
    assert "#withdraw _request(run(late,2)," in driver.journal.stream


# ---- in any order ----------------------------------------------------------------------------------------------------

FLUENTS = ["f", "g", "no(a)", "no(b)", "no(tidy)"]
FACTS = st.builds("{}({},now)".format, st.sampled_from(["_set", "_unset"]), st.sampled_from(FLUENTS))
HAPPENED = st.one_of(
    st.tuples(st.just("ask"), st.sampled_from([*NAMES, "missing"]), st.integers(1, 2)),
    st.tuples(st.just("ask"), st.sampled_from(NAMES), st.integers(1, 2)),
    st.tuples(st.just("retract"), st.integers(0, 3)),
    st.tuples(st.just("succeed")),
    st.tuples(st.just("fail"), st.sampled_from(["stuck", "preempted"])),
    st.tuples(st.just("facts"), FACTS),
)


class Play(Driver):
    """A core with these programs, and events that concern its goals."""

    def __init__(self):
        self.keys = []
        super().__init__(program=program())

    def ask(self, name, identity):
        self.keys.append(f"{len(self.keys)} {name}")
        self.goal(self.keys[-1], f"run({name},{identity})")

    def retract(self, number):
        """Cancel a goal, the last one with the number 0."""
        if self.keys:
            self.cancel(self.keys[-1 - number % len(self.keys)])

    def fail(self, reason):
        """Fail the action under way, if there is one."""
        return super().fail(reason) if self.core.awaited else self

    def end(self):
        """Make all actions possible and successful again: each goal ends."""
        self.facts("_set(f,now)", "_set(g,now)", *(f"_unset({one},now)" for one in FLUENTS[2:])).finish()
        for key in self.keys:
            last, message = self.states(key)[-1], self.message(key)
            assert last in ("rejected", "recalled", "preempted", "succeeded", "aborted"), key
            assert last != "rejected" or "missing" in key or "is in use" in message, message
        assert not self.problems


@pytest.mark.slow
@settings(max_examples=max(1, settings.default.max_examples // 3), phases=[Phase.explicit, Phase.reuse, Phase.generate])
@given(st.lists(HAPPENED, min_size=4, max_size=12))
def test_golog_goals_end_and_the_core_continues(script):
    play = Play()
    for name, *values in script:
        getattr(play, name)(*values)
    play.end()
