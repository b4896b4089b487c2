"""The mailbot's day as its scenario has it, by the pure core: it ends, whatever plans the core has time to find."""

from functools import partial

import pytest
from core_driver import Driver, shortest, soon
from golog_programs import ENCODINGS
from workloads import sized

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.reasoning.settings import CoreSettings
from rosoclingo.runs.scenario import Scenario

FILES = ("mailbot.lp", "office.lp", "golog/mailbot_day.golog")
SCENARIO = Scenario.from_file(ENCODINGS.parent / "config" / "scenarios" / "mailbot_day.yaml")


class Day:
    """The scenario as it goes; moves through the door that is closed fail for a reason."""

    def __init__(self, solver, reason):
        program = ReactiveProgram.from_files([ENCODINGS / name for name in FILES])
        self.driver = Driver(settings=CoreSettings(), program=program, solver=solver)
        self.reason, self.keys, self.done = reason, {}, []
        self.events = list(SCENARIO.events)
        self.place, self.packages = "office1", dict(SCENARIO.packages)

    def play(self):
        """Play it, to its end."""
        while len(self.done) < 60:
            self.happen()
            if not self.driver.core.awaited:
                return self
            self.act()
        raise AssertionError(f"the day has no end: {self.done}")

    def happen(self):
        """What comes in this cycle, or before."""
        while self.events and (self.events[0].cycle or 0) <= self.driver.core.cycle:
            event = self.events.pop(0)
            if event.verb == "request":
                key = event.value.rstrip(")").split(",")[-1]
                self.keys[key] = event.value
                self.driver.goal(key, event.value)
            elif event.verb == "cancel":
                self.driver.cancel(str(event.value))
            elif event.verb == "facts":
                self.driver.facts(*event.value)
            elif event.fields["open"]:
                self.reason = None

    def act(self):
        """What is under way is done, or fails."""
        (action,) = self.driver.core.awaited
        name, about = action.interface_name, str(action.parameter)
        self.done.append(f"{name} {about}")
        if self.reason and (self.place, about) == ("office2", "office3"):
            self.driver.fail(self.reason)
            return
        if name == "move_base":
            self.place = about
        else:
            self.packages[about] = self.place if name == "deliver" else "robot"
        self.driver.succeed()


#: Solvers that have all the time, and none.
SOLVERS = {"shortest": shortest, "hasty": partial(soon, plan_time=0.0)}


@pytest.mark.slow
@pytest.mark.once
@pytest.mark.parametrize(("solver", "reason"), [("hasty", "timeout"), *sized([], [("shortest", "blocked")])])
def test_the_day_of_the_scenario_ends_as_it_says(solver, reason):
    day = Day(SOLVERS[solver], reason).play()
    assert not day.events
    expected = SCENARIO.expect
    assert [day.driver.states(key)[-1].replace("preempted", "canceled") for key in day.keys] == expected["goals"]
    assert day.packages == expected["packages"]
    assert day.place == expected["robot"]
    assert len(day.done) < 30
