"""Reads a scenario, plays it with an account of the run, and compares the end with its expectations."""

from pathlib import Path
from typing import Callable, List, NamedTuple

import rospkg

from rosoclingo.nodes.scenarios.player import PlayError, ScenarioPlayer
from rosoclingo.runs.account import Account
from rosoclingo.runs.scenario import Scenario, ScenarioError


class ScenarioOutcome(NamedTuple):
    """The end of a scenario: ``faults`` is empty if it was played to its end and ended as expected."""

    account: Account
    faults: List[str]


def scenarios() -> Path:
    """Return the folder of the scenarios in this package."""
    return Path(rospkg.RosPack().get_path("rosoclingo")) / "config" / "scenarios"


def find_scenario(name: str) -> Scenario:
    """Return the scenario in a file, or the shipped scenario ``name``; raises ScenarioError, which lists those."""
    shipped = scenarios() / (name + ".yaml")
    path = shipped if shipped.is_file() else Path(name)
    if not path.exists():
        names = ", ".join(sorted(path.stem for path in scenarios().glob("*.yaml")))
        raise ScenarioError(f"no such scenario: {name}; give a YAML file, or one of {names}")
    return Scenario.from_file(path)


def run_scenario(
    scenario: Scenario,
    wait_for: List[str],
    say: Callable[[str], None],
    timeout: float,
    check: Callable[[], None] = lambda: None,
    recording: Callable[[], bool] = lambda: True,
) -> ScenarioOutcome:
    """Play a scenario and print the account line by line.

    ``wait_for`` names the action servers that have to be up within ``timeout`` seconds of wall time. ``check`` is
    called regularly and can raise an exception to end the scenario; the first event waits until ``recording`` holds.
    """
    player = ScenarioPlayer(scenario, wait_for, say, check)
    faults: List[str] = []
    try:
        player.prepare(timeout)
        player.wait_until(recording, timeout, lambda: "the recorder is not connected")
        player.play()
    except PlayError as error:
        faults.append(str(error))
    player.finish()
    return ScenarioOutcome(player.account, faults + player.differences())
