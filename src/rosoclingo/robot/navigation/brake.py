"""Braking for obstacles that the laser sees but the costmap does not contain yet.

Marking a cell takes several scans. Moving obstacles, such as another robot, leave a cell before it is marked.
"""

from typing import Sequence

import numpy as np

from rosoclingo.robot.navigation.compiled.outlines import gaps
from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.navigation.local_planner import Velocity

# While driving: times to check (s) and the margin (m), which allows for approaching obstacles.
DRIVE_TIMES, DRIVE_MARGIN = (0.2, 0.4, 0.6, 0.8, 1.0), 0.05
# While turning on the spot, where the robot can stop at once: times to check (s) and the margin (m).
TURN_TIMES, TURN_MARGIN = (0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4), 0.02
SPEED_FACTORS = (1.0, 0.6, 0.3, 0.0)  # fractions of the speed, tried in this order


def brake(velocity: Velocity, pose: Pose2D, points: np.ndarray, radius: float, footprint: Sequence = ()) -> Velocity:
    """Return the velocity, reduced where necessary to keep a margin to nearby points (n, 2; m).

    If the robot is within the margin of a point already, the distance must not decrease. If no candidate is safe, the
    robot stops.
    """
    if not len(points):
        return velocity
    outline = np.array(footprint, dtype=np.float64).reshape(-1, 2)
    now = gaps(outline, radius, *pose, points)
    for part in SPEED_FACTORS:
        slower = Velocity(part * velocity.linear, velocity.angular)
        checks = [(TURN_TIMES, TURN_MARGIN), *([(DRIVE_TIMES, DRIVE_MARGIN)] if slower.linear else [])]
        if all(
            (gaps(outline, radius, *pose.advance(*slower, time), points) >= np.minimum(margin, now) - 1e-6).all()
            for times, margin in checks
            for time in times
        ):
            return slower
    return Velocity()
