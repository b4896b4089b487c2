"""A goal is cancelled in every phase of its life, with and without preempt: the mailbot in the office's model."""

import pytest
from core_driver import Driver
from office_world import World
from shipped import shipped

from rosoclingo.reasoning import ActionsPreempted, CoreSettings

PREEMPT = pytest.mark.parametrize("preempt", [False, True])


class Office(Driver):
    """A driver whose actions change a world."""

    def __init__(self, preempt=False):
        self.world = World()
        super().__init__(settings=CoreSettings(preempt=preempt), program=shipped("mailbot.lp", "office.lp"))

    def ask(self, start, end, package):
        """A goal, whose key is the package's number, and its package."""
        self.world.places[str(package)] = f"office{start}"
        return self.goal(str(package), f"goal(office{start},office{end},{package})")

    def succeed(self):
        for action in self.core.awaited:
            self.world.do(action)
        return super().succeed()

    def until(self, action):
        """All succeeds until an action of this interface and parameter is under way."""
        for _ in range(50):
            if any(one.startswith(f"_action_lib({action},") for one in self.awaited):
                return self
            self.succeed()
        raise AssertionError(f"{action} is never under way")

    @property
    def preempted(self):
        return [str(one.cancellation) for event in self.journal.of(ActionsPreempted) for one in event.actions]


@PREEMPT
def test_before_it_was_fed(preempt):
    office = Office(preempt).ask(3, 2, 1).ask(4, 1, 2).cancel("2")
    assert office.states("2") == ["recalling", "recalled"]
    assert office.finish().world.places == {"1": "office2", "2": "office4"}
    assert office.states("1")[-1] == "succeeded"
    assert not any("office4" in text for text in office.journal.updates)
    assert office.preempted == []


@pytest.mark.mostly_slow
@PREEMPT
def test_fed_but_not_started(preempt):
    office = Office(preempt).ask(3, 2, 1).ask(4, 1, 2).succeed().cancel("2").finish()
    assert office.states("2")[-1] in ("recalled", "preempted")
    assert office.states("1")[-1] == "succeeded"
    assert office.world.places == {"1": "office2", "2": "office4"}


@PREEMPT
def test_driving_to_the_pickup(preempt):
    office = Office(preempt).ask(3, 2, 1).until("move_base,office3").cancel("1")
    assert office.preempted == (["_cancel(move_base,office3,2)"] if preempt else [])
    assert office.awaited == ["_action_lib(move_base,office3,2)"]
    office.fail("preempted") if preempt else office.succeed()
    assert office.states("1")[-1] == "preempted"
    assert office.awaited == []
    assert office.world.robot == ("office2" if preempt else "office3")
    assert office.world.places == {"1": "office3"}


@pytest.mark.slow
@PREEMPT
@pytest.mark.parametrize("answer", ["success", "preempted", "failed"])
def test_during_the_pickup(preempt, answer):
    office = Office(preempt).ask(3, 2, 1).until("pickup,1").cancel("1")
    assert office.preempted == (["_cancel(pickup,1,3)"] if preempt else [])
    office = office.succeed() if answer == "success" else office.fail(answer)
    office.finish()
    assert office.states("1")[-1] == "preempted"
    assert office.world.places == {"1": "office3"}, "it is put back where it was"
    assert office.world.robot == "office3"


@PREEMPT
def test_between_pickup_and_delivery(preempt):
    office = Office(preempt).ask(3, 1, 1).until("pickup,1").succeed().cancel("1")
    assert office.preempted == (["_cancel(move_base,office2,4)"] if preempt else [])
    office = office.fail("preempted") if preempt else office.succeed()
    assert office.states("1")[-1] == "preempting", "its package has to be brought back"
    assert office.finish().states("1")[-1] == "preempted"
    assert office.world.places == {"1": "office3"}


@PREEMPT
def test_during_the_delivery(preempt):
    office = Office(preempt).ask(3, 2, 1).until("deliver,1").cancel("1").succeed().finish()
    assert office.states("1")[-1] in ("preempted", "succeeded")
    assert office.world.places == {"1": "office2"}, "it was delivered before it could be helped"


@PREEMPT
def test_during_a_delivery_that_fails(preempt):
    office = Office(preempt).ask(3, 2, 1).until("deliver,1").cancel("1").fail("failed").finish()
    assert office.states("1")[-1] == "preempted"
    assert office.world.places == {"1": "office3"}


@pytest.mark.slow
@PREEMPT
@pytest.mark.parametrize("action", ["move_base,office2", "pickup,1", "deliver,1"])
def test_together_with_a_failure(preempt, action):
    """Both come before the core thinks again."""
    office = Office(preempt).ask(3, 2, 1).until(action)
    running = office.core.awaited[0]
    office.core.cancel_goal("1")
    office.core.receive("interface", [f"_return({running.interface},failed,{running.cycle})"])
    office.run().finish()
    assert office.preempted == []
    assert office.states("1")[-1] == "preempted"
    assert office.world.places == {"1": "office3"}


@PREEMPT
def test_twice_and_unknown_and_after_the_end(preempt):
    office = Office(preempt).ask(3, 2, 1).cancel("1").cancel("1").cancel("nobody")
    assert len(office.preempted) == preempt
    office = office.fail("preempted") if preempt else office.succeed()
    before = office.states("1")
    assert office.cancel("1").states("1") == before
    assert sum(text.count("_request(cancel(") for text in office.journal.updates) == 1
    assert office.states("1")[-1] == "preempted"


@PREEMPT
def test_one_of_several(preempt):
    office = Office(preempt).ask(3, 2, 1).ask(3, 4, 2).succeed().cancel("1").finish()
    assert office.states("1")[-1] == "preempted"
    assert office.states("2")[-1] == "succeeded"
    assert office.world.places == {"1": "office3", "2": "office4"}


@PREEMPT
def test_an_action_that_serves_another_goal_as_well_goes_on(preempt):
    office = Office(preempt).ask(3, 2, 1).ask(3, 2, 2).succeed()
    assert office.awaited == ["_action_lib(move_base,office3,2)"]
    office.cancel("1")
    assert office.preempted == []
    assert office.finish().states("2")[-1] == "succeeded"


@pytest.mark.slow
@pytest.mark.once
def test_what_the_core_ended_itself_is_counted_for_nobody():
    office = Office(preempt=True)
    for package in range(1, 6):
        office.ask(3, 2, package).cancel(str(package)).fail("preempted")
        assert office.states(str(package))[-1] == "preempted"
    assert len(office.preempted) == 5
    assert office.ask(3, 2, 6).finish().states("6")[-1] == "succeeded"
    assert office.problems == []
