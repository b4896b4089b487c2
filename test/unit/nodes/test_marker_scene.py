"""The markers for rviz on the map: places of packages, arrows of the plan, ways and marks."""

import math

import pytest
from visualization_msgs.msg import Marker

from rosoclingo.common.labels import LabelTable
from rosoclingo.nodes.rviz.canvas import LINE_HEIGHT, Canvas
from rosoclingo.nodes.rviz.scene import LATER, NEXT, SHUT, draw_drawings, draw_packages, draw_plan, things_in
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


def drawn(draw, *arguments):
    canvas = Canvas()
    draw(canvas, *arguments)
    return canvas.markers


def place(marker):
    return marker.pose.position.x, marker.pose.position.y, marker.pose.position.z


def colour(marker):
    return marker.color.r, marker.color.g, marker.color.b, marker.color.a


def arrows(cycle, start):
    found = drawn(draw_plan, [action_of(parse_atom(text)) for text in PLAN], LABELS, cycle, start)
    return [(one.points[0].x, one.points[1].x, colour(one)) for one in found if one.type == Marker.ARROW]


def test_markers_place_packages_apart_at_label_or_robot():
    places = [("1", "office2", False), ("2", "office2", False), ("3", "", True), ("4", "", True), ("5", "attic", False)]
    found = drawn(draw_packages, places, LABELS, "base_link")
    cubes = [one for one in found if (one.ns, one.type) == ("packages", Marker.CUBE)]
    assert [one.header.frame_id for one in cubes] == ["map", "map", "base_link", "base_link"]
    assert place(cubes[0])[:2] == (4.0, 0.65)
    assert math.dist(place(cubes[0]), place(cubes[1])) > cubes[0].scale.x
    assert math.dist(place(cubes[2]), place(cubes[3])) > cubes[2].scale.x


def test_markers_arrows_follow_remaining_plan_from_robot():
    assert arrows(1, (0.0, 0.0)) == [(0.0, 4.0, NEXT), (4.0, 8.0, LATER), (8.0, 4.0, LATER)]
    assert arrows(3, (8.0, 0.0)) == [(8.0, 4.0, LATER)]
    assert arrows(6, (4.0, 0.0)) == []
    assert arrows(1, None) == [(4.0, 8.0, LATER), (8.0, 4.0, LATER)], "without a pose"


def test_markers_blocked_way_has_bar_and_text():
    found = drawn(draw_drawings, [Drawing(DrawingKind.BLOCKED, ("office1", "office2"), "shut")], LABELS)
    way, bar, plate, words = found
    assert {colour(one)[:3] for one in (way, bar, words)} == {SHUT[:3]}
    assert [(point.x, point.y) for point in way.points] == [(0.0, 0.0), (4.0, 0.0)]
    one, other = bar.points
    assert (one.x, other.x) == (2.0, 2.0)
    assert one.y == -other.y != 0.0
    assert one.z > way.points[0].z
    assert (words.text, plate.ns) == ("shut", "plates")
    assert plate.pose.position.z < words.pose.position.z


def test_markers_texts_keep_their_upper_edge_on_a_large_map():
    tops = []
    for factor in (1.0, 3.0):
        canvas = Canvas(factor)
        canvas.text("labels", "map", "office1\nis shut", (1.0, 2.0, 0.0))
        (text,) = canvas.markers
        tops.append(text.pose.position.y + text.scale.z * LINE_HEIGHT)
    assert tops[0] == pytest.approx(tops[1])


def test_markers_show_things_in_beliefs_as_packages():
    drawings = [
        Drawing(DrawingKind.THING, ("office2",), "cup"),
        Drawing(DrawingKind.CARRIED, (), "tray"),
        Drawing(DrawingKind.ROBOT, ("office1",), ""),
    ]
    assert things_in(drawings) == [("cup", "office2", False), ("tray", "", True)]
    assert drawn(draw_drawings, drawings, LABELS) == []
