#!/usr/bin/env python3
"""Measures the simulator as a node, free running: simulated seconds per second, and the jitter of move_base's commands.

Starts its own master on a port of its own. Cases: one robot with Stage's laser (1081 beams, 270.25 degrees, 6 m) alone;
the same with all its topics subscribed; the same with move_base navigating; four and ten robots alone.
Run it in the built workspace: ./dev exec bench/simulator.py
"""

import argparse
import os
import signal
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import rosgraph

ROOT = Path(__file__).resolve().parents[1]
ROBOT = "  - {{pose: [{x}, {y}, 0], radius: 0.18, laser: {{range: 6.0, angle: 270.25, beams: 1081}}}}\n"


def world_file(folder: Path, robots: int) -> Path:
    places = [(1.9 + 1.2 * (i % 5), 0.3 - 0.7 * (i // 5)) for i in range(robots)]
    text = "map: {}\nrobots:\n".format(ROOT / "worlds" / "office.yaml")
    path = folder / f"world{robots}.yaml"
    path.write_text(text + "".join(ROBOT.format(x=x, y=y) for x, y in places))
    return path


class Run:
    """A launch of simulator and perhaps navigation, and what is seen of it."""

    def __init__(self, world: Path, navigation: bool) -> None:
        command = ["roslaunch", "rosoclingo", "simulation.launch", f"world:={world}", "speed:=0"]
        self.processes = [self.start(["roscore", "-p", os.environ["ROS_MASTER_URI"].rsplit(":", 1)[1]])]
        deadline = time.monotonic() + 60.0
        while not rosgraph.is_master_online() and time.monotonic() < deadline:
            time.sleep(0.1)
        self.processes.append(self.start([*command, "--wait"]))
        if navigation:
            self.processes.append(self.start(["roslaunch", "rosoclingo", "navigation.launch", "--wait"]))

    @staticmethod
    def start(command):
        return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def stop(self) -> None:
        for process in reversed(self.processes):
            process.send_signal(signal.SIGINT)
        for process in self.processes:
            process.wait(timeout=30)


def measure(robots: int, subscribed: bool, navigating: bool, seconds: float, folder: Path) -> str:
    """Runs in a process of its own, as a node lives once a process."""
    run = Run(world_file(folder, robots), navigating)
    command = [sys.executable, __file__, "--watch", str(int(subscribed)), str(int(navigating)), str(seconds)]
    try:
        return (
            subprocess.run(command, check=True, stdout=subprocess.PIPE, timeout=180 + seconds).stdout.decode().strip()
        )
    finally:
        run.stop()


def watch(subscribed: bool, navigating: bool, seconds: float) -> None:
    import actionlib
    import numpy as np
    import rospy
    from geometry_msgs.msg import Twist
    from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
    from nav_msgs.msg import Odometry
    from rosgraph_msgs.msg import Clock

    rospy.init_node("watch", anonymous=True)
    clock, stamps, ends = [0.0], [], []
    rospy.Subscriber("/clock", Clock, lambda message: clock.__setitem__(0, message.clock.to_sec()))
    while clock[0] == 0.0:
        time.sleep(0.05)
    if subscribed:
        for name in ("odom", "base_scan", "/tf", *([] if navigating else ["base_pose_ground_truth"])):
            rospy.Subscriber(name, rospy.AnyMsg, lambda _: None)
    if navigating:
        client = actionlib.SimpleActionClient("move_base", MoveBaseAction)
        deadline = time.monotonic() + 60.0
        while not client.action_client.wait_for_server(rospy.Duration(20.0)):
            if time.monotonic() > deadline:
                print("move_base did not appear within 60 s", flush=True)
                os._exit(0)
        rospy.Subscriber("cmd_vel", Twist, lambda _: stamps.append(clock[0]))
        truth = [Odometry()]
        rospy.Subscriber("base_pose_ground_truth", Odometry, lambda message: truth.__setitem__(0, message))

        def send():
            goal = MoveBaseGoal()
            goal.target_pose.header.frame_id = "map"
            goal.target_pose.pose.orientation.w = 1.0
            goal.target_pose.pose.position.x = 13.9 if truth[0].pose.pose.position.x < 8.0 else 1.9
            client.send_goal(goal, done_cb=lambda state, _: (ends.append(state), send()))

        send()
    time.sleep(1.0)
    begin, wall = clock[0], time.monotonic()
    time.sleep(seconds)
    factor = (clock[0] - begin) / (time.monotonic() - wall)
    text = f"{factor:7.1f} simulated s per s"
    if navigating:
        gaps = np.diff(np.array(stamps))
        words = ", goals reached {} of {}, command period median {:.2f} p99 {:.2f} simulated s"
        text += words.format(sum(end == 3 for end in ends), len(ends), np.median(gaps), np.percentile(gaps, 99))
    print(text, flush=True)
    os._exit(0)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=10.0, help="wall time of each case")
    parser.add_argument("--watch", nargs=3, help=argparse.SUPPRESS)
    parser.add_argument("--only", type=int, help="the number of the only case to run, from 0")
    arguments = parser.parse_args()
    if arguments.watch:
        subscribed, navigating, seconds = arguments.watch
        watch(subscribed == "1", navigating == "1", float(seconds))
        return
    with socket.socket() as free:
        free.bind(("", 0))
        os.environ["ROS_MASTER_URI"] = f"http://localhost:{free.getsockname()[1]}"
    cases = (
        ("one robot alone", 1, False, False),
        ("one robot, all topics subscribed", 1, True, False),
        ("one robot, subscribed and navigating", 1, True, True),
        ("four robots alone", 4, False, False),
        ("ten robots alone", 10, False, False),
    )
    with tempfile.TemporaryDirectory() as folder:
        for name, robots, subscribed, navigating in cases if arguments.only is None else [cases[arguments.only]]:
            print(
                f"{name:38}",
                measure(robots, subscribed, navigating, arguments.seconds, Path(folder)),
                flush=True,
            )


if __name__ == "__main__":
    main()
