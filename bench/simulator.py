#!/usr/bin/env python3
"""Measures the simulator node without a speed limit: simulated seconds per second.

The bench starts a separate master. Each robot has a laser like Stage's (1081 beams, 270.25 degrees, 6 m). *Subscribed*
means that another process subscribes to all topics of the simulator, otherwise only to the clock. *Navigating* means
that move_base drives the robot from one end of the office to the other. The best of several runs counts, because other
load on the machine can only slow down a run.

Run it in the built workspace: ./dev exec python3 bench/simulator.py
"""

import subprocess
import tempfile
import time
from pathlib import Path

import rosgraph
import rospy
from actionlib_msgs.msg import GoalStatus
from figures import Figure, Option, main
from move_base_msgs.msg import MoveBaseGoal
from ros_system import System, move_base_client, pose_stamped
from rosgraph_msgs.msg import Clock

OFFICE = Path(__file__).resolve().parents[1] / "worlds" / "office.yaml"
ROBOT = "  - {{pose: [{x}, {y}, 0], radius: 0.18, laser: {{range: 6.0, angle: 270.25, beams: 1081}}}}\n"
ENDS = ((13.9, 0.0), (1.9, 0.0))  # targets of move_base, in turns
CASES = {  # the number of robots, whether another process subscribes to all their topics, whether move_base drives
    "one robot alone": (1, False, False),
    "one robot, its topics subscribed": (1, True, False),
    "one robot, subscribed and navigating": (1, True, True),
    "four robots alone": (4, False, False),
    "four robots, their topics subscribed": (4, True, False),
    "ten robots alone": (10, False, False),
    "ten robots, their topics subscribed": (10, True, False),
}


def hear():
    """Subscribe to all present and future topics of the simulator, as a process."""
    rospy.init_node("hear", anonymous=True)
    heard = {"/rosout", "/rosout_agg", "/clock"}  # every node subscribes to the clock
    while not rospy.is_shutdown():
        published, _, _ = rosgraph.Master("hear").getSystemState()
        for name, nodes in published:
            if name not in heard and "/simulator" in nodes:
                heard.add(name)
                rospy.Subscriber(name, rospy.AnyMsg, lambda _: None)
        time.sleep(0.5)


def watch(navigating, seconds):
    """Print the simulated seconds per second, while move_base drives if ``navigating``, as a process."""
    rospy.init_node("watch", anonymous=True)
    rospy.wait_for_message("/clock", Clock)
    client = move_base_client() if navigating else None
    ends, begin, wall, start = 0, 0.0, 0.0, time.monotonic() + 2.0
    while not wall or time.monotonic() < wall + seconds:
        if client and client.get_state() not in (GoalStatus.PENDING, GoalStatus.ACTIVE):
            client.send_goal(MoveBaseGoal(pose_stamped(*ENDS[ends % 2])))
            ends += 1
        if not wall and time.monotonic() >= start:
            begin, wall = rospy.get_time(), time.monotonic()
        time.sleep(0.02)
    print((rospy.get_time() - begin) / (time.monotonic() - wall), flush=True)


def pace(folder, robots, subscribed, navigating, seconds):
    """Return the simulated seconds per second of one case."""
    places = [(1.9 + 1.2 * (i % 5), 0.3 - 0.7 * (i // 5)) for i in range(robots)]
    world = Path(folder) / "world.yaml"
    world.write_text(f"map: {OFFICE}\nrobots:\n" + "".join(ROBOT.format(x=x, y=y) for x, y in places))
    with System(simulated=True) as system:
        system.launch("simulation.launch", f"world:={world}", "speed:=0")
        if navigating:
            system.launch("navigation.launch")
        if subscribed:
            system.call("simulator", "hear()")
        watcher = system.call("simulator", f"watch({navigating}, {seconds})", stdout=subprocess.PIPE, text=True)
        return float(watcher.communicate(timeout=180 + seconds)[0])


def measure(options):
    """Yield the best pace of each case."""
    with tempfile.TemporaryDirectory() as folder:
        for name, case in [*CASES.items()][: options.cases]:
            best = max(pace(folder, *case, options.seconds) for _ in range(options.runs))
            yield Figure(name, best, "simulated s per s", "higher")


if __name__ == "__main__":
    main(
        __doc__,
        measure,
        seconds=Option(6.0, "wall time of each run", 3.0),
        runs=Option(3, "runs of each case; the best counts", 1),
        cases=Option(len(CASES), "number of cases, the first ones", 3),
    )
