"""Office and house under late, repeated and false facts: every action and every end is right, also in the recording.

The recorded run replays with no unexplained difference, and its stream gives the same answers by the command.

ROSOCLINGO_SEED chooses another course of events, ROSOCLINGO_GOALS the number of goals in each of the two worlds.
"""

import json
import os
import queue
import re
import signal
import subprocess
import tempfile
import threading
import unittest
from pathlib import Path
from random import Random

import rosbag
import rospy
from actionlib.action_client import CommState
from actionlib_msgs.msg import GoalStatus
from carrying_world import HOUSE, OFFICE, ROBOT, Play
from core_helpers import Client, ManualInterfaces
from interface_helpers import PATIENCE, Process, executable, wait_until
from rosoclingo.msg import GoalStates, ROSoClingoGoal

from rosoclingo.common.action_clients import cancel_goal
from rosoclingo.nodes.recording.recorder import is_recording
from rosoclingo.oclingo import SolveOutcome
from rosoclingo.oclingo.service.command import UNSATISFIABLE
from rosoclingo.reasoning.goals import Outcome

SEED = int(os.environ.get("ROSOCLINGO_SEED", "1"))
GOALS = int(os.environ.get("ROSOCLINGO_GOALS", "5"))
WORLDS = {"office": OFFICE, "house": HOUSE}
CORE_TOPICS = [
    f"/{world}/{topic}"
    for world in WORLDS
    for topic in (
        "out_rosoclingo",
        *(f"rosoclingo/{own}" for own in ("program", "updates", "task_plan", "goals", "state")),
    )
]
TOPICS = ["/rosout", "/diagnostics", *CORE_TOPICS]
ENDS = {  # a goal that is recalled before it arrives has no result of its own
    GoalStatus.SUCCEEDED: "succeeded",
    GoalStatus.PREEMPTED: "canceled",
    GoalStatus.RECALLED: "canceled",
    GoalStatus.ABORTED: "aborted",
    GoalStatus.REJECTED: "rejected",
}
LIMIT = 1500  # seconds of wall time for a command, on the slowest machine


class Stage(ManualInterfaces):
    """The core node ``name/rosoclingo``, and a play of ``goals`` around it, which answers the core's commands."""

    def __init__(self, name, domain, seed, goals):
        self._happened = queue.Queue()
        self._handles = {}
        self._cancelled = set()
        self.play = Play(domain, self, Random(seed), goals)
        super().__init__(f"{name}/rosoclingo")
        self.at_once = True
        self._client = Client(f"{name}/rosoclingo").raw

    def send(self, key, text):
        """Send a goal."""
        goal = ROSoClingoGoal(text)
        self._handles[key] = self._client.send_goal(goal, lambda handle: self._changed(key, handle))

    def cancel(self, key):
        """Cancel a goal once the core is known to have it: actionlib would treat an earlier one as lost."""
        self._cancelled.add(key)
        self._cancel(key, self._handles[key])

    def tell(self, facts):
        """Send facts as an interface."""
        super().tell(*facts, origin="world")

    def succeed(self, command):
        """Let the play answer a command."""
        self._happened.put((self.play.command, (command,)))

    def _cancel(self, key, handle):
        if key in self._cancelled and handle.get_comm_state() in (CommState.PENDING, CommState.ACTIVE):
            self._cancelled.discard(key)
            cancel_goal(self._client, handle)

    def _changed(self, key, handle):
        self._cancel(key, handle)
        if handle.get_comm_state() != CommState.WAITING_FOR_GOAL_ACK:
            self._happened.put((self.play.acknowledged, (key,)))
        if handle.get_comm_state() == CommState.DONE:
            status, result = handle.get_terminal_state(), handle.get_result()
            end = ENDS.get(status, "lost")
            if result is not None and result.message and Outcome(result.outcome).name.lower() != end:
                end = f"{result.outcome}, but its status is {status}"
            self._happened.put((self.play.ended, (key, end, handle.get_goal_status_text())))

    def run(self):
        """Play until all goals have ended."""
        if not self.play.live:
            self.play.stir()
        while not self.play.over:
            do, arguments = self._happened.get(timeout=PATIENCE)
            do(*arguments)
            if not self.play.live:
                self.play.stir()

    def run_to_the_end(self):
        """Play, then request each thing on the robot and one thing more; nothing fails any more."""
        self.run()
        for _ in range(20):
            if not self.play.request_all_things_on_board():
                break
            self.run()
        before = self.play.ends["succeeded"]
        for _ in range(20):
            if self.play.ends["succeeded"] == before:
                self.play.wish()
                self.run()
        return self.play.ends["succeeded"] > before


def command(*words):
    """Run one of the package's commands without a master; return its exit code and output."""
    environment = {**os.environ, "ROS_MASTER_URI": "http://localhost:1"}
    words = (executable(words[0]), *map(str, words[1:]))
    done = subprocess.run(words, env=environment, text=True, timeout=LIMIT, capture_output=True, check=False)
    return done.returncode, done.stdout, done.stderr


def all_ended(world):
    """Return whether the latest ~goals of a core, which comes after the results, has no open goal."""
    states = rospy.wait_for_message(f"/{world}/rosoclingo/goals", GoalStates, LIMIT)
    return all(goal.ended.to_sec() for goal in states.goals)


class ReplayBag(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.bag = Path(cls.folder.name, "run.bag")
        with Process(executable("record"), f"_bag:={cls.bag}", f"_topics:=[{', '.join(TOPICS)}]") as record:
            wait_until(lambda: is_recording(TOPICS), "the recorder to be connected")
            cls.ended_well = []
            stages = [Stage(name, world, SEED, GOALS) for name, world in WORLDS.items()]
            threads = [threading.Thread(target=cls.play, args=(stage,)) for stage in stages]
            for one in threads:
                one.start()
            for one in threads:
                one.join()
            wait_until(lambda: all(map(all_ended, WORLDS)), "the cores to report that all goals have ended")
            record.signal(signal.SIGINT)
            wait_until(lambda: is_recording([]), "the recorder to wait for the others")
            record.signal(signal.SIGINT)
            record.wait()
        cls.plays = [stage.play for stage in stages]

    @classmethod
    def play(cls, stage):
        if stage.run_to_the_end():
            cls.ended_well.append(stage.play)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_each_action_and_each_end_is_right(self):
        for play in self.plays:
            self.assertTrue(play.over)
            self.assertEqual(play.faults, [], play.story)
            self.assertIn(play, self.ended_well, play.story)
            self.assertNotIn(ROBOT, {one.place for one in play.things.values()})
            self.assertGreaterEqual(sum(play.ends.values()), GOALS)
            self.assertGreaterEqual(play.ends["succeeded"], GOALS // 10, play.ends)
        ends = {end: sum(play.ends[end] for play in self.plays) for end in self.plays[0].ends}
        self.assertGreaterEqual(min(ends.values()), max(GOALS // 50, 1), ends)

    def test_differences_are_all_explained(self):
        for world in WORLDS:
            code, text, error = command("replay", self.bag, "--core", f"{world}/rosoclingo")
            self.assertEqual((code, error), (0, ""), text)
            self.assertTrue(text.endswith("no unexplained difference\n"), text)
            print(f"{world}: {text}")

    def test_stream_gives_the_same_answers(self):
        core, stream, folder = ("--core", "house/rosoclingo"), f"{self.bag}.stream", f"{self.bag}_program"
        code, text, error = command("replay", self.bag, *core, "--stream", stream, "--program-to", folder)
        self.assertEqual((code, error), (0, ""))
        self.assertTrue(text.startswith("rosrun rosoclingo oclingo "), text)
        code, text, _ = command(*text.split()[2:], "--json")
        results = list(map(json.loads, text.splitlines()))
        unmet = any(one["outcome"] == SolveOutcome.UNSATISFIABLE.value for one in results)  # so a goal was aborted
        self.assertEqual(code, UNSATISFIABLE if unmet else 0)
        with rosbag.Bag(str(self.bag)) as bag:
            reported = {one.cycle: one for _, one, _ in bag.read_messages(["/house/rosoclingo/task_plan"])}
        compared = 0
        for found in results:
            plan = reported.get(found["step"])
            if plan is not None and plan.actions and found["answers"]:
                self.assertEqual((found["step"], found["horizon"]), (plan.cycle, plan.horizon))
                compared += 1
        self.assertGreaterEqual(compared, 5)

    def test_report_has_at_most_some_megabytes(self):
        for world in WORLDS:
            page = Path(f"{self.bag}_{world}.html")
            code, text, error = command("report", self.bag, "--core", f"{world}/rosoclingo", "-o", page)
            self.assertEqual((code, text, error), (0, f"report: {page}\n", ""))
            self.assertLess(page.stat().st_size, 5_000_000)
            run = json.loads(
                re.search(r'id="run">(.*?)</script>', page.read_text(encoding="utf-8"), re.DOTALL).group(1)
            )
            goals = [goal for _, goal in run["goals"]]
            self.assertGreaterEqual(len(goals), GOALS)
            self.assertEqual([goal for goal in goals if goal["ended"] is None], [])
            with rosbag.Bag(str(self.bag)) as bag:
                reported = {fact for _, one, _ in bag.read_messages([f"/{world}/out_rosoclingo"]) for fact in one.facts}
            self.assertEqual(len(run["actions"]), sum(fact.startswith("_action_lib(") for fact in reported))
