"""Random delivery programs and the shipped ones, with random facts of past, present and future cycles."""

from functools import lru_cache

import pytest
from core_driver import Driver
from hypothesis import HealthCheck, given, settings
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
EVENTS = st.lists(
    st.one_of(
        st.tuples(st.just("goal"), PLACES),
        st.tuples(st.just("cancel"), st.integers(0, 5)),
        st.tuples(st.just("facts"), st.lists(FACTS, min_size=1, max_size=4)),
        st.tuples(st.just("batch"), st.lists(FACTS, min_size=1, max_size=4), PLACES),
        st.tuples(st.just("return"), st.sampled_from(["odd", "hall", "failed"])),
        st.tuples(st.just("succeed")),
        st.tuples(st.just("finish")),
        st.tuples(st.just("again")),
    ),
    max_size=14,
)


class Play:
    """Applies events to a driver."""

    def __init__(self, driver, ask):
        self.driver, self.ask, self.goals, self.sent = driver, ask, 0, []

    def do(self, event, *values):
        """Apply one event."""
        getattr(self, event)(*values)

    def goal(self, place):
        """Send another goal."""
        self.goals += 1
        self.driver.goal(f"key{self.goals}", self.ask(place, self.goals))

    def cancel(self, number):
        """Cancel a goal, if there is one."""
        self.driver.cancel(f"key{number}")

    def facts(self, facts):
        """Send facts that are dated around the present cycle."""
        self.driver.facts(*map(self.text, facts))

    def batch(self, facts, place):
        """Send facts and a goal together."""
        self.driver.core.receive("sensor", [self.text(fact) for fact in facts])
        self.goal(place)

    def again(self):
        """Send an earlier message again."""
        self.driver.facts(*self.sent[-3:])

    def text(self, fact):
        """Return a fact's text; small cycles are absolute, others relative to now."""
        *words, cycle = fact
        if cycle != "now":
            cycle = cycle if 0 <= cycle <= 1 else max(0, self.driver.core.cycle + cycle)
        self.sent.append(f"{words[0]}({','.join(map(str, [*words[1:], cycle]))})")
        return self.sent[-1]

    def succeed(self):
        """Let the actions under way succeed."""
        self.driver.succeed()

    def finish(self):
        """Let all actions succeed."""
        self.driver.finish()

    def __getattr__(self, name):
        return {"return": self.answer}[name]

    def answer(self, value):
        """Return a value for an action under way."""
        for action in self.driver.core.awaited:
            self.driver.facts(f"_return({action.interface},{value},{action.cycle})")

    def ends(self, key):
        """Return the end of a goal."""
        events = self.driver.journal.of(GoalChanged)
        return [one.state.value for one in events if one.key == key and one.outcome is not None]


@pytest.mark.slow
@settings(max_examples=settings.default.max_examples // 2, suppress_health_check=[HealthCheck.too_slow])
@given(FLOORS, st.sampled_from(sorted(SHUT)), st.sampled_from(sorted(POWER)), EVENTS)
def test_random_facts_end_no_goal(doors, shut, power, events):
    driver = Driver(settings=CoreSettings(horizon_limit=30), program=program(doors, shut, power))
    play = Play(driver, lambda place, number: f"visit({place},{number})")
    for event in events:
        play.do(*event)
    driver.finish().goal("fresh", "visit(loft,99)").finish()
    assert play.ends("fresh") == ["succeeded"], driver.journal.problems
    for number in range(1, play.goals + 1):
        assert len(play.ends(f"key{number}")) == 1
        assert play.ends(f"key{number}")[0] in ("succeeded", "preempted", "recalled"), driver.journal.problems
    check_replay(driver.program, driver.journal)


THINGS = st.sampled_from(["cup", "newspaper", "book"])
HOUSE_ROOMS = st.sampled_from(["hallway", "living_room", "kitchen", "bedroom", "bathroom"])
HOUSE_FACTS = st.one_of(
    st.tuples(st.sampled_from(["_blocked", "_opened"]), HOUSE_ROOMS, HOUSE_ROOMS, CYCLES),
    st.tuples(st.just("_seen"), THINGS, HOUSE_ROOMS, CYCLES),
)
HOUSE_EVENTS = st.lists(
    st.one_of(
        st.tuples(st.just("goal"), st.tuples(HOUSE_ROOMS, THINGS)),
        st.tuples(st.just("facts"), st.lists(HOUSE_FACTS, min_size=1, max_size=3)),
        st.tuples(st.just("batch"), st.lists(HOUSE_FACTS, min_size=1, max_size=3), st.tuples(HOUSE_ROOMS, THINGS)),
        st.tuples(st.just("return"), st.sampled_from(["blocked", "failed", "odd"])),
        st.tuples(st.just("succeed")),
        st.tuples(st.just("finish")),
        st.tuples(st.just("again")),
    ),
    max_size=8,
)


@pytest.mark.slow
@settings(max_examples=settings.default.max_examples // 10, suppress_health_check=[HealthCheck.too_slow])
@given(HOUSE_EVENTS)
def test_random_facts_leave_house_program_alive(events):
    driver = Driver.of_shipped("house.lp", "home.lp")
    play = Play(driver, lambda what, number: f"bring({what[0]},{what[1]})")
    for event in events:
        play.do(*event)
    driver.finish().goal("fresh", "bring(bedroom,book)").finish()
    assert play.ends("fresh") == ["succeeded"], driver.journal.problems
    assert driver.core.live_goals == []
    check_replay(driver.program, driver.journal)
