"""Any stream of commands compared with the closed form: limits, watchdog, arcs, odometry's drift."""

import math

from hypothesis import given, settings
from hypothesis import strategies as st
from navigation_worlds import room

from rosoclingo.robot.navigation import Pose2D, normalize_angle
from rosoclingo.robot.simulation import RobotSpec, Simulation, WorldSpec

START = Pose2D(30.0, 30.0, 0.4)
FIELD = room(60.0, 60.0, 0.2)
limits = st.one_of(st.just(0.0), st.floats(0.01, 3.0))
speeds = st.one_of(st.floats(-4.0, 4.0), st.sampled_from([0.0, 1e-12, 1e300, -1e300, math.nan, math.inf, -math.inf]))
commands = st.one_of(st.none(), st.tuples(speeds, speeds))
changes = st.one_of(st.floats(0.01, 50.0), st.just(1e9))


class Reference:
    """A differential drive by the book: speeds change at the beginning of a step, then it drives an arc."""

    def __init__(self, spec, interval, watchdog, factors):
        self.spec, self.interval, self.watchdog, self.factors = spec, interval, watchdog, factors
        self.x, self.y, self.yaw = spec.pose
        self.odometry = list(spec.pose)
        self.v = self.w = 0.0
        self.wanted, self.heard = (0.0, 0.0), None

    def step(self, number, command):
        if command is not None:
            self.wanted, self.heard = (command if all(map(math.isfinite, command)) else (0.0, 0.0)), number
        age = math.inf if self.heard is None else (number - self.heard) * self.interval
        v, w = self.wanted if self.watchdog == 0.0 or age < self.watchdog - 1e-9 else (0.0, 0.0)
        self.v = self.nearer(self.v, v, self.spec.max_speed, self.spec.acceleration)
        self.w = self.nearer(self.w, w, self.spec.max_turn, self.spec.turn_acceleration)
        self.x, self.y, self.yaw = self.arc(self.x, self.y, self.yaw, self.v, self.w)
        a, b = self.factors
        self.odometry = self.arc(*self.odometry, self.v * a, self.w * b)

    def nearer(self, now, wanted, limit, change):
        """Return the speed after a step: at most ``change`` per second towards the commanded and permitted one."""
        wanted = math.copysign(min(abs(wanted), limit), wanted)
        most = change * self.interval
        return wanted if abs(wanted - now) <= most else now + math.copysign(most, wanted - now)

    def arc(self, x, y, yaw, v, w):
        t = self.interval
        if abs(w * t) < 1e-4:  # the circle's formula suffers from cancellation; two terms of the series are exact here
            middle = yaw + 0.5 * w * t
            shrink = v * t * (1.0 - (w * t) ** 2 / 24.0)
            return x + shrink * math.cos(middle), y + shrink * math.sin(middle), yaw + w * t
        r = v / w
        return (
            x + r * (math.sin(yaw + w * t) - math.sin(yaw)),
            y - r * (math.cos(yaw + w * t) - math.cos(yaw)),
            yaw + w * t,
        )


@given(
    st.lists(commands, min_size=1, max_size=50), limits, limits, changes, changes,
    st.sampled_from([0.01, 0.05, 0.1, 0.25]), st.sampled_from([0.0, 0.05, 0.2, 0.25, 0.6]), st.sampled_from([0.0, 0.2]),
)  # fmt: skip
def test_kinematics_of_any_commands_match_closed_form(
    stream, speed, turn, acceleration, turn_acceleration, interval, watchdog, drift
):
    spec = RobotSpec(
        "a", START, 0.2, (), speed, turn, acceleration, turn_acceleration, lasers=(), drift=(drift, drift / 2)
    )
    world = Simulation(WorldSpec(FIELD, (spec,), interval=interval, seed=3), watchdog)
    robot = world.robots["a"]
    reference = Reference(spec, interval, watchdog, robot.drift)
    for number, command in enumerate(stream):
        if command is not None:
            world.command("a", *command)
        assert world.step() == []
        reference.step(number, command)
        assert (robot.v, robot.w) == (reference.v, reference.w)
        for pose, expected in (
            (robot.pose, (reference.x, reference.y, reference.yaw)),
            (robot.odometry, reference.odometry),
        ):
            assert math.hypot(pose.x - expected[0], pose.y - expected[1]) < 1e-9
            assert abs(normalize_angle(pose.yaw - expected[2])) < 1e-9
        assert abs(robot.v) <= speed
        assert abs(robot.w) <= turn


@given(st.lists(st.tuples(speeds, speeds), min_size=1, max_size=20), st.integers(0, 5))
@settings(max_examples=settings.default.max_examples // 3)
def test_kinematics_drift_is_bounded_factor_from_the_seed(stream, seed):
    spec = RobotSpec("a", START, lasers=(), drift=(0.1, 0.3))
    one, twin, other = (Simulation(WorldSpec(FIELD, (spec,), seed=number)) for number in (seed, seed, seed + 1))
    a, b = one.robots["a"].drift
    assert abs(a - 1.0) <= 0.1
    assert abs(b - 1.0) <= 0.3
    for command in stream:
        one.command("a", *command)
        one.step()
    assert one.robots["a"].drift == twin.robots["a"].drift != other.robots["a"].drift
