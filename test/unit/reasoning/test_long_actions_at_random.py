"""Random courses of actions that go on: each update is the one that an independent model of the interfaces predicts."""

import json
from contextlib import nullcontext

import pytest
from core_driver import shortest
from hypothesis import example, given
from hypothesis import strategies as st
from stream_play import compacting
from team_programs import TEAM

from rosoclingo.oclingo import ReactiveProgram, parse_update
from rosoclingo.reasoning.core import Core
from rosoclingo.reasoning.events import ActionsDispatched, GoalChanged, UpdateSent
from rosoclingo.reasoning.keywords import ACTION_LIB, RETURN, RUNNING
from rosoclingo.reasoning.settings import CoreSettings

PROGRAM = ReactiveProgram.from_text(TEAM)
MACHINES = ("saw", "drill", "lathe")
TIMEOUT = 50.0


class Workshop:
    """Interfaces, and a model of the updates that a core with the program TEAM has to send."""

    def __init__(self):
        self.core, self.now = self._start(None), 1.0
        self.running, self.since = {}, {}  # sent actions by (machine, job), and when they were sent
        self.cycle, self.executed = 0, set()  # the present cycle, and the (machine, job) pairs that are actions of it
        self.returns = set()  # the returns of the present cycle
        self.goals, self.ends, self.done = {}, {}, set()
        self.core.start()
        self.run()

    def _start(self, record):
        settings = CoreSettings(horizon_limit=12, action_timeout=TIMEOUT, search_timeout=0.0)
        return Core(PROGRAM, lambda: shortest(PROGRAM), self.hear, settings, record=record)

    def hear(self, event):
        """Check an event of the core."""
        if isinstance(event, UpdateSent):
            self.check(event.cycle, parse_update(event.stream))
        elif isinstance(event, ActionsDispatched):
            for action in event.actions:
                name = str(action.interface), action.parameter.number
                assert action.cycle == event.cycle == self.cycle
                assert name not in self.running, "it runs already"
                assert name not in self.done, "it was done already"
                self.running[name], self.since[name] = action, self.now
                self.executed.add(name)
        elif isinstance(event, GoalChanged) and event.outcome is not None:
            assert self.ends.setdefault(event.key, event.state.value) == event.state.value
            assert event.key in self.goals

    def check(self, step, update):
        """Compare an update with the model, and begin the next cycle."""
        atoms = {str(one) for one in [*update.heads, *update.committed] if one is not None}
        found = {name: {one for one in atoms if one.startswith(name)} for name in (ACTION_LIB, RUNNING, RETURN)}
        cycles = range(self.cycle, step) if self.cycle else ()
        expected = {ACTION_LIB: set(), RUNNING: set(), RETURN: self.returns}
        for cycle in cycles:
            names = self.executed if cycle == self.cycle else self.running
            expected[ACTION_LIB] |= {f"_action_lib({machine},{job},{cycle})" for machine, job in names}
            expected[RUNNING] |= {f"_running({machine},{job},{cycle})" for machine, job in self.running}
        assert found == expected
        self.cycle, self.executed, self.returns = step, set(self.running), set()

    def run(self):
        """Advance the core until it waits."""
        for _ in range(50):
            self.core.poll(self.now)
            if not self.core.advance(self.now):
                return
        raise AssertionError("the core does not come to rest")

    def goal(self, machine, job):
        """Send a goal."""
        number = len(self.goals)
        self.goals[f"goal{number}"] = machine
        self.core.add_goal(f"goal{number}", f"job({machine},{number + 10})")

    def cancel(self, number):
        """Cancel a goal."""
        self.core.cancel_goal(f"goal{number}")

    def end(self, which, succeeds):
        """Let one of the running actions end."""
        if not self.running:
            return
        name = machine, job = sorted(self.running)[which % len(self.running)]
        action = self.running.pop(name)
        value = job if succeeds else f"failed({job})"
        self.done |= {name} if succeeds else set()
        self.returns.add(f"_return({machine},{value},{self.cycle})")
        self.core.receive(machine, [f"_return({machine},{value},{action.cycle})"])

    def fact(self, number):
        """Send a fact, some of which the program does not know."""
        self.core.receive("eye", [f"_spot({number},now)", "_unknown(1)"])

    def wait(self, seconds):
        """Let time pass; actions that have run too long fail."""
        self.now += seconds
        for name in [one for one, since in self.since.items() if one in self.running and self.now - since >= TIMEOUT]:
            del self.running[name]
            self.returns.add(f"_return({name[0]},timeout,{self.cycle})")

    def restart(self):
        """Replace the core by one that continues from its journal."""
        self.core = self._start(json.loads(json.dumps(self.core.state())))
        self.core.start()

    def play(self, events):
        """Play events, given as the names and arguments of methods, and finish."""
        for name, *values in events:
            getattr(self, name)(*values)
        self.run()
        self.finish()

    def finish(self):
        """Let all actions succeed; each goal must end once, with the right status."""
        for _ in range(60):
            if not self.running:
                break
            self.end(0, succeeds=True)
            self.run()
        assert self.core.live_goals == []
        assert not self.core.awaited
        assert self.ends.keys() == self.goals.keys()


NUMBERS = st.integers(0, 6)
EVENTS = st.one_of(
    st.tuples(st.just("goal"), st.sampled_from([*MACHINES, "broken"]), st.just(0)),
    st.tuples(st.just("goal"), st.sampled_from(MACHINES), st.just(0)),
    st.tuples(st.just("cancel"), NUMBERS),
    st.tuples(st.just("end"), NUMBERS, st.booleans()),
    st.tuples(st.just("end"), NUMBERS, st.just(True)),
    st.tuples(st.just("fact"), st.integers(1, 9)),
    st.tuples(st.just("wait"), st.sampled_from([1.0, 60.0])),
    st.tuples(st.just("restart")),
    st.tuples(st.just("run")),
)


@pytest.mark.slow
@example(
    [("goal", "saw", 0), ("run",), ("goal", "drill", 0), ("run",), ("restart",), ("end", 1, True), ("run",)], False
)
@given(st.lists(EVENTS, min_size=3, max_size=24), st.booleans())
def test_random_long_actions_give_predicted_updates(events, compacts):
    """The updates are the same if past steps are compacted early."""
    with compacting(2) if compacts else nullcontext():
        Workshop().play(events)
