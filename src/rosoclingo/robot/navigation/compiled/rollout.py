"""Simulation of movements: which of them are safe, and which leads best to a point; compiled by numba."""

import math

import numpy as np

from rosoclingo.robot.navigation.compiled.footprints import body_clearance
from rosoclingo.robot.navigation.compiled.jit import jit

STEPS = 12  # poses checked along a command
ANGLE, NEARNESS = 0.25, 0.6  # weights of the heading error (m/rad) and of missing comfort clearance (m/m) in the score


@jit
def _arc(v, w, time):
    """Return half the turn (rad) of an arc, which is the direction of its chord, and the length of the chord."""
    half = 0.5 * w * time
    return half, v * time * (math.sin(half) / half if abs(half) > 1e-9 else 1.0)


@jit
def _spare_after(clearance, occupied, body, pose, v, w, horizon, steps, least, enough):
    """Return the minimum clearance of the body along an arc of ``horizon`` s. Stops once it is below ``least``."""
    dt = horizon / steps
    x, y, yaw = pose[0], pose[1], pose[2]
    found = np.inf
    half, chord = _arc(v, w, dt)
    for _ in range(steps):
        x += chord * math.cos(yaw + half)
        y += chord * math.sin(yaw + half)
        yaw += w * dt
        found = min(found, body_clearance(clearance, occupied, body, x, y, yaw, enough))
        if found < least:
            break
    return found


@jit
def can_turn(clearance, occupied, body, pose, angle, close):
    """Return whether a body keeps a clearance of ``close`` while it turns by ``angle`` rad.

    If its present clearance is smaller, it must keep that. ``clearance`` and ``occupied``, here and below: see
    :func:`~rosoclingo.robot.navigation.compiled.footprints.body_clearance`.
    """
    least = min(close, body_clearance(clearance, occupied, body, pose[0], pose[1], pose[2], close) - 1e-3)
    steps = int(abs(angle) / 0.05) + 1
    return _spare_after(clearance, occupied, body, pose, 0.0, angle, 1.0, steps, least, max(0.0, least)) >= least


@jit
def best_command(clearance, occupied, body, pose, speeds, needs, turns, carrot, comfort, horizon, resolution):
    """Return (index of speed, index of turn) of the best safe command, -1 if none is safe.

    ``pose``: x, y (cells), yaw (rad). ``speeds``: cells/s. ``turns``: rad/s. ``carrot``: the target x, y (cells).
    ``comfort``: the clearance up to which more is better. ``horizon``: s. ``resolution``: m.

    ``needs`` (cells) is the clearance that each speed requires during the horizon. If it is negative and its absolute
    value is not available now, the clearance must not decrease.
    """
    now = body_clearance(clearance, occupied, body, pose[0], pose[1], pose[2], comfort)
    best, best_i, best_j = np.inf, -1, -1
    for i in range(speeds.shape[0]):
        least = needs[i] if needs[i] > 0.0 else min(-needs[i], now - 1e-6)
        for j in range(turns.shape[0]):
            if abs(speeds[i]) < 1e-6 and abs(turns[j]) < 0.05:
                continue  # standing still is left to the caller
            half, chord = _arc(speeds[i], turns[j], horizon)
            x, y = pose[0] + chord * math.cos(pose[2] + half), pose[1] + chord * math.sin(pose[2] + half)
            away = math.hypot(carrot[0] - x, carrot[1] - y)
            bearing = math.atan2(carrot[1] - y, carrot[0] - x) - pose[2] - 2.0 * half
            angle = abs(math.atan2(math.sin(bearing), math.cos(bearing)))
            # Close to the target its direction hardly matters.
            score = resolution * away + ANGLE * angle * min(1.0, 0.5 * away)
            if score >= best:
                continue
            spare = _spare_after(
                clearance, occupied, body, pose, speeds[i], turns[j], horizon, np.int64(STEPS), least, comfort
            )
            score += NEARNESS * resolution * max(0.0, comfort - spare)
            if spare >= least and score < best:
                best, best_i, best_j = score, i, j
    return best_i, best_j
