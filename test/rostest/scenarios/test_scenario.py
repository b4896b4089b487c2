"""Plays shipped scenarios in the whole system: core, interfaces, office, recorder, and simulator and navigation.

Simulated time runs fast once all nodes are up: before, its steps would only delay their start.
"""

import argparse
import json
import os
import re
import shutil
import tempfile
import unittest
from pathlib import Path

import rosbag
import rosnode
import rospy
from interface_helpers import PATIENCE, wait_until
from rosoclingo.srv import SetSpeed

from rosoclingo.nodes.pages.report_command import write_report
from rosoclingo.nodes.recording.bag_file import unfinished_path
from rosoclingo.nodes.recording.recorder import RECORDED, is_recording
from rosoclingo.nodes.scenarios.playing import find_scenario, run_scenario
from rosoclingo.reasoning.keywords import CORE

PARSER = argparse.ArgumentParser()
PARSER.add_argument("--scenarios", nargs="+", required=True)
PARSER.add_argument("--bag", required=True)
PARSER.add_argument("--quick-robot", action="store_true")
OPTIONS = PARSER.parse_known_args(rospy.myargv()[2:])[0]
README = Path(__file__).resolve().parents[3] / "README.md"
EVENT = re.compile(r"^ +[\d.]+ s +(cycle \d+ +(\w+) .*)$", re.MULTILINE)
SPEED = 10.0  # simulated seconds per second
GOAL_STATES = {2: "canceled", 3: "succeeded", 4: "aborted", 5: "rejected", 8: "canceled"}


class Bag:
    """The contents of a bag: actions, and the end of each goal."""

    def __init__(self, path):
        self.actions, self.ends = [], {}
        with rosbag.Bag(str(path)) as bag:
            for _, message, _ in bag.read_messages("/out_rosoclingo"):
                self.actions += message.facts if message.interface != CORE else []
            for _, message, _ in bag.read_messages("/rosoclingo/result"):
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

    def test_scenarios_end_as_expected(self):
        scenarios = [find_scenario(name) for name in OPTIONS.scenarios]
        for scenario in scenarios:
            self.play(scenario)
        goals = [end for scenario in scenarios for end in scenario.expect["goals"]]
        bag = self.read_bag(goals)
        if len(scenarios) == 1 and "actions" in scenarios[0].expect:
            self.assertEqual(bag.actions, scenarios[0].expect["actions"])
        self.report(bag, goals)

    def play(self, scenario):
        """Play one; its account lists the deviations."""
        lines = [scenario.title]
        servers = ["move_base", "pickup", "deliver"]
        outcome = run_scenario(scenario, servers, lines.append, PATIENCE, recording=recording_and_flying)
        account = "\n".join(lines)
        self.assertEqual(outcome.faults, [], account)
        if OPTIONS.scenarios == ["paper"]:
            self.compare_with_readme(account)

    def compare_with_readme(self, account):
        """Compare the account with its beginning and end in README.md, apart from times."""
        beginning, _, end = README.read_text(encoding="utf-8").partition("        ...\n")
        shown, printed = EVENT.findall(beginning), EVENT.findall(account)
        in_order = [event for event in printed if event[1] != "goal"]  # statuses are on a topic of their own
        self.assertEqual(in_order[: len(shown)], shown)
        self.assertEqual(printed[-1:], EVENT.findall(end))

    def read_bag(self, goals):
        """Return the recorder's bag once it has these ends of goals; all other messages come before."""
        growing = Growing(Path(OPTIONS.bag))
        wait_until(lambda: growing.count_results() >= len(goals), "the bag to have the ends of all goals")
        rosnode.kill_nodes(["/record"])
        wait_until(lambda: os.path.exists(OPTIONS.bag), "the bag to be closed")
        self.addCleanup(os.remove, OPTIONS.bag)
        bag = Bag(OPTIONS.bag)
        self.assertEqual(sorted(bag.ends.values()), sorted(goals))
        return bag

    def report(self, bag, goals):
        """Check that the report has the events of the bag."""
        page = Path(OPTIONS.bag).with_suffix(".html")
        self.addCleanup(page.unlink)
        write_report(Path(OPTIONS.bag), page, about={"title": "scenarios", "verdict": []})
        data = re.search(r'id="run">(.*?)</script>', page.read_text(encoding="utf-8"), re.DOTALL)
        run = json.loads(data.group(1))
        self.assertEqual(sorted(goal["states"][-1][1] for _, goal in run["goals"]), sorted(goals))
        self.assertEqual(len(run["actions"]), len(bag.actions))
        self.assertIsNotNone(run["about"]["map"])
        if not OPTIONS.quick_robot:
            self.assertTrue(run["poses"])
            self.assertIn("way", [shape["kind"] for _, shape in run["shapes"]])
