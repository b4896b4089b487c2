#!/usr/bin/env python3
"""Drives tours of random goals on an office floor with the nodes of this package, or with Stage and move_base.

The floor, 54 x 58.7 m at 0.1 m a cell, and 60 obstacles that its map lacks are those of bench/tours.py. The bench
starts a separate master, simulation.launch and navigation.launch. It prints how each goal ends, and counts collisions:
the reports of this package's simulator, or with Stage the times that the robot stands still despite its commands. A
goal that is not reached must be impossible: no path leads to it if all obstacles are 8 cm larger.

Run it in the built workspace: ./dev exec python3 bench/ros_tours.py
With Stage and move_base: ./dev --overlay WORKSPACE exec python3 bench/ros_tours.py --sim stage --nav move_base
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
from crowd import PREFIX, carry, launch_text, walk
from figures import Figure, parse, write
from ros_system import System, move_base_client, write_map
from stalls import Stalls
from tours import BODIES, SPARE, PlanOutcome, Pose2D, Tour, Variant, office_floor

ROOT = Path(__file__).resolve().parents[1]
LIMIT = 300.0  # s of wall time, the limit of a goal
PREEMPTED, SUCCEEDED, OPEN = 2, 3, (0, 1)  # states of actionlib
HURRY = 4.0  # simulated s until another client replaces a goal


def write_world(folder: Path, tour: Tour, drift: float, walkers: int = 0) -> None:
    """Write the map, the world file and the navigation parameters of a tour with ``walkers`` people."""
    grid, robot = tour.grid, tour.drive.robot
    write_map(folder, grid)
    footprint = [list(corner) for corner in tour.variant.footprint]
    body = {"footprint": footprint} if footprint else {"radius": robot.spec.radius}
    laser = {"range": 6.0, "angle": 270.25, "beams": 1081, "noise": tour.variant.noise}
    robots = [{"name": "robot", "pose": list(robot.pose), "laser": laser, "drift": [drift, drift], **body}]
    places = (place for place in iter(tour.somewhere, None) if place.distance(robot.pose) < 15.0)
    people = (place for place in places if all(place.distance(thing) > 0.6 for thing in spots(tour)))
    robots += [
        {"name": f"walker{number}", "pose": list(next(people)), "radius": 0.2, "laser": False, "max_speed": 1.0}
        for number in range(walkers)
    ]
    things = tour.drive.world.obstacles.values()
    obstacles = [{"name": f"thing{thing.name}", "at": list(thing.at), "radius": thing.radius} for thing in things]
    world = {"map": "map.yaml", "robots": robots, "obstacles": obstacles}
    (folder / "world.yaml").write_text(yaml.safe_dump(_plain(world)))
    navigation = yaml.safe_load((ROOT / "config" / "navigation.yaml").read_text())
    if footprint:
        del navigation["global_costmap"]["robot_radius"]
        navigation["global_costmap"]["footprint"] = footprint
    (folder / "navigation.yaml").write_text(yaml.safe_dump(navigation))


def spots(tour: Tour) -> list:
    """Return the poses of the robot and of all obstacles."""
    things = (Pose2D(*thing.at) for thing in tour.drive.world.obstacles.values())
    return [tour.drive.robot.pose, *things]


def _plain(value):
    """Return ``value`` without numpy's types, which YAML cannot represent."""
    if isinstance(value, dict):
        return {key: _plain(part) for key, part in value.items()}
    if isinstance(value, list):
        return [_plain(part) for part in value]
    return float(value) if isinstance(value, np.floating) else value


def start(folder: Path, tour: Tour, arguments) -> System:
    """Start the simulator and navigation for the world in ``folder``."""
    world, stage = folder / "world.yaml", folder / "stage.world"
    if arguments.sim == "stage":
        subprocess.run(["rosrun", "rosoclingo", "stage_world", str(world), "-o", str(stage)], check=True)
    system = System()
    rosgraph.Master("tours").setParam("/use_sim_time", True)  # before this process reads the time
    simulation = (f"sim:={arguments.sim}", f"world:={world}", f"stage_world:={stage}", f"speed:={arguments.speed}")
    system.launch("simulation.launch", *simulation)
    server = "rosoclingo" if arguments.nav == "rosoclingo" else "map_server"
    pose = " ".join(map(str, tour.drive.robot.pose))
    chosen = {"nav": arguments.nav, "localization": arguments.localization, "map_server": server}
    if arguments.walkers:
        files = {"map": folder / "map.yaml", "navigation": folder / "navigation.yaml", "start": pose}
        (folder / "first.launch").write_text(launch_text(**chosen, **files))
        system.start("roslaunch", str(folder / "first.launch"), "--wait")
        return system
    files = (f"map:={folder / 'map.yaml'}", f"navigation_config:={folder / 'navigation.yaml'}", f"initial_pose:={pose}")
    system.launch("navigation.launch", *(f"{key}:={value}" for key, value in chosen.items()), *files)
    return system


def watch_collisions(sim: str, prefix: str):
    """Return a function that returns the number of collisions so far."""
    import rospy
    from geometry_msgs.msg import Twist
    from nav_msgs.msg import Odometry
    from std_msgs.msg import String

    if sim == "rosoclingo":
        reports = []
        rospy.Subscriber("simulator/collisions", String, lambda message: reports.append(message.data))
        return lambda: sum(text.startswith("robot ran into") for text in reports)
    stalls = Stalls()

    def on_truth(message) -> None:
        pose = message.pose.pose
        yaw = 2.0 * math.atan2(pose.orientation.z, pose.orientation.w)
        stalls.truth(message.header.stamp.to_sec(), pose.position.x, pose.position.y, yaw)

    def on_command(message) -> None:
        stalls.command(rospy.get_time(), message.linear.x, message.angular.z)

    rospy.Subscriber(prefix + "cmd_vel", Twist, on_command, tcp_nodelay=True)
    rospy.Subscriber(prefix + "base_pose_ground_truth", Odometry, on_truth, tcp_nodelay=True)
    return lambda: stalls.times


class Goals:
    """Sends the robot to random poses, and counts how the goals end."""

    def __init__(self, tour: Tour, prefix: str) -> None:
        import actionlib

        self.tour, self.prefix = tour, prefix
        self.client = move_base_client(actionlib.SimpleActionClient, prefix)
        self.rival = move_base_client(actionlib.SimpleActionClient, prefix)
        self.reached = self.missed = self.replaced = 0

    def go(self, number: int, rivals: bool) -> None:
        """Drive to a random pose; with ``rivals``, another client replaces every second goal on the way."""
        import rospy

        target, since, end = self.tour.somewhere(), rospy.get_time(), time.monotonic() + LIMIT
        self.client.send_goal(pose_goal(target))
        wins = self.client
        if rivals and number % 2:
            while rospy.get_time() < since + HURRY and self.client.get_state() in OPEN:
                time.sleep(0.02)
            first, target, wins = self.client, self.tour.somewhere(), self.rival
            wins.send_goal(pose_goal(target))
            first.wait_for_result(rospy.Duration(60.0))
            self.replaced += first.get_state() == PREEMPTED
        possible = self.tour.plan(target, SPARE, self.tour.variant.reach).outcome is PlanOutcome.FOUND
        while wins.get_state() in OPEN and time.monotonic() < end:
            time.sleep(0.02)
        done = wins.get_state() == SUCCEEDED
        self.reached, self.missed = self.reached + done, self.missed + (possible and not done)
        words = "" if done else " MISSED" if possible else " impossible"
        took = rospy.get_time() - since
        print(f"goal {number}: {took:.0f} simulated s, {wins.get_goal_status_text()}{words}", flush=True)
        self.look()

    def look(self) -> None:
        """Set the tour to the true pose of the robot, from which the next goal is judged."""
        import rospy
        from nav_msgs.msg import Odometry

        here = rospy.wait_for_message(self.prefix + "base_pose_ground_truth", Odometry, 30.0).pose.pose.position
        self.tour.drive.robot.pose = self.tour.drive.robot.pose._replace(x=here.x, y=here.y)


def pose_goal(target: Pose2D):
    """Return a goal for move_base."""
    from move_base_msgs.msg import MoveBaseGoal

    goal = MoveBaseGoal()
    goal.target_pose.header.frame_id = "map"
    pose = goal.target_pose.pose
    pose.position.x, pose.position.y = target.x, target.y
    pose.orientation.z, pose.orientation.w = math.sin(0.5 * target.yaw), math.cos(0.5 * target.yaw)
    return goal


def drive(tour: Tour, arguments) -> list:
    """Send the robot to one goal after the other and print how they end; return the figures."""
    import rospy

    rospy.init_node("tours", anonymous=True)
    prefix = PREFIX if arguments.walkers else ""
    collisions, goals = watch_collisions(arguments.sim, prefix), Goals(tour, prefix)
    people = walk(arguments.walkers, arguments.seed)
    begin, wall = rospy.get_time(), time.monotonic()
    for number in range(arguments.goals):
        if arguments.kidnap and number == arguments.goals // 2:
            carry(arguments.sim, prefix, tour.somewhere())
            print("the robot was moved to another pose, published on initialpose", flush=True)
        goals.go(number, arguments.rivals)
    for person in people:
        person.unregister()
    factor = (rospy.get_time() - begin) / (time.monotonic() - wall)
    more = f", replaced {goals.replaced}" if arguments.rivals else ""
    counts = f"reached {goals.reached}, missed {goals.missed}{more}, collisions {collisions()}"
    print(f"{counts}, {factor:.0f} simulated s per s")
    figures = [Figure("reached", goals.reached, "goals", "higher"), Figure("missed", goals.missed, "goals")]
    return [*figures, Figure("collisions", collisions(), ""), Figure("pace", factor, "simulated s per s", "higher")]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sim", default="rosoclingo", help="sim of simulation.launch: rosoclingo or stage")
    parser.add_argument("--nav", default="rosoclingo", help="nav of navigation.launch: rosoclingo or move_base")
    parser.add_argument(
        "--speed",
        type=float,
        help="simulated s per s, 0 for no limit (default: 0, with Stage, move_base, fake or amcl 5)",
    )
    parser.add_argument(
        "--localization",
        default="rosoclingo",
        help="localization of navigation.launch: rosoclingo, fake or amcl",
    )
    parser.add_argument("--walkers", type=int, default=0, help="people who walk around (default: %(default)s)")
    parser.add_argument("--rivals", action="store_true", help="let another client replace every second goal")
    parser.add_argument(
        "--kidnap", action="store_true", help="half way, move the robot and publish its pose on initialpose"
    )
    parser.add_argument("--body", choices=BODIES, default="disc", help="body of the robot (default: %(default)s)")
    parser.add_argument("--goals", type=int, default=10, help="number of goals (default: %(default)s)")
    parser.add_argument(
        "--drift", type=float, default=0.0, help="greatest relative error of odometry (default: %(default)s)"
    )
    parser.add_argument("--seed", type=int, default=0, help="seed of floor and goals (default: %(default)s)")
    arguments = parse(parser, goals=2)
    if arguments.speed is None:
        own = arguments.sim == arguments.nav == arguments.localization == "rosoclingo"
        arguments.speed = 0.0 if own else 5.0
    random = np.random.default_rng(arguments.seed)
    tour = Tour(office_floor(arguments.seed), Variant(footprint=BODIES[arguments.body]), random, 60, 0.0)
    with tempfile.TemporaryDirectory() as name:
        write_world(Path(name), tour, arguments.drift, arguments.walkers)
        system = start(Path(name), tour, arguments)
        try:
            write(arguments.json, drive(tour, arguments))
        finally:
            system.stop()


if __name__ == "__main__":
    main()
