"""The compiled trial of movements: which of them stay clear, and which leads best to a point."""

import math

import numpy as np

from rosoclingo.robot.navigation.compiled.footprints import Around, body_clearance
from rosoclingo.robot.navigation.compiled.jit import jit
from rosoclingo.robot.navigation.compiled.path import point_clearance

STEPS = 12  # poses checked along a command
ANGLE, NEARNESS = 0.25, 0.6  # m by which a rad off the point, and a m that lacks to the comfort, make a command worse
FINE = 0.1  # cells: the shortest step along an arc
GAIN = 0.05  # part of the room by which an arc that leads to less of it has to gain


@jit
def _arc(v, w, time):
    """Return half the turn (rad) of an arc, and the length of its chord, whose direction that is."""
    half = 0.5 * w * time
    return half, v * time * (math.sin(half) / half if abs(half) > 1e-9 else 1.0)


@jit
def _spare_after(near, body, pose, v, w, horizon, steps, least, enough):
    """Return the least body clearance along an arc of ``horizon`` s; stops where that is below ``least``."""
    dt = horizon / steps
    x, y, yaw = pose[0], pose[1], pose[2]
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
def can_turn(clearance, occupied, touched, body, pose, angle, close):
    """Return whether a body keeps ``close``, or what it has now if that is less, while it turns by ``angle`` rad.

    Here and below the first three are those of :class:`Around`.
    """
    near = Around(clearance, occupied, touched)
    least = min(close, body_clearance(near, body, pose[0], pose[1], pose[2], close) - 1e-3)
    steps = int(abs(angle) / 0.05) + 1
    return _spare_after(near, body, pose, 0.0, angle, 1.0, steps, least, max(0.0, least)) >= least


@jit
def best_command(clearance, occupied, touched, body, pose, speeds, needs, turns, carrot, comfort, horizon, resolution):
    """Return (index of speed, index of turn) of the best command, -1 where none is safe.

    ``pose`` (x, y, yaw; cells, rad), ``speeds`` (cells/s), ``turns`` (rad/s), ``carrot`` (x, y; cells), ``resolution``
    (m). A command is safe when the body keeps what its speed needs (``needs``, cells) for the ``horizon`` (s) or, where
    that is negative and its amount is not there now, does not come closer. Clearance up to ``comfort`` counts.
    """
    near = Around(clearance, occupied, touched)
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
            score = resolution * away + ANGLE * angle * min(1.0, 0.5 * away)
            if score >= best:
                continue
            spare = _spare_after(near, body, pose, speeds[i], turns[j], horizon, np.int64(STEPS), least, comfort)
            score += NEARNESS * resolution * max(0.0, comfort - spare)
            if spare >= least and score < best:
                best, best_i, best_j = score, i, j
    return best_i, best_j


@jit
def best_arc(clearance, occupied, touched, body, pose, curvatures, longest, room, least):
    """Return (index of curvature, signed length) of the arc that leads soonest to where ``room`` is clear.

    ``pose``: x, y (cells), yaw; ``curvatures`` (1/cell); ``longest`` (cells). The body keeps ``least`` (cells) on it,
    or what it has now if that is less. Where no arc leads to so much room: the one to where there is most; the length
    is 0.0 where none leads to more than there is.
    """
    near = Around(clearance, occupied, touched)
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
