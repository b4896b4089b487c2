"""What was done and what came of it: in whatever way an update is fed, the program hears of both together."""

import os
import signal
from random import Random

import pytest
from core_driver import Driver, shortest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from rosoclingo.oclingo import DroppedError, ReactiveProgram, SolverError, parse_updates
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.planning.workers.pool import WorkerPool
from rosoclingo.planning.workers.process_solver import ProcessSolver
from rosoclingo.reasoning import CoreSettings, GoalState

#: Goals fetch(Thing,Id): an arm grasps, which can fail. What is seen or loud is heeded by no plan.
FETCH = """
#external _request/2. #external _return/3. #external _seen/1. #external _loud/2.
#program cumulative(t).
wanted(X,I,t) :- _request(fetch(X,I),t+1).
wanted(X,I,t) :- wanted(X,I,t-1), not have(X,t-1), not _request(cancel(I),t).
{ _action_lib(arm,X,t) : wanted(X,I,t) } 1.
failed(t) :- _return(A,V,t), not _action_lib(A,V,t).
have(X,t) :- have(X,t-1).
have(X,t) :- _action_lib(arm,X,t), not failed(t).
_status(I,accepted,t) :- wanted(X,I,t).
_status(I,succeeded,t) :- wanted(X,I,t-1), have(X,t-1).
_status(I,canceled,t) :- _request(cancel(I),t).
noise(t) :- _seen(X), _loud(X,t).
#program volatile(t).
:- wanted(X,I,t), not have(X,t).
#program base.
#show _action_lib/3. #show _status/3.
"""
PROGRAM = ReactiveProgram.from_text(FETCH)


class Fates:
    """What becomes of each update that a solver is fed: it is taken, dropped, dropped for its facts, or refused."""

    def __init__(self, fates=()):
        self.fates = iter(fates)
        self.costly = ""

    def solver(self, program):
        return shortest(program, lambda *arguments, **more: Fated(self, *arguments, **more))

    def of(self, update):
        """Raise the error of the next fate."""
        text = str(update)
        fate = next(self.fates, "taken")
        if fate == "dropped" or (self.costly and self.costly in text):
            raise DroppedError("killed by the test")
        if fate == "without facts" and "_seen" in text:
            raise DroppedError("too costly for the test")
        if fate == "refused" and "_seen" in text:
            raise SolverError("refused by the test")


class Fated(PlanSolver):
    def __init__(self, fates, *arguments, **more):
        super().__init__(*arguments, **more)
        self.fates = fates

    def update(self, update, stopped=None):
        self.fates.of(update)
        return super().update(update, stopped)


class Arm:
    """The world apart from the program: it has what was grasped with success."""

    def __init__(self, driver):
        self.driver, self.things, self.told = driver, set(), []

    def answer(self, fails, *facts):
        """The action under way ends; ``facts`` come in the same message."""
        (action,) = self.driver.core.awaited
        thing = str(action.parameter)
        self.things |= set() if fails else {thing}
        self.told.append(f"_return(arm,{'failed' if fails else thing},{action.cycle})")
        self.driver.core.receive("arm", [*facts[:1], self.told[-1], *facts[1:]])

    def check(self):
        """All that was done is told together with what came of it, and no goal is met without its thing."""
        driver = self.driver
        updates = list(parse_updates(driver.journal.stream))
        heads = {str(head) for update in updates for head in update.heads}
        assert heads.issuperset(self.told), driver.problems
        for update in updates:
            for action in update.committed:
                cycle = action.arguments[2]
                assert [one for one in update.heads if one is not None and one.match("_return", 3)], str(update)
                assert all(one.arguments[2] == cycle for one in update.heads if one and one.match("_return", 3))


def go_on(driver):
    """Advance until the core waits, time passes while it does not."""
    for _ in range(40):
        driver.run()
        if driver.core.awaited or not driver.core.live_goals:
            return
        driver.now += 11.0
    raise AssertionError("the core waits for ever")


STEPS = st.lists(st.tuples(st.booleans(), st.integers(0, 3)), max_size=6)
FATES = st.lists(st.sampled_from(["taken", "dropped", "without facts", "refused"]), max_size=25)


@settings(max_examples=settings.default.max_examples // 2)
@example(fates=["taken", "taken", *["dropped"] * 2, "taken"], steps=[(True, 1)])
@example(fates=["taken", "taken", *["dropped"] * 9], steps=[(True, 1)])
@example(fates=["taken", "taken", *["refused"] * 9], steps=[(True, 3)])
@given(fates=FATES, steps=STEPS)
def test_each_return_is_in_the_history_whatever_becomes_of_updates(fates, steps):
    driver = Driver(program=PROGRAM, solver=Fates(fates).solver)
    arm, facts = Arm(driver), []
    for number, thing in enumerate(("cup", "mug", "jug")):
        driver.core.add_goal(thing, f"fetch({thing},{number})")
    go_on(driver)
    for fails, count in steps:
        if driver.core.awaited:
            new = [f"_seen({len(facts) + one})" for one in range(count)]
            facts += new
            arm.answer(fails, *new)
            go_on(driver)
    while driver.core.awaited:
        arm.answer(False)
        go_on(driver)
    arm.check()
    assert arm.things == {"cup", "mug", "jug"}
    assert [driver.states(thing)[-1] for thing in ("cup", "mug", "jug")] == ["succeeded"] * 3
    for _ in range(20):
        driver.now += 1000.0
        driver.run()
    dropped = [text.split()[0] for text in driver.problems if "accepts no update with it" in text]
    heads = {str(head) for update in parse_updates(driver.journal.stream) for head in update.heads}
    assert heads.issuperset(set(facts) - set(dropped)), "other facts come later, or are told as dropped"


def test_a_failure_is_told_though_a_fact_of_its_message_is_too_costly():
    fates = Fates()
    driver = Driver(program=PROGRAM, solver=fates.solver).goal("a", "fetch(cup,1)")
    fates.costly = "_loud(400"
    driver.facts("_seen(dog)", "_loud(400,now)", "_seen(cat)", "_return(arm,failed,1)")
    go_on(driver)
    assert driver.awaited, "what failed is done again"
    heads = {str(head) for update in parse_updates(driver.journal.stream) for head in update.heads}
    assert "_return(arm,failed,1)" in heads
    driver.finish()
    for _ in range(10):
        driver.now += 1000.0
        driver.run()
    heads = {str(head) for update in parse_updates(driver.journal.stream) for head in update.heads}
    assert heads.issuperset({"_seen(dog)", "_seen(cat)"}), "those that cost little come later"
    assert driver.problems[-1] == "_loud(400,now) is dropped: the solver accepts no update with it"
    assert driver.goal("b", "fetch(mug,2)").finish().states("b")[-1] == "succeeded"


def test_a_return_that_the_solver_refuses_is_left_out_with_its_action():
    fates = Fates()
    driver = Driver(program=PROGRAM, solver=fates.solver).goal("a", "fetch(cup,1)")

    def of(update):
        if "_return(arm,odd,1)" in str(update):
            raise SolverError("refused by the test")

    fates.of = of
    driver.facts("_return(arm,odd,1)")
    assert driver.states("a")[-1] == "aborted"
    assert driver.goal("b", "fetch(mug,2)").finish().states("b")[-1] == "succeeded"
    assert "_action_lib(arm,cup,1)" not in driver.journal.stream


class Killer:
    """Kills the worker now and then, before it has answered an update; now and then the one after it as well."""

    def __init__(self, process, draw):
        self.process, self.draw = process, draw
        self.left = self.kills = 0

    def __call__(self):
        self.left -= 1
        again = False
        if self.left in (0, -2, -3) and self.draw.random() < 0.8:
            self.kill()
            again = self.draw.random() < 0.5
        killed = self.process.pid

        def look():
            nonlocal killed
            if again and self.process.pid != killed:
                killed = self.process.pid
                self.kill()

        return look

    def kill(self):
        if self.process.pid is not None:
            os.kill(self.process.pid, signal.SIGKILL)
            self.kills += 1


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_no_failure_is_lost_with_a_process_that_is_killed(seed):
    draw = Random(seed)
    process = WorkerPool(PROGRAM, shortest=True, standby=True)
    process.start()

    watch = Killer(process, draw)
    try:
        driver = Driver(
            program=PROGRAM, settings=CoreSettings(), solver=lambda _: ProcessSolver(process), watch=watch, start=False
        )
        driver.begin()
        arm = Arm(driver)
        for number in range(12):
            driver.core.add_goal(str(number), f"fetch(thing{number},{number})")
            go_on(driver)
            for fails in (True, False):
                watch.left = draw.choice([1, 1, 2])
                arm.answer(fails, f"_seen({number})")
                go_on(driver)
            while driver.core.awaited:
                arm.answer(False)
                go_on(driver)
        arm.check()
        assert all(driver.states(str(number))[-1] == GoalState.SUCCEEDED.value for number in range(12))
        assert arm.things == {f"thing{number}" for number in range(12)}
        assert watch.kills > 5
        assert any("dropped" in text for text in driver.problems)
    finally:
        process.close()
