"""Random goals, cancels, returns, failures, duplicates, delays, garbage and halted searches: the mailbot in a core.

The world is modelled independently of the program: a robot, packages, and interfaces. Invariants are checked after
each step; at the end all actions under way succeed, and every goal must have ended.
"""

from contextlib import ExitStack, nullcontext

from core_driver import Driver
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule
from late_standby import NEVER, Standby
from office_world import OFFICES, World
from shipped import shipped
from stream_play import compacting
from stream_replay import check_replay

from rosoclingo.reasoning.events import ActionsDispatched, ActionsPreempted, GoalChanged, GoalProgress, PlanMade
from rosoclingo.reasoning.returns import DONE
from rosoclingo.reasoning.settings import CoreSettings
from rosoclingo.reasoning.stream_planner import Halt, unwatched

REASONS = ("failed", "blocked", "timeout", "server_lost", "something(odd,17)", '"no text of any kind"')
TIMEOUT = 50.0

#: Corrections about things that nobody has requested.
CORRECTIONS = ("_lies(777,office1,now)", "_off(776,now)", "_aboard(775,now)", "_off(775,now)")

#: actionlib's state diagram of a goal on the server, in its words; the first state is pending.
FOLLOWS = {
    "pending": {"active", "recalling", "rejected", "recalled"},
    "recalling": {"preempting", "recalled", "rejected"},
    "active": {"preempting", "preempted", "succeeded", "aborted"},
    "preempting": {"preempted", "succeeded", "aborted"},
}


class CoreMachine(RuleBasedStateMachine):
    """The core between clients and interfaces that behave arbitrarily."""

    @initialize(preempt=st.booleans(), forgetful=st.booleans(), delay=st.sampled_from([None, 0, 1, 2, 5, NEVER]))
    def begin(self, preempt, forgetful, delay):
        """Begin with a standby worker whose answers come with a ``delay`` in cycles; None for no such worker."""
        self.patches = ExitStack()
        self.patches.enter_context(compacting(2, shown=1) if forgetful else nullcontext())
        self.halts, self.halted = [], False
        self.driver = Driver(
            settings=CoreSettings(horizon_limit=60, action_timeout=TIMEOUT, preempt=preempt),
            program=shipped("mailbot.lp", "office.lp"),
            watch=self.watch,
            **({} if delay is None else {"solver": Standby(delay, plan_time=None).solver, "watch_joining": unwatched}),
        )
        self.world = World()
        self.goals = {}  # key -> (from, to, package)
        self.executed = {}  # cycle -> actions, from the messages that were sent
        self.checked = 0
        self.seen = []
        self.failures = 0
        self.garbage = 0
        self.number = 0
        self.paused_at = None  # number of dispatches at the beginning of a pause

    # ---- clients and operators

    @rule(paused=st.booleans())
    def pause(self, paused):
        self.driver.core.pause(paused)
        self.paused_at = len(self.driver.journal.of(ActionsDispatched)) if paused else None
        self.driver.run()

    @rule()
    def stop(self):
        self.failures += 1
        self.driver.core.stop("is aborted: stopped")
        assert not self.driver.core.live_goals
        self.driver.run()

    @rule(start=st.sampled_from(OFFICES), end=st.sampled_from(OFFICES))
    @precondition(lambda self: sum(self.lives(key) for key in self.goals) < 5)
    def request(self, start, end):
        self.number += 1
        key, package = f"key{self.number}", str(self.number)
        self.goals[key] = (start, end, package)
        self.world.places[package] = start
        self.driver.goal(key, f"goal({start},{end},{package})")

    @rule(data=st.data())
    @precondition(lambda self: self.goals)
    def request_with_an_identity_that_is_taken(self, data):
        key = data.draw(st.sampled_from(sorted(self.goals)))
        if not self.lives(key):
            return
        self.number += 1
        self.driver.goal(f"twin{self.number}", f"goal(office1,office2,{self.goals[key][2]})")
        assert "in use" in self.driver.message(f"twin{self.number}")

    @rule(text=st.one_of(st.text(max_size=20), st.sampled_from(["goal(office1,office9,99)", "dance(98)", "cancel(1)"])))
    def request_that_makes_no_sense(self, text):
        self.number += 1
        key = f"odd{self.number}"
        self.driver.goal(key, text)
        self.goals[key] = None

    @rule(data=st.data())
    @precondition(lambda self: self.goals)
    def cancel(self, data):
        self.driver.cancel(data.draw(st.sampled_from(sorted(self.goals))))

    def watch(self):
        """Choose the end of the next search: at its usual end, by time, or by an arrival."""
        word = self.halts.pop(0) if self.halts else ""
        return lambda: Halt("the test", disturbed=word == "left") if word else None

    @rule(words=st.lists(st.sampled_from(["", "slow", "left"]), min_size=1, max_size=5))
    def halt_coming_searches(self, words):
        self.halts, self.halted = words, True

    @rule()
    def prepare(self):
        self.driver.core.prepare()
        self.driver.core.compact(lambda: False)

    @rule()
    def cancel_nobody(self):
        self.driver.cancel("nobody")

    # ---- interfaces

    @rule(times=st.integers(1, 8))
    @precondition(lambda self: self.driver.core.awaited)
    def succeed(self, times):
        for _ in range(times):
            for action in self.driver.core.awaited[:1]:
                self.world.do(action)
                self.answer(action, action.parameter)

    @rule(reason=st.sampled_from(REASONS))
    @precondition(lambda self: self.driver.core.awaited)
    def fail(self, reason):
        self.failures += 1
        self.answer(self.driver.core.awaited[0], reason)

    @rule()
    @precondition(lambda self: self.driver.core.awaited)
    def obey_a_preemption(self):
        wanted = {action for event in self.driver.journal.of(ActionsPreempted) for action in event.actions}
        for action in self.driver.core.awaited:
            if action in wanted:
                self.answer(action, "preempted")

    @rule()
    @precondition(lambda self: self.seen)
    def answer_twice_or_late(self):
        before = self.driver.core.cycle, self.driver.core.awaited
        self.driver.facts(self.seen[-1])
        if len(self.seen) > 1:
            self.driver.facts(self.seen[-2])
        assert (self.driver.core.cycle, self.driver.core.awaited) == before

    @rule()
    @precondition(lambda self: self.driver.core.awaited)
    def never_answer(self):
        self.failures += 1
        cycle = self.driver.core.cycle
        self.driver.now += TIMEOUT + 1.0
        self.driver.run()
        assert self.driver.core.cycle > cycle

    @rule(seconds=st.floats(-20.0, TIMEOUT / 10))
    def let_time_pass(self, seconds):
        self.driver.now = max(1.0, self.driver.now + seconds)
        self.driver.run()

    @rule(facts=st.lists(st.text(max_size=30), max_size=3))
    def tell_garbage(self, facts):
        self.driver.facts(*facts)

    @rule(fact=st.sampled_from(CORRECTIONS))
    def correct_the_world(self, fact):
        self.driver.facts(fact)

    @rule(cycle=st.integers(-3, 40), name=st.sampled_from(["move_base", "pickup", "deliver", "arm", "X", "f(1)"]))
    def answer_for_nothing(self, cycle, name):
        if cycle != self.driver.core.cycle:
            self.driver.facts(f"_return({name},office2,{cycle})", f"_action_lib({name},office2,{cycle})")
            self.driver.facts(f"_status({cycle},succeeded,{cycle})", f"_request(goal(office1,office2,97),{cycle})")

    def answer(self, action, value):
        self.seen.append(f"_return({action.interface},{value},{action.cycle})")
        self.driver.facts(self.seen[-1])

    # ---- invariants

    def account(self):
        """Return the accepted stream and the problems, for the message of a failure."""
        return "\n".join((self.driver.journal.stream, *self.driver.problems))

    def lives(self, key):
        return self.goals[key] is not None and not self.ended(key)

    def ended(self, key):
        return any(one.key == key and one.outcome is not None for one in self.driver.journal.of(GoalChanged))

    @invariant()
    def every_status_change_is_legal(self):
        for key in self.goals:
            states = ["pending", *self.driver.states(key)]
            for before, after in zip(states, states[1:]):
                assert after in FOLLOWS.get(before, ()), f"{key}: {states}"

    @invariant()
    def the_past_never_changes(self):
        events = self.driver.journal.events[self.checked :]
        for event in events:
            if isinstance(event, PlanMade) or (isinstance(event, GoalProgress) and not event.waits):
                past = [action for action in event.actions if action.cycle < event.cycle]
                done = [one for cycle in sorted(self.executed) for one in self.executed[cycle] if cycle < event.cycle]
                assert past == done[-DONE:], f"{event}\n{self.account()}"
            elif isinstance(event, ActionsDispatched):
                assert event.cycle not in self.executed, f"{event}\n{self.account()}"
                self.executed[event.cycle] = sorted(event.actions, key=lambda action: str(action.atom))
        self.checked += len(events)
        answered = {action for action in self.driver.core.plan.actions if action.cycle < self.driver.core.cycle}
        done = {action for actions in self.executed.values() for action in actions}
        assert answered <= done, f"{answered - done} in the answer was never done\n{self.account()}"

    @invariant()
    def paused_core_dispatches_nothing(self):
        if self.paused_at is not None:
            assert len(self.driver.journal.of(ActionsDispatched)) == self.paused_at

    @invariant()
    def idle_when_nothing_is_to_do(self):
        assert not self.driver.core.advance(self.driver.now)
        if not self.driver.core.live_goals:
            assert not self.driver.core.awaited or self.driver.core.plan.actions

    def teardown(self):
        if not hasattr(self, "driver"):
            return
        with self.patches:
            self.come_to_an_end()

    def come_to_an_end(self):
        """Send two last goals and let all actions under way succeed; then every goal has the right end."""
        self.halts = []
        self.pause(paused=False)
        self.request(OFFICES[0], OFFICES[3])
        self.request(OFFICES[3], OFFICES[0])
        for _ in range(300):
            if not self.driver.core.awaited:
                break
            for action in self.driver.core.awaited:
                self.world.do(action)
                self.answer(action, action.parameter)
        self.every_status_change_is_legal()
        self.the_past_never_changes()
        assert not self.driver.core.awaited
        assert not self.driver.core.live_goals
        assert not self.driver.core.advance(self.driver.now)
        if not self.halted:
            check_replay(self.driver.program, self.driver.journal)
        for key, goal in self.goals.items():
            assert self.ended(key), key
            if goal is not None:
                self.check_package(goal, self.driver.states(key)[-1])

    def check_package(self, goal, state):
        """Check that a package is at its destination, its origin, or where a failure left it."""
        start, end, package = goal
        place = self.world.places[package]
        if state == "succeeded":
            assert place == end
        elif state in ("preempted", "recalled"):
            assert place == start or self.failures
        else:
            assert state == "aborted"
            assert self.failures, "nothing failed"


TestCoreMachine = CoreMachine.TestCase
TestCoreMachine.settings = settings(max_examples=settings.default.max_examples // 5, stateful_step_count=40)
