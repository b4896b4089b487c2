"""Random delivery programs, with random facts of past, present and future cycles."""

from functools import lru_cache

import pytest
from core_driver import Driver
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from stream_replay import check_replay

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.reasoning.events import GoalChanged
from rosoclingo.reasoning.settings import CoreSettings

ROOMS = ("hall", "den", "attic", "loft")

#: A robot moves between rooms; doors are closed and batteries low for some cycles, so a plan can always wait.
PROGRAM = """
#external _request/2. #external _return/3. #external _shut/3. #external _low/1.
#program base.
way(A,B) :- door(A,B). way(A,B) :- door(B,A). at(hall,0). {doors}
#program cumulative(t).
wanted(R,I,t) :- _request(visit(R,I),t+1).
wanted(R,I,t) :- wanted(R,I,t-1), not done(I,t-1), not _request(cancel(I),t).
{{ _action_lib(go,B,t) : way(A,B), at(A,t-1) }} 1{power}.
:- _action_lib(go,B,t), not busy(t).
busy(t) :- wanted(R,I,t).
{doors_rules}
low(t) :- _low(t).
failed(t) :- _return(go,V,t), not _action_lib(go,V,t).
moved(t) :- _action_lib(go,B,t), not failed(t).
at(B,t) :- _action_lib(go,B,t), not failed(t).
at(A,t) :- at(A,t-1), not moved(t).
done(I,t) :- wanted(R,I,t), at(R,t).
#program volatile(t).
:- wanted(R,I,t), not done(I,t).
#program base.
#show _action_lib/3.
"""
SHUT = {
    "same step": ":- _action_lib(go,B,t), at(A,t-1), _shut(A,B,t).",
    "next step": ":- _action_lib(go,B,t), at(A,t-1), _shut(A,B,t-1).",
    "inertia": """shut(A,B,3,t) :- _shut(A,B,t).
        shut(A,B,N-1,t) :- shut(A,B,N,t-1), N > 1.
        :- _action_lib(go,B,t), at(A,t-1), shut(A,B,N,t).""",
    "inertia, next step": """shut(A,B,3,t) :- _shut(A,B,t-1).
        shut(A,B,N-1,t) :- shut(A,B,N,t-1), N > 1.
        :- _action_lib(go,B,t), at(A,t-1), shut(A,B,N,t).""",
    "never been": ":- at(B,t), not at(B,t-1), _shut(A,B,t), way(A,B).",
}
POWER = {"no battery": "", "same step": " :- not low(t)", "next step": " :- not low(t-1)"}


@lru_cache(maxsize=None)
def program(doors, shut, power):
    """Return one of the programs; ``doors`` are pairs of rooms."""
    facts = " ".join(f"door({one},{other})." for one, other in doors)
    return ReactiveProgram.from_text(PROGRAM.format(doors=facts, doors_rules=SHUT[shut], power=POWER[power]))


LINE = (("hall", "den"), ("den", "attic"), ("attic", "loft"))
FLOORS = st.sampled_from([LINE, (*LINE, ("loft", "hall")), (("hall", "den"), ("hall", "attic"), ("attic", "loft"))])
PLACES = st.sampled_from(ROOMS)
CYCLES = st.one_of(st.just("now"), st.integers(-6, 6), st.integers(0, 3))
FACTS = st.one_of(st.tuples(st.just("_shut"), PLACES, PLACES, CYCLES), st.tuples(st.just("_low"), CYCLES))


FEW = st.lists(FACTS, min_size=1, max_size=4)

#: Goals, cancels, messages with facts, and returns; the methods of Play.
EVENTS = st.one_of(
    st.tuples(st.just("ask"), PLACES),
    st.tuples(st.just("cancel"), st.integers(0, 5).map("key{}".format)),
    st.tuples(st.just("tell"), FEW),
    st.tuples(st.just("tell"), FEW, PLACES),
    st.tuples(st.just("answer"), st.sampled_from(["odd", "hall", "failed"])),
    st.tuples(st.sampled_from(["succeed", "finish", "repeat"])),
)


class Play(Driver):
    """A core with further events."""

    asked, sent = 0, ()

    def ask(self, place):
        """Send another goal."""
        self.asked += 1
        self.goal(f"key{self.asked}", f"visit({place},{self.asked})")

    def tell(self, facts, place=None):
        """Send facts that are dated around the present cycle, perhaps together with a goal."""
        self.core.receive("interface", [self.text(fact) for fact in facts])
        self.ask(place) if place else self.run()

    def repeat(self):
        """Send an earlier message again."""
        self.facts(*self.sent[-3:])

    def text(self, fact):
        """Return a fact's text; small cycles are absolute, others relative to now."""
        *words, cycle = fact
        if cycle != "now":
            cycle = cycle if 0 <= cycle <= 1 else max(0, self.core.cycle + cycle)
        self.sent = (*self.sent, f"{words[0]}({','.join(map(str, [*words[1:], cycle]))})")
        return self.sent[-1]

    def answer(self, value):
        """Return a value for all actions under way."""
        self.facts(*(f"_return({one.interface},{value},{one.cycle})" for one in self.core.awaited))

    def ends(self, key):
        """Return the ends of a goal."""
        events = self.journal.of(GoalChanged)
        return [one.state.value for one in events if one.key == key and one.outcome is not None]


#: Successive messages during one action.
TURNS = ("_low", "now"), ("_shut", "hall", "den", "now")


@pytest.mark.slow
@settings(max_examples=settings.default.max_examples // 2, suppress_health_check=[HealthCheck.too_slow])
@example(LINE, "inertia", "next step", [("ask", "den"), *[("tell", [one]) for one in TURNS]])
@given(FLOORS, st.sampled_from(sorted(SHUT)), st.sampled_from(sorted(POWER)), st.lists(EVENTS, max_size=14))
def test_random_facts_end_no_goal(doors, shut, power, events):
    driver = Play(settings=CoreSettings(horizon_limit=30), program=program(doors, shut, power))
    for name, *values in events:
        getattr(driver, name)(*values)
    assert driver.finish().goal("fresh", "visit(loft,99)").finish().ends("fresh") == ["succeeded"], driver.problems
    check_replay(driver.program, driver.journal)
    for number in range(1, driver.asked + 1):
        (end,) = driver.ends(f"key{number}")
        assert end in ("succeeded", "preempted", "recalled"), driver.problems
