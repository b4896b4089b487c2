"""The mailbot's day as in its scenario, run by the pure core: it ends with any plans that the core finds."""

import pytest
from core_driver import Driver, first, shortest
from shipped import ENCODINGS
from workloads import sized

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.reasoning.settings import CoreSettings
from rosoclingo.runs.scenario import Scenario

FILES = ("mailbot.lp", "office.lp", "golog/mailbot_day.golog")
SCENARIO = Scenario.from_file(ENCODINGS.parent / "config" / "scenarios" / "mailbot_day.yaml")


class Day:
    """The scenario as it runs; moves through the closed door fail for a reason."""

    def __init__(self, solver, reason):
        program = ReactiveProgram.from_files([ENCODINGS / name for name in FILES])
        self.driver = Driver(settings=CoreSettings(), program=program, solver=solver)
        self.reason, self.keys, self.done = reason, {}, []
        self.events = list(SCENARIO.events)
        self.place, self.packages = "office1", dict(SCENARIO.packages)

    def play(self):
        """Play the scenario to its end."""
        while len(self.done) < 60:
            self.happen()
            if not self.driver.core.awaited:
                return self
            self.act()
        raise AssertionError(f"the day has no end: {self.done}")

    def happen(self):
        """Apply the events of this cycle and earlier ones."""
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
        """End the actions under way with success or failure."""
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


@pytest.mark.slow
@pytest.mark.parametrize(("solver", "reason"), [(first, "timeout"), *sized([], [(shortest, "blocked")])])
def test_mailbot_day_ends_as_its_scenario_says(solver, reason):
    day = Day(solver, reason).play()
    assert not day.events
    expected = SCENARIO.expect
    assert [day.driver.states(key)[-1].replace("preempted", "canceled") for key in day.keys] == expected["goals"]
    assert day.packages == expected["packages"]
    assert day.place == expected["robot"]
    assert len(day.done) < 30
