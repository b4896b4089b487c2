"""Interrupted searches and updates that the solver drops or refuses lose no goal, action or return."""

import pytest
from core_driver import ERRANDS, Driver, FaultyDriver
from core_programs import DOOMED, FAILED, IMPOSSIBLE, STATUS, fetch
from core_scripts import play, scripts
from hypothesis import example, given, settings
from hypothesis import strategies as st
from stream_replay import check_replay

from rosoclingo.oclingo import DroppedError, ReactiveProgram, SolverError, parse_updates
from rosoclingo.reasoning.events import PlanMade
from rosoclingo.reasoning.input_feeder import PAUSE
from rosoclingo.reasoning.settings import CoreSettings

GOES_ON = "no plan was found before the search was ended: the search goes on"

#: The program and the script.
FAULTS = {
    "cancel during a search": (ERRANDS, """
        add a do(walk,1); leave 1; once; cancel a; is a preempted; sends _request(cancel(1),2).; goal b do(run,2)
        finish; is b succeeded"""),
    "solver that drops everything": (ERRANDS, f"""
        goal a do(walk,1); fault dropped; succeed; patience 2; fault none; wait {PAUSE - 1}; all a; wait 1
        is a succeeded; does; goal b do(run,2); finish; is b succeeded"""),
    "solver that drops one goal": (ERRANDS, f"""
        fault dropped do(walk,4); add a do(walk,1); add b do(walk,2); add c do(walk,3); goal d do(walk,4); does
        waits a the solver did not accept it in time; wait {PAUSE}; queued c d; finish; is b succeeded
        wait {PAUSE}; finish; is c succeeded; fault none; wait {PAUSE}; finish; is d succeeded"""),
    "repair that is left": (DOOMED, """
        goal a do(walk,1); succeed; hear interface _seen(end); leave 2; once; sends _seen(end).; add b do(run,2)
        run; finish; is b succeeded; sent #withdraw _seen(end)...."""),
    "update of which nothing was accepted": (ERRANDS, "fault refused; goal a do(walk,1); all a rejected; unsent ..."),
    "searches without an end": (ERRANDS, f"""
        goal a do(walk,1); finish; fault undecided unless #anew; add b do(run,2); {"once;" * 10} problems 10
        problem {GOES_ON}; fault none; run; finish; is b succeeded; goal c do(walk,3); finish; is c succeeded"""),
    "program that cannot begin again": (IMPOSSIBLE, """
        fault refused #anew; goal a do(walk,1); add c do(rest,9); succeed; add b do(run,2)
        facts _battery(high,9) _return(rest,failed,2); is b aborted; is c aborted; does
        says b do(run,2) cannot be met: there is no plan of at most 10 steps
        problem no answer was found, even without goals: there is no plan of at most 10 steps"""),
}  # fmt: skip


@scripts(FAULTS)
def test_core_handles_faults_of_the_solver(row):
    text, script = row
    driver = play(FaultyDriver(text), script)
    assert driver.core.live_goals == []
    check_replay(driver.program, driver.journal)


def test_core_continues_after_its_first_search_was_dropped():
    play(
        FaultyDriver(start=False),
        """
        fault dropped; begin; problems 1; problem the program can't be solved before any request: no; fault none
        goal a do(walk,1); finish; is a succeeded""",
    )


def test_core_ends_all_goals_if_solver_accepts_nothing():
    why = "is aborted: the solver accepts no more updates"
    driver = FaultyDriver(settings=CoreSettings(horizon_limit=8, goals_at_once=1))
    play(
        driver,
        f"""
        goal a do(walk,1); add b do(walk,2); fault refused; succeed; says a do(walk,1) {why}; says b do(walk,2) {why}
        fault none; goal c do(run,3); sends ..._request(cancel(1),2)...""",
    )


def test_core_restarted_program_has_only_new_goals():
    driver = play(
        Driver(IMPOSSIBLE),
        """
        goal a do(walk,1); add c do(rest,9); succeed; add b do(run,2); facts _battery(high,9) _return(rest,failed,2)
        says c do(rest,9) is aborted: the program forgets its history; all b; problem ERROR: ...; does run,2,4""",
    )
    updates = [" ".join(text.split()[1:-2]) for text in driver.journal.updates[2:]]
    assert updates == ["3. #anew.", "4. _request(do(run,2),5)."]
    assert sum(text.startswith("ERROR: ") for text in driver.problems) == 1
    plans = driver.journal.of(PlanMade)
    assert [event.cycle for event in plans] == [1, 1, 2, 3, 3, 4]
    assert [str(action.atom) for action in plans[-1].actions[:2]] == driver.journal.actions[:2], "the past stays"
    play(driver, "facts _battery(high,9) _return(run,2,4); sends ..._battery(high,9)...; is b succeeded")


# -- actions and their returns, in every way that an update reaches the solver


#: No plan depends on ``seen`` or ``loud``.
PROGRAM = ReactiveProgram.from_text(fetch(", not failed(t)", rules=FAILED + STATUS))


class Arm:
    """The world, independent of the program: the things that were grasped with success."""

    def __init__(self, driver):
        self.driver, self.things, self.returns = driver, set(), []

    def answer(self, fails, *facts):
        """End the action under way; ``facts`` come in the same message."""
        (action,) = self.driver.core.awaited
        thing = str(action.parameter)
        self.things |= set() if fails else {thing}
        self.returns.append(f"_return(arm,{'failed' if fails else thing},{action.cycle})")
        self.driver.core.receive("arm", [*facts[:1], self.returns[-1], *facts[1:]])
        self.go_on()

    def go_on(self):
        """Advance until the core waits for an action, and let time pass until then."""
        for _ in range(40):
            self.driver.run()
            if self.driver.core.awaited or not self.driver.core.live_goals:
                return
            self.driver.now += 11.0
        raise AssertionError("the core waits for ever")

    def finish(self):
        """Let all actions succeed and deliver the remaining facts."""
        while self.driver.core.awaited:
            self.answer(False)
        for _ in range(20):
            self.driver.now += 1000.0
            self.driver.run()

    @property
    def heads(self):
        """Return the facts of the stream."""
        return {str(head) for update in parse_updates(self.driver.journal.stream) for head in update.heads}

    def check(self):
        """Check that the stream reports each action together with its return."""
        assert self.heads.issuperset(self.returns), self.driver.problems
        for update in parse_updates(self.driver.journal.stream):
            returns = [one for one in update.heads if one is not None and one.match("_return", 3)]
            for action in update.committed:
                assert returns, str(update)
                assert all(one.arguments[2] == action.arguments[2] for one in returns)


STEPS = st.lists(st.tuples(st.booleans(), st.integers(0, 3)), max_size=6)
FATES = st.lists(st.sampled_from(["accepted", "dropped", "without facts", "refused"]), max_size=25)


@pytest.mark.slow
@settings(max_examples=settings.default.max_examples // 2)
@example(fates=["accepted", "accepted", *["dropped"] * 2, "accepted"], steps=[(True, 1)])
@example(fates=["accepted", "accepted", *["dropped"] * 9], steps=[(True, 1)])
@example(fates=["accepted", "accepted", *["refused"] * 9], steps=[(True, 3)])
@given(fates=FATES, steps=STEPS)
def test_core_history_has_each_return_for_every_accepted_update(fates, steps):
    left = iter(fates)

    class FatedDriver(FaultyDriver):
        def fault(self, update):
            fate, sees = next(left, "accepted"), "_seen" in str(update)
            if fate == "dropped" or (fate == "without facts" and sees):
                return DroppedError("by the test")
            return SolverError("by the test") if fate == "refused" and sees else None

    driver = FatedDriver(program=PROGRAM)
    arm, facts = Arm(driver), []
    for number, thing in enumerate(("cup", "mug", "jug")):
        driver.core.add_goal(thing, f"fetch({thing},{number})")
    arm.go_on()
    for fails, count in steps:
        if driver.core.awaited:
            new = [f"_seen({len(facts) + one})" for one in range(count)]
            facts += new
            arm.answer(fails, *new)
    arm.finish()
    arm.check()
    assert arm.things == {"cup", "mug", "jug"}
    assert [driver.states(thing)[-1] for thing in ("cup", "mug", "jug")] == ["succeeded"] * 3
    dropped = [text.split()[0] for text in driver.problems if "accepts no update with it" in text]
    assert arm.heads.issuperset(set(facts) - set(dropped)), "other facts come later, or are reported as dropped"


@pytest.mark.slow
@settings(max_examples=settings.default.max_examples // 4)
@example(faulty={0, 1, 2, 3, 4, 5, 6, 7}, error=DroppedError)
@given(faulty=st.sets(st.integers(0, 7)), error=st.sampled_from([DroppedError, SolverError]))
def test_core_drops_only_faulty_facts(faulty, error):
    names = [f"_seen({number})" for number in range(8)]
    wrong = [names[number] for number in sorted(faulty)]

    class StrictDriver(FaultyDriver):
        def fault(self, update):
            return error("by the test") if any(one in str(update) for one in wrong) else None

    driver = StrictDriver(program=PROGRAM)
    play(driver, "goal a fetch(cup,1)")
    arm = Arm(driver)
    arm.answer(True, *names)
    arm.finish()
    arm.check()
    assert arm.heads.issuperset({*names} - {*wrong})
    lost = [text.split()[0] for text in driver.problems if "accepts no update with it" in text]
    assert sorted(lost) == wrong
    assert len(driver.failed) <= (10 * len(wrong) + 16 if error is DroppedError else 2 * len(names))
    play(driver, "goal b fetch(mug,2); finish; is a succeeded; is b succeeded")
