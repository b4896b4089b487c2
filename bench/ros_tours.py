#!/usr/bin/env python3
"""Drives tours of random goals on an office floor with the real nodes, or with Stage and the navigation stack for them.

The floor, 54 x 58.7 m at 0.1 m a cell, and 60 things that its map lacks are those of bench/tours.py. Starts its own
master on a port of its own, simulation.launch and navigation.launch; shows how each goal ends, and the collisions that
this package's simulator reports. A goal that is not reached must be impossible: no plan leads to it past all that
stands there, made 8 cm bigger.
Run it in the built workspace: ./dev exec python3 bench/ros_tours.py
"""

import argparse
import math
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np
import rosgraph
import yaml
from figures import Figure, parse, write
from ros_system import System, move_base_client, write_map
from tours import BODIES, SPARE, PlanOutcome, Tour, Variant, office_floor

ROOT = Path(__file__).resolve().parents[1]
LIMIT = 300.0  # s of wall time that a goal may take
SUCCEEDED, OPEN = 3, (0, 1)  # actionlib's states


def write_world(folder: Path, tour: Tour, drift: float) -> None:
    """Write map, world file and navigation's parameters for a tour."""
    grid, robot = tour.grid, tour.drive.robot
    write_map(folder, grid)
    footprint = [list(corner) for corner in tour.variant.footprint]
    body = {"footprint": footprint} if footprint else {"radius": robot.spec.radius}
    laser = {"range": 6.0, "angle": 270.25, "beams": 1081, "noise": tour.variant.noise}
    robots = [{"pose": list(robot.pose), "laser": laser, "drift": [drift, drift], **body}]
    things = tour.drive.world.obstacles.values()
    obstacles = [{"name": f"thing{thing.name}", "at": list(thing.at), "radius": thing.radius} for thing in things]
    world = {"map": "map.yaml", "robots": robots, "obstacles": obstacles}
    (folder / "world.yaml").write_text(yaml.safe_dump(_plain(world)))
    navigation = yaml.safe_load((ROOT / "config" / "navigation.yaml").read_text())
    if footprint:
        del navigation["global_costmap"]["robot_radius"]
        navigation["global_costmap"]["footprint"] = footprint
    (folder / "navigation.yaml").write_text(yaml.safe_dump(navigation))


def _plain(value):
    """Return a value without numpy's types, which YAML does not know."""
    if isinstance(value, dict):
        return {key: _plain(part) for key, part in value.items()}
    if isinstance(value, list):
        return [_plain(part) for part in value]
    return float(value) if isinstance(value, np.floating) else value


def start(folder: Path, arguments) -> System:
    """Start a simulator and navigation for the world in a folder."""
    world, stage = folder / "world.yaml", folder / "stage.world"
    if arguments.sim == "stage":
        subprocess.run(["rosrun", "rosoclingo", "stage_world", str(world), "-o", str(stage)], check=True)
    system = System()
    rosgraph.Master("tours").setParam("/use_sim_time", True)  # before this process asks for the time
    simulation = (f"sim:={arguments.sim}", f"world:={world}", f"stage_world:={stage}", f"speed:={arguments.speed}")
    system.launch("simulation.launch", *simulation)
    files = (f"map:={folder / 'map.yaml'}", f"navigation_config:={folder / 'navigation.yaml'}")
    system.launch("navigation.launch", f"nav:={arguments.nav}", *files)
    return system


def drive(tour: Tour, goals: int) -> list:
    """Send the robot to goals one after the other and tell what comes of it; return the figures."""
    import actionlib
    import rospy
    from move_base_msgs.msg import MoveBaseGoal
    from nav_msgs.msg import Odometry
    from std_msgs.msg import String

    rospy.init_node("tours", anonymous=True)
    collisions = []
    rospy.Subscriber("simulator/collisions", String, lambda message: collisions.append(message.data))
    client = move_base_client(actionlib.SimpleActionClient)
    reached, missed, begin, wall = 0, 0, rospy.get_time(), time.monotonic()
    for number in range(goals):
        target, since, end = tour.somewhere(), rospy.get_time(), time.monotonic() + LIMIT
        goal = MoveBaseGoal()
        goal.target_pose.header.frame_id = "map"
        pose = goal.target_pose.pose
        pose.position.x, pose.position.y = target.x, target.y
        pose.orientation.z, pose.orientation.w = math.sin(0.5 * target.yaw), math.cos(0.5 * target.yaw)
        possible = tour.plan(target, SPARE, tour.variant.reach).outcome is PlanOutcome.FOUND
        client.send_goal(goal)
        while client.get_state() in OPEN and time.monotonic() < end:
            time.sleep(0.02)
        done = client.get_state() == SUCCEEDED
        reached, missed = reached + done, missed + (possible and not done)
        words = "" if done else " MISSED" if possible else " told"
        took = rospy.get_time() - since
        print(f"goal {number}: {took:.0f} simulated s, {client.get_goal_status_text()}{words}", flush=True)
        here = rospy.wait_for_message("base_pose_ground_truth", Odometry, 30.0).pose.pose.position
        tour.drive.robot.pose = tour.drive.robot.pose._replace(x=here.x, y=here.y)
    factor = (rospy.get_time() - begin) / (time.monotonic() - wall)
    print(f"reached {reached}, missed {missed}, collisions {len(collisions)}, {factor:.0f} simulated s per s")
    counts = [Figure("reached", reached, "goals", "higher"), Figure("missed", missed, "goals")]
    return [*counts, Figure("collisions", len(collisions), ""), Figure("pace", factor, "simulated s per s", "higher")]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sim", default="rosoclingo", help="simulation.launch's sim: rosoclingo or stage")
    parser.add_argument("--nav", default="rosoclingo", help="navigation.launch's nav: rosoclingo or move_base")
    parser.add_argument("--speed", type=float, default=0.0, help="of this package's simulator, 0: as fast as it goes")
    parser.add_argument("--body", choices=BODIES, default="disc")
    parser.add_argument("--goals", type=int, default=10)
    parser.add_argument("--drift", type=float, default=0.0, help="greatest relative error of odometry")
    parser.add_argument("--seed", type=int, default=0)
    arguments = parse(parser, goals=2)
    random = np.random.default_rng(arguments.seed)
    tour = Tour(office_floor(arguments.seed), Variant(footprint=BODIES[arguments.body]), random, 60, 0.0)
    with tempfile.TemporaryDirectory() as name:
        write_world(Path(name), tour, arguments.drift)
        system = start(Path(name), arguments)
        try:
            write(arguments.json, drive(tour, arguments.goals))
        finally:
            system.stop()


if __name__ == "__main__":
    main()
