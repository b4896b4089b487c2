"""Any commands, doors, obstacles and moved robots: no robot is ever inside an object, and none passes through one."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from world_reference import Things

from rosoclingo.robot.navigation import OccupancyGrid, Pose2D
from rosoclingo.robot.simulation import Box, DoorSpec, ObstacleSpec, RobotSpec, Simulation, WorldError, WorldSpec

SIZE = 3.0  # m: of the world, whose edge is a wall
STRONG = {"max_speed": 3.0, "max_turn": 8.0, "acceleration": 1e6, "turn_acceleration": 1e6}
BAR = ((0.5, 0.02), (-0.5, 0.02), (-0.5, -0.02), (0.5, -0.02))
ELL = ((0.3, 0.3), (0.0, 0.3), (0.0, 0.0), (-0.3, 0.0), (-0.3, -0.1), (0.3, -0.1))
BESIDE = ((0.5, 0.1), (0.3, 0.1), (0.3, -0.1))  # the robot's origin is outside

coordinates = st.floats(0.0, SIZE)
poses = st.builds(Pose2D, coordinates, coordinates, st.floats(-7.0, 7.0))
stars = st.lists(st.floats(0.03, 0.4), min_size=3, max_size=7).map(
    lambda radii: tuple(
        (r * math.cos(2 * math.pi * i / len(radii)), r * math.sin(2 * math.pi * i / len(radii)))
        for i, r in enumerate(radii)
    )
)
bodies = st.one_of(
    st.floats(0.01, 0.4).map(lambda radius: {"radius": radius}),
    st.one_of(stars, st.sampled_from([BAR, ELL, BESIDE])).map(lambda outline: {"footprint": outline}),
)
boxes = st.builds(Box, st.floats(0.02, 2.5), st.floats(0.02, 2.5), st.floats(-4.0, 4.0))
obstacles = st.tuples(
    st.sampled_from("xyz"),
    st.tuples(coordinates, coordinates),
    st.one_of(st.floats(0.001, 1.0).map(lambda radius: (radius, None)), boxes.map(lambda box: (0.0, box))),
).map(lambda parts: ObstacleSpec(parts[0], parts[1], *parts[2]))
doors = st.tuples(coordinates, coordinates, coordinates, coordinates).filter(lambda d: d[:2] != d[2:])
events = st.one_of(
    st.tuples(st.just("drive"), st.sampled_from("ab"), st.floats(-3.0, 3.0), st.floats(-8.0, 8.0), st.integers(1, 12)),
    st.tuples(st.just("drive"), st.sampled_from("ab"), st.sampled_from([-3.0, 3.0]), st.just(0.0), st.integers(1, 12)),
    st.tuples(st.just("put"), obstacles),
    st.tuples(st.just("remove"), st.sampled_from("xyz")),
    st.tuples(st.just("door"), st.integers(0, 1), st.booleans()),
    st.tuples(st.just("place"), st.sampled_from("ab"), poses),
    st.tuples(st.just("reset")),
)


def walled(seed, resolution, pillars):
    cells = np.zeros((round(SIZE / resolution),) * 2, dtype=np.int8)
    cells[[0, -1]] = cells[:, [0, -1]] = 100
    for row, column in np.random.default_rng(seed).integers(0, len(cells), (pillars, 2)):
        cells[row, column] = 100
    return OccupancyGrid(cells, resolution)


def happen(world, event):
    """Apply an event; impossible ones are refused."""
    kind, *rest = event
    if kind == "drive":
        name, v, w, steps = rest
        for _ in range(steps):
            world.command(name, v, w)
            before = dict(world.robots[name].pose._asdict())
            world.step()
            check_the_way(world, name, Pose2D(**before), v, w)
        return
    calls = {
        "put": world.put_obstacle,
        "remove": world.remove_obstacle,
        "door": lambda i, opened: world.set_door(str(i), opened),
        "place": world.place,
        "reset": world.reset,
    }
    calls[kind](*rest)


def check_the_way(world, name, before, v, w):
    """Check a disc's path closely: it can cut a corner by less than an eighth of a cell."""
    robot = world.robots[name]
    if robot.outline:
        return
    things, spare = Things(world, name, others=False), world.spec.grid.resolution / 8.0
    part = min(1.0, before.distance(robot.pose) / max(abs(v) * 0.1, 1e-9) * 1.5)
    if v * v < 1e-4 or robot.spec.radius <= spare:
        return
    for t in np.linspace(0.0, 1.0, 15):
        pose = before.advance(v, w, 0.1 * part * t)
        if before.distance(pose) > before.distance(robot.pose):
            break
        assert things.overlap_disc(pose.x, pose.y, robot.spec.radius - spare) == ""


def start(grid, bodies_of, places, gates):
    """Return a world with each robot at the first place where it fits; None if there is none."""
    robots = []
    for name, body in zip("ab", bodies_of):
        for pose in places:
            try:
                robot = RobotSpec(name, pose, **body, **STRONG)
                world = Simulation(WorldSpec(grid, (*robots, robot), gates))
            except WorldError:
                continue
            robots.append(robot)
            break
        else:
            return None
    return world


@pytest.mark.slow
@given(
    st.integers(0, 999), st.sampled_from([0.05, 0.1, 0.5]), st.integers(0, 12), st.tuples(bodies, bodies),
    st.lists(poses, min_size=2, max_size=12), st.tuples(doors, doors), st.lists(events, min_size=3, max_size=16),
)  # fmt: skip
def test_bodies_are_never_inside_an_object(seed, resolution, pillars, pair, places, gates, stream):
    shut = tuple(DoorSpec(str(i), d[:2], d[2:], open=True) for i, d in enumerate(gates))
    world = start(walled(seed, resolution, pillars), pair, places, shut)
    assume(world is not None)
    for event in [("reset",), *stream]:
        try:
            happen(world, event)
        except WorldError:
            assert event[0] != "drive"
        for name, robot in world.robots.items():
            assert Things(world, name).overlap(robot) == "", (event, name)


@pytest.mark.slow
@given(st.integers(0, 999), st.sampled_from([0.05, 0.1, 0.5]), st.integers(0, 12), bodies, poses, obstacles)
def test_bodies_can_be_placed_exactly_where_they_fit(seed, resolution, pillars, body, pose, obstacle):
    """The robot starts in a far corner."""
    cells = walled(seed, resolution, pillars).cells
    cells = np.pad(cells, ((0, 0), (0, round(3.0 / resolution))))
    robot = RobotSpec("a", Pose2D(5.0, 1.5), **body, **STRONG)
    world = Simulation(WorldSpec(OccupancyGrid(cells, resolution), (robot,)))
    world.put_obstacle(obstacle)
    wrong = Things(world, "a").overlap(world.robots["a"], pose)
    if wrong:
        with pytest.raises(WorldError, match="would collide with"):
            world.place("a", pose)
        return
    if body.get("footprint") in (ELL, BESIDE):
        return
    # A place that the reference permits can be refused by a hair: the reference examines only points of the sides.
    shrunk = {key: 0.8 * np.array(value) for key, value in body.items()}
    robot = RobotSpec("a", pose, **{k: tuple(map(tuple, v)) if v.ndim else float(v) for k, v in shrunk.items()})
    Simulation(WorldSpec(OccupancyGrid(cells, resolution), (robot,), (), (obstacle,)))
