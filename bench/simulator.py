#!/usr/bin/env python3
"""Measures the simulator node without a speed limit: simulated seconds per second, and jitter of move_base's commands.

The bench starts a separate master. Each robot has a laser like Stage's (1081 beams, 270.25 degrees, 6 m). The cases are

* one robot without subscribers, except to the clock
* one robot, and a process that subscribes to all topics of the simulator
* the same, while move_base drives the robot from one end of the office to the other
* the same, with all topics of move_base subscribed too
* four and ten robots, each without subscribers and with all topics of the simulator subscribed

The best of several runs is shown, because other load on the machine can only slow down a run.

Run it in the built workspace: ./dev exec python3 bench/simulator.py
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Optional

import rosgraph
from figures import Figure, parse, write
from ros_system import System, move_base_client

ROOT = Path(__file__).resolve().parents[1]
ROBOT = "  - {{pose: [{x}, {y}, 0], radius: 0.18, laser: {{range: 6.0, angle: 270.25, beams: 1081}}}}\n"
ENDS = ((1.9, 0.0), (13.9, 0.0))  # targets of move_base, in turns
CASES = {
    "one robot alone": (1, None, False),
    "one robot, its topics subscribed": (1, "/simulator", False),
    "one robot, subscribed and navigating": (1, "/simulator", True),
    "the same, all topics subscribed": (1, "", True),
    "four robots alone": (4, None, False),
    "four robots, their topics subscribed": (4, "/simulator", False),
    "ten robots alone": (10, None, False),
    "ten robots, their topics subscribed": (10, "/simulator", False),
}


def world_file(folder: Path, robots: int) -> Path:
    places = [(1.9 + 1.2 * (i % 5), 0.3 - 0.7 * (i // 5)) for i in range(robots)]
    text = "map: {}\nrobots:\n".format(ROOT / "worlds" / "office.yaml")
    path = folder / f"world{robots}.yaml"
    path.write_text(text + "".join(ROBOT.format(x=x, y=y) for x, y in places))
    return path


def start(world: Path, subscribed: Optional[str], navigation: bool) -> System:
    """Start the simulator, and optionally navigation and a process that subscribes to the topics of a node."""
    system = System()
    system.launch("simulation.launch", f"world:={world}", "speed:=0")
    if navigation:
        system.launch("navigation.launch")
    if subscribed is not None:
        system.start(sys.executable, __file__, "--hear", subscribed)
    return system


def hear(node: str) -> None:
    """Subscribe to all present and future topics of a node (empty: any node)."""
    import rospy

    rospy.init_node("hear", anonymous=True)
    heard = {"/rosout", "/rosout_agg", "/clock"}  # every node subscribes to the clock
    while not rospy.is_shutdown():
        published, _, _ = rosgraph.Master("hear").getSystemState()
        for name, nodes in published:
            if name not in heard and (not node or node in nodes):
                heard.add(name)
                rospy.Subscriber(name, rospy.AnyMsg, lambda _: None)
        time.sleep(0.5)


class Driver:
    """Sends move_base from one end to the other forever, and records the times of its commands."""

    def __init__(self, clock) -> None:
        import actionlib
        import rospy
        from geometry_msgs.msg import Twist

        self.stamps, self.ends, self.handle = [], [], None
        self.client = move_base_client(actionlib.ActionClient)
        rospy.Subscriber("cmd_vel", Twist, lambda _: self.stamps.append(clock[0]), tcp_nodelay=True)

    def go_on(self) -> None:
        from actionlib_msgs.msg import GoalStatus
        from move_base_msgs.msg import MoveBaseGoal

        if self.handle is not None:
            if self.handle.get_comm_state() != 7:  # CommState.DONE
                return
            self.ends.append(self.handle.get_goal_status() == GoalStatus.SUCCEEDED)
        goal = MoveBaseGoal()
        goal.target_pose.header.frame_id = "map"
        goal.target_pose.pose.orientation.w = 1.0
        goal.target_pose.pose.position.x, goal.target_pose.pose.position.y = ENDS[(len(self.ends) + 1) % 2]
        self.handle = self.client.send_goal(goal)

    def report(self, begin: float) -> str:
        import numpy as np

        gaps = np.diff([stamp for stamp in self.stamps if stamp >= begin])
        text = f", {sum(self.ends)} of {len(self.ends)} goals reached, command period"
        quantiles = zip(("median", "p99", "worst"), np.percentile(gaps, (50, 99, 100)))
        return text + "".join(f" {name} {value:.2f}" for name, value in quantiles) + " simulated s"


def watch(navigating: bool, seconds: float) -> None:
    """Print the pace; runs in a separate process, because a process can be a node only once."""
    import rospy
    from rosgraph_msgs.msg import Clock

    rospy.init_node("watch", anonymous=True)
    clock = [0.0]
    rospy.Subscriber("/clock", Clock, lambda message: clock.__setitem__(0, message.clock.to_sec()))
    while clock[0] == 0.0:
        time.sleep(0.05)
    driver = Driver(clock) if navigating else None
    begin = wall = 0.0
    started = time.monotonic() + 2.0
    while not wall or time.monotonic() < started + seconds:
        if driver:
            driver.go_on()
        if not wall and time.monotonic() >= started:
            begin, wall = clock[0], time.monotonic()
        time.sleep(0.02)
    factor = (clock[0] - begin) / (time.monotonic() - wall)
    print(f"{factor:7.1f} simulated s per s" + (driver.report(begin) if driver else ""), flush=True)
    os._exit(0)


def measure(case, seconds: float, folder: Path) -> str:
    robots, subscribed, navigating = case
    system = start(world_file(folder, robots), subscribed, navigating)
    command = [sys.executable, __file__, "--watch", str(int(navigating)), str(seconds)]
    try:
        done = subprocess.run(
            command, check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, timeout=180 + seconds
        )
        return done.stdout.decode().strip("\n")
    finally:
        system.stop()


def pace(report: str) -> float:
    """Return the simulated seconds per second that a report begins with."""
    return float(report.split()[0])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=6.0, help="wall time of each run (default: %(default)s)")
    parser.add_argument(
        "--runs", type=int, default=3, help="runs of each case; the best is shown (default: %(default)s)"
    )
    cases = range(len(CASES))
    parser.add_argument(
        "--only", type=int, nargs="+", default=cases, choices=cases, help="numbers of the cases to run (default: all)"
    )
    parser.add_argument("--watch", nargs=2, help=argparse.SUPPRESS)
    parser.add_argument("--hear", help=argparse.SUPPRESS)
    arguments = parse(parser, seconds=3.0, runs=1, only=[0, 1, 2])
    if arguments.hear is not None:
        return hear(arguments.hear)
    if arguments.watch:
        return watch(arguments.watch[0] == "1", float(arguments.watch[1]))
    with tempfile.TemporaryDirectory() as folder:
        figures = []
        for number, (name, case) in enumerate(CASES.items()):
            if number in arguments.only:
                found = [measure(case, arguments.seconds, Path(folder)) for _ in range(arguments.runs)]
                best = max(found, key=pace)
                print(f"{name:38}", best, flush=True)
                figures.append(Figure(name, pace(best), "simulated s per s", "higher"))
    write(arguments.json, figures)
    print("load of the machine (1, 5, 15 min):", *(f"{load:.1f}" for load in os.getloadavg()))
    return None


if __name__ == "__main__":
    main()
