#!/usr/bin/env python3
"""Plays shipped scenarios in the whole system: core, interfaces, office, recorder, and simulator and navigation.

Simulated time runs fast once all nodes are up: before, its steps would only delay their start.
"""

import argparse
import json
import os
import re
import shutil
import sys
import tempfile
import time
import unittest
from pathlib import Path

import rosbag
import rosnode
import rospy
import rostest
from rosoclingo.srv import SetSpeed

from rosoclingo.nodes.pages.report_command import write_report
from rosoclingo.nodes.recording.bag_file import unfinished_path
from rosoclingo.nodes.recording.recorder import RECORDED, is_recording
from rosoclingo.nodes.scenarios.playing import find_scenario, run_scenario
from rosoclingo.oclingo import parse_atom, parse_update
from rosoclingo.oclingo.progression.updates import Statement
from rosoclingo.reasoning.keywords import CORE
from rosoclingo.runs.events import SAID

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "unit"))

import browser

OPTIONS = argparse.Namespace()
PATIENCE = 300.0  # seconds of wall time
SPEED = 10.0  # simulated seconds per second
GOAL_STATES = {2: "canceled", 3: "succeeded", 4: "aborted", 5: "rejected", 8: "canceled"}


def wait_for(condition, pause=0.05):
    """Wait until ``condition`` holds, at most PATIENCE seconds of wall time; return whether it does."""
    end = time.monotonic() + PATIENCE
    while not condition() and time.monotonic() < end:
        time.sleep(pause)
    return condition()


class Bag:
    """The contents of a bag: updates, actions and returns as atoms, and the end of each goal."""

    TOPICS = ("/rosoclingo/updates", "/out_rosoclingo", "/in_rosoclingo", "/rosoclingo/result")

    def __init__(self, path):
        self.updates, self.actions, self.returns, self.ends = [], [], [], {}
        with rosbag.Bag(str(path)) as bag:
            for topic, message, _ in bag.read_messages(self.TOPICS):
                self.take(topic.strip("/"), message)

    def take(self, topic, message):
        if topic == "rosoclingo/updates":
            self.updates.append(parse_update(message.data))
        elif topic == "out_rosoclingo":
            self.actions += [parse_atom(fact) for fact in message.facts if message.interface != CORE]
        elif topic == "in_rosoclingo":
            facts = [parse_atom(fact) for fact in message.facts]
            self.returns += [fact for fact in facts if fact.name == "_return"]
        elif topic == "rosoclingo/result":
            self.ends[message.status.goal_id.id] = GOAL_STATES[message.status.status]


class Growing:
    """A bag during recording, which is read again when it has grown."""

    def __init__(self, path):
        self.path, self.size, self.results = path, 0, 0

    def count_results(self):
        """Return the number of results of goals in it."""
        size = os.path.getsize(unfinished_path(self.path))
        if size != self.size:
            with tempfile.TemporaryDirectory() as folder:
                copy = shutil.copy(unfinished_path(self.path), folder)
                with rosbag.Bag(copy, "a", allow_unindexed=True) as bag:
                    for _ in bag.reindex():
                        pass
                    self.size, self.results = size, bag.get_message_count("/rosoclingo/result")
        return self.results


def recording_and_flying():
    """Return whether the recorder, the last of all nodes, is connected; from then on time runs fast."""
    if not is_recording(RECORDED):
        return False
    rospy.wait_for_service("simulator/set_speed", PATIENCE)
    return rospy.ServiceProxy("simulator/set_speed", SetSpeed)(SPEED).success


class ScenarioTest(unittest.TestCase):
    """Scenarios that one system plays one after the other: each begins where the robot is."""

    def test_scenarios_end_as_expected_and_bag_agrees(self):
        scenarios = [find_scenario(name) for name in OPTIONS.scenarios]
        for scenario in scenarios:
            self.play(scenario)
        goals = [end for scenario in scenarios for end in scenario.expect["goals"]]
        bag = self.read_bag(goals)
        if len(scenarios) == 1 and "actions" in scenarios[0].expect:
            self.assertEqual([str(action) for action in bag.actions], scenarios[0].expect["actions"])
        self.compare(bag)
        self.report(bag, goals)

    def play(self, scenario):
        """Play one; its account lists the deviations."""
        lines = [scenario.title]
        servers = ["move_base", "pickup", "deliver"]
        outcome = run_scenario(scenario, servers, lines.append, PATIENCE, recording=recording_and_flying)
        self.assertEqual(outcome.faults, [], "\n".join(lines))

    def read_bag(self, goals):
        """Return the recorder's bag once it has these ends of goals; all other messages come before."""
        growing = Growing(Path(OPTIONS.bag))
        complete = wait_for(lambda: growing.count_results() >= len(goals), pause=1.0)
        self.assertTrue(complete, "the bag lacks ends of goals")
        rosnode.kill_nodes(["/record"])
        self.assertTrue(wait_for(lambda: os.path.exists(OPTIONS.bag)), "the bag was not closed")
        self.addCleanup(os.remove, OPTIONS.bag)
        bag = Bag(OPTIONS.bag)
        self.assertEqual(sorted(bag.ends.values()), sorted(goals))
        return bag

    def compare(self, bag):
        """Check that updates, actions and returns of the bag agree."""
        self.assertEqual([update.step for update in bag.updates], list(range(1, len(bag.updates) + 1)))
        statements = [item for update in bag.updates for item in update.items if isinstance(item, Statement)]
        committed = [one.body[0].atom for one in statements if one.head is None]
        returned = [one.head for one in statements if one.head is not None and one.head.name == "_return"]
        self.assertEqual(committed, bag.actions[: len(committed)])
        self.assertEqual(len(committed), len(bag.actions))
        self.assertEqual(returned, bag.returns)
        for action, value in zip(bag.actions, bag.returns):
            self.assertEqual(action.arguments[0::2], value.arguments[0::2])

    def report(self, bag, goals):
        """Check that the report has the events of the bag, and that a browser shows it for the paper's run."""
        page = Path(OPTIONS.bag).with_suffix(".html")
        self.addCleanup(page.unlink)
        write_report(Path(OPTIONS.bag), page, about={"title": OPTIONS.name, "verdict": []})
        data = re.search(r'id="run">(.*?)</script>', page.read_text(encoding="utf-8"), re.DOTALL)
        run = json.loads(data.group(1))
        ends = [goal["states"][-1][1] for _, goal in run["goals"]]
        self.assertEqual(sorted(ends), sorted(goals))
        self.assertEqual(len(run["actions"]), len(bag.actions))
        self.assertEqual({bool(one["ended"]) for _, one in run["actions"]}, {True} if bag.actions else set())
        self.assertIsNotNone(run["about"]["map"])
        if not OPTIONS.quick_robot:
            self.assertTrue(run["poses"])
            self.assertIn("way", [shape["kind"] for _, shape in run["shapes"]])
        if OPTIONS.scenarios == ["paper"] and browser.found() is not None:
            with browser.Browser(browser.found()) as shown:
                shown.open(page.as_uri())
                self.assertEqual(shown.texts("#goals .state"), [SAID[one] for one in ends])
                self.assertIn("Bring package 1 from office3 to office2", shown.texts("#goals summary"))
                self.assertEqual(shown.text("#verdict"), "As expected")
                self.assertIn(" m driven", shown.text("#facts"))
                whole = "const zoom = document.querySelector('#timeline select'); zoom.value = '0'"
                shown.run(f"{{ {whole}; zoom.dispatchEvent(new Event('change')); }}")
                self.assertEqual(len(shown.texts(".timeline .bar.done")), len(bag.actions) + ends.count("succeeded"))
                self.assertEqual(shown.faults, [])


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--scenarios", nargs="+", required=True)
    parser.add_argument("--name", required=True)
    parser.add_argument("--bag", required=True)
    parser.add_argument("--quick-robot", action="store_true")
    OPTIONS, _ = parser.parse_known_args(rospy.myargv()[1:])
    rospy.init_node("test_scenario")
    rostest.rosrun("rosoclingo", OPTIONS.name, ScenarioTest, sys.argv)
