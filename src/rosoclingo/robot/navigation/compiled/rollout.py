"""The compiled trial of commands: which of them stays clear, and which leads best to a point."""

import math

import numpy as np

from rosoclingo.robot.navigation.compiled.footprints import body_clearance
from rosoclingo.robot.navigation.compiled.jit import jit
from rosoclingo.robot.navigation.compiled.path import point_clearance

__all__ = ["best_arc", "best_command", "spare_after", "turn_spare"]

FINE = 0.1  # cells: the least step along an arc
GAIN = 0.05  # part of the room looked for by which an arc that leads to less has to gain


@jit
def _arc(v, w, time):
    """Return half the turn (rad) of an arc, and the length of its chord, whose direction that is."""
    half = 0.5 * w * time
    return half, v * time * (math.sin(half) / half if abs(half) > 1e-9 else 1.0)


@jit
def spare_after(near, body, x, y, yaw, v, w, horizon, steps, least, enough):
    """Return the least body clearance along an arc of ``horizon`` s; stops looking where that is below ``least``."""
    dt = horizon / steps
    found = np.inf
    half, chord = _arc(v, w, dt)
    for _ in range(steps):
        x += chord * math.cos(yaw + half)
        y += chord * math.sin(yaw + half)
        yaw += w * dt
        found = min(found, body_clearance(near, body, x, y, yaw, enough))
        if found < least:
            break
    return found


@jit
def turn_spare(near, body, x, y, yaw, turn, least):
    """Return the least body clearance while turning on the spot; stops looking where that is below ``least``."""
    found = body_clearance(near, body, x, y, yaw, max(0.0, least))
    if body.shape[0] == 1 or point_clearance(near.clearance, x, y) - body[0, 2] > least:
        return found  # it needs no more room than it has
    steps = int(abs(turn) / 0.05) + 1
    for i in range(1, steps + 1):
        if found < least:
            break
        found = min(found, body_clearance(near, body, x, y, yaw + turn * i / steps, max(0.0, least)))
    return found


@jit
def best_command(near, body, pose, speeds, turns, carrot, needs, comfort, horizon, steps, weights):
    """Return (index of speed, index of turn) of the best command, -1 where none is safe.

    ``pose`` (x, y, yaw; cells, rad), ``speeds`` (cells/s), ``turns`` (rad/s), ``carrot`` (x, y; cells). A command is
    safe when the body keeps what its speed needs (``needs``, cells) for the whole horizon or, where that is negative
    and its amount is not there now, does not come closer.
    ``weights``: of the distance to the carrot (1/cell), the angle to it (1/rad), nearness to obstacles (1/cell).
    """
    now = body_clearance(near, body, pose[0], pose[1], pose[2], comfort)
    best, best_i, best_j = np.inf, -1, -1
    for i in range(speeds.shape[0]):
        least = needs[i] if needs[i] > 0.0 else min(-needs[i], now - 1e-6)
        for j in range(turns.shape[0]):
            if abs(speeds[i]) < 1e-6 and abs(turns[j]) < 0.05:
                continue  # to stand still is the caller's last resort
            half, chord = _arc(speeds[i], turns[j], horizon)
            x, y = pose[0] + chord * math.cos(pose[2] + half), pose[1] + chord * math.sin(pose[2] + half)
            away = math.hypot(carrot[0] - x, carrot[1] - y)
            bearing = math.atan2(carrot[1] - y, carrot[0] - x) - pose[2] - 2.0 * half
            angle = abs(math.atan2(math.sin(bearing), math.cos(bearing)))
            # Next to the carrot its direction says little.
            score = weights[0] * away + weights[1] * angle * min(1.0, 0.5 * away)
            if score >= best:
                continue
            spare = spare_after(
                near,
                body,
                pose[0],
                pose[1],
                pose[2],
                speeds[i],
                turns[j],
                horizon,
                steps,
                least,
                comfort,
            )
            score += weights[2] * max(0.0, comfort - spare)
            if spare >= least and score < best:
                best, best_i, best_j = score, i, j
    return best_i, best_j


@jit
def best_arc(near, body, pose, curvatures, longest, room, least):
    """Return (index of curvature, signed length) of the arc that leads soonest to where ``room`` is clear.

    ``pose``: x, y (cells), yaw; ``curvatures`` (1/cell); ``longest`` (cells). The body keeps ``least`` (cells) on it,
    or what it has now if that is less. Where no arc leads to so much room: the one to where there is most; the length
    is 0.0 where none leads to more than there is.
    """
    now = body_clearance(near, body, pose[0], pose[1], pose[2], 2.0)
    least = min(least, now - 1e-3)
    shortest, most = np.inf, point_clearance(near.clearance, pose[0], pose[1]) + GAIN * room
    best_i, best_length, more_i, more_length = 0, 0.0, 0, 0.0
    for i in range(curvatures.shape[0]):
        for sign in (1.0, -1.0):
            x, y, yaw, done, spare = pose[0], pose[1], pose[2], 0.0, now
            while done < min(longest, shortest):
                step = max(FINE, 0.5 * (spare - least) / (1.0 + abs(curvatures[i]) * body[0, 2]))
                half, chord = _arc(sign * step, sign * curvatures[i] * step, 1.0)
                x, y = x + chord * math.cos(yaw + half), y + chord * math.sin(yaw + half)
                yaw, done = yaw + 2.0 * half, done + step
                spare = body_clearance(near, body, x, y, yaw, 2.0)
                if spare < least:
                    break
                clear = point_clearance(near.clearance, x, y)
                if clear >= room:
                    if done < shortest:
                        shortest, best_i, best_length = done, i, sign * done
                    break
                if clear > most:
                    most, more_i, more_length = clear, i, sign * done
    return (best_i, best_length) if best_length != 0.0 else (more_i, more_length)
