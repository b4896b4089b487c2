"""Reads a scenario, plays it with an account of the run, and compares the end with what it expects."""

from contextlib import suppress
from pathlib import Path
from typing import Any, Callable, List, Mapping, NamedTuple, Optional

import rospkg

from rosoclingo.nodes.account_node import AccountNode, TopicAccount
from rosoclingo.nodes.scenarios.player import PlayError, ScenarioPlayer
from rosoclingo.runs.account import Summary
from rosoclingo.runs.scenario import Scenario, ScenarioError

#: Seconds of wall time for which other topics may tell of the end later than the goals' status does.
LATE_NEWS = 5.0


class ScenarioOutcome(NamedTuple):
    """How a scenario ended: ``faults`` is empty when it was played to its end and ended as expected."""

    summary: Summary
    faults: List[str]


def scenarios() -> Path:
    """The folder of the scenarios that this package ships."""
    return Path(rospkg.RosPack().get_path("rosoclingo")) / "config" / "scenarios"


def find_scenario(name: str) -> Scenario:
    """The scenario of a file, or the shipped one of that name; raises ScenarioError, which names those there are."""
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
    """Play a scenario and tell the account line by line.

    ``wait_for`` names the action servers that have to be there within ``timeout`` seconds of wall time. ``check`` is
    called now and then and can raise to end the scenario; the first event waits until ``recording`` holds.
    """
    player = ScenarioPlayer(scenario, wait_for, say, check)
    faults: List[str] = []
    account: Optional[AccountNode] = None
    try:
        player.prepare(timeout)
        account = AccountNode(say)
        player.wait_until(lambda: account.connected, timeout, lambda: "no connection to the core's topics")
        player.wait_until(recording, timeout, lambda: "the recorder is not connected")
        player.play()
        # the account hears of an end by the status topic, which may come later than the result
        player.wait_until(lambda: account.ended(player.sent), timeout, lambda: "no status of every goal")
        wait_for_news(player, account, scenario.expect)
    except PlayError as error:
        faults.append(str(error))
    summary = account.finish() if account is not None else Summary()
    return ScenarioOutcome(summary, faults + summary.differences(scenario.expect, player.before or 0, player.sent))


def wait_for_news(player: ScenarioPlayer, account: TopicAccount, expect: Mapping[str, Any]) -> None:
    """Wait, at most LATE_NEWS seconds, until the account has what is expected: each topic comes at its own time."""
    with suppress(PlayError):  # then the run did not end as expected
        player.wait_until(
            lambda: not account.differences(expect, player.before or 0, player.sent),
            LATE_NEWS,
            lambda: "not as expected",
        )
