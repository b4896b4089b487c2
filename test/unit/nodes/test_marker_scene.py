"""The markers for rviz on the map: places of packages, arrows of the plan, ways and marks."""

import math

from rosoclingo.common.labels import LabelTable
from rosoclingo.nodes.rviz.scene import (
    LATER,
    NEXT,
    SHUT,
    drawn_shapes,
    package_shapes,
    plan_shapes,
    things_in,
)
from rosoclingo.oclingo import parse_atom
from rosoclingo.reasoning.keywords import action_of
from rosoclingo.runs.drawing import Drawing, DrawingKind

LABELS = LabelTable.from_mapping({"office1": [0, 0], "office2": [4, 0, math.pi / 2], "office3": [8, 0]})
PLAN = [
    "_action_lib(move_base,office2,1)",
    "_action_lib(move_base,office3,2)",
    "_action_lib(pickup,1,3)",
    "_action_lib(move_base,office2,4)",
    "_action_lib(deliver,1,5)",
]


def arrows(cycle, start):
    shapes = plan_shapes([action_of(parse_atom(text)) for text in PLAN], LABELS, cycle, start)
    return [(shape.points[0][0], shape.points[1][0], shape.colour) for shape in shapes if shape.kind == "arrow"]


def test_markers_place_packages_apart_at_label_or_robot():
    places = [("1", "office2", False), ("2", "office2", False), ("3", "", True), ("4", "", True), ("5", "attic", False)]
    cubes = [shape for shape in package_shapes(places, LABELS, "base_link") if shape.kind == "cube"]
    assert [shape.frame for shape in cubes] == ["map", "map", "base_link", "base_link"]
    assert cubes[0].position[:2] == (4.0, 0.65)
    assert math.dist(cubes[0].position, cubes[1].position) > cubes[0].scale[0]
    assert math.dist(cubes[2].position, cubes[3].position) > cubes[2].scale[0]


def test_markers_arrows_follow_remaining_plan_from_robot():
    assert arrows(1, (0.0, 0.0)) == [(0.0, 4.0, NEXT), (4.0, 8.0, LATER), (8.0, 4.0, LATER)]
    assert arrows(3, (8.0, 0.0)) == [(8.0, 4.0, LATER)]
    assert arrows(6, (4.0, 0.0)) == []
    assert arrows(1, None) == [(4.0, 8.0, LATER), (8.0, 4.0, LATER)], "without a pose"


def drawn(*drawings):
    return drawn_shapes([Drawing(kind, labels, text) for kind, labels, text in drawings], LABELS)


def test_markers_blocked_way_has_bar_and_text():
    way, bar, words = drawn((DrawingKind.BLOCKED, ("office1", "office2"), "shut"))
    assert {shape.colour[:3] for shape in (way, bar, words)} == {SHUT[:3]}
    assert [point[:2] for point in way.points] == [(0.0, 0.0), (4.0, 0.0)]
    (x0, y0, high), (x1, y1, _) = bar.points
    assert (x0, x1) == (2.0, 2.0)
    assert y0 == -y1 != 0.0
    assert high > way.points[0][2]
    assert (words.text, words.plate is None) == ("shut", False)


def test_markers_show_things_in_beliefs_as_packages():
    drawings = [
        Drawing(DrawingKind.THING, ("office2",), "cup"),
        Drawing(DrawingKind.CARRIED, (), "tray"),
        Drawing(DrawingKind.ROBOT, ("office1",), ""),
    ]
    assert things_in(drawings) == [("cup", "office2", False), ("tray", "", True)]
    assert drawn_shapes(drawings, LABELS) == []
