"""What rviz is to show: places of packages, arrows and words of the plan."""

import math

from rosoclingo.common.labels import LabelTable
from rosoclingo.nodes.rviz.scene import (
    LATER,
    NEXT,
    label_shapes,
    package_shapes,
    plan_shapes,
    plan_steps,
    plan_text,
    robot_shapes,
    title_shapes,
)
from rosoclingo.oclingo import parse_atom
from rosoclingo.reasoning.keywords import action_of

LABELS = LabelTable.from_mapping({"office1": [0, 0], "office2": [4, 0, math.pi / 2], "office3": [8, 0]})
PLAN = [
    "_action_lib(move_base,office2,1)",
    "_action_lib(move_base,office3,2)",
    "_action_lib(pickup,1,3)",
    "_action_lib(move_base,office2,4)",
    "_action_lib(deliver,1,5)",
]


def steps(plan=PLAN):
    return plan_steps([action_of(parse_atom(text)) for text in plan], LABELS)


def arrows(cycle, start):
    shapes = plan_shapes(steps(), cycle, start, (0.0, 0.0, 0.0), "map")
    return [(shape.points[0][0], shape.points[1][0], shape.colour) for shape in shapes if shape.kind == "arrow"]


def test_every_label_has_a_disc_and_a_name():
    shapes = label_shapes(LABELS)
    assert [shape.text for shape in shapes if shape.kind == "text"] == ["office1", "office2", "office3"]
    assert [shape.position[0] for shape in shapes if shape.kind == "cylinder"] == [0.0, 4.0, 8.0]


def test_the_title_is_left_of_the_plan():
    (title,) = title_shapes("office", (8.0, -5.0, 0.0), "map")
    assert title.text == "office"
    assert title.position[0] < 8.0
    assert title_shapes("", (8.0, -5.0, 0.0), "map") == []


def test_the_robot_is_drawn_in_its_own_frame():
    assert {shape.frame for shape in robot_shapes("base_link", 0.2)} == {"base_link"}


def test_packages_lie_apart_before_their_label_or_on_the_robot():
    places = [("1", "office2", False), ("2", "office2", False), ("3", "", True), ("4", "", True), ("5", "attic", False)]
    cubes = [shape for shape in package_shapes(places, LABELS, "base_link") if shape.kind == "cube"]
    assert [shape.frame for shape in cubes] == ["map", "map", "base_link", "base_link"]
    assert cubes[0].position[:2] == (4.0, 0.65)
    assert math.dist(cubes[0].position, cubes[1].position) > cubes[0].scale[0]
    assert cubes[3].position[2] - cubes[2].position[2] > cubes[2].scale[2]


def test_actions_happen_where_the_robot_was_sent_last():
    assert [step.place.name for step in steps()] == ["office2", "office3", "office3", "office2", "office2"]
    assert steps(["_action_lib(pickup,1,1)"])[0].place is None


def test_arrows_lead_from_the_robot_along_what_is_left_of_the_plan():
    assert arrows(1, (0.0, 0.0)) == [(0.0, 4.0, NEXT), (4.0, 8.0, LATER), (8.0, 4.0, LATER)]
    assert arrows(3, (8.0, 0.0)) == [(8.0, 4.0, LATER)]
    assert arrows(6, (4.0, 0.0)) == []


def test_without_a_pose_the_way_begins_where_the_robot_was_sent_last():
    assert arrows(1, None) == [(4.0, 8.0, LATER), (8.0, 4.0, LATER)]
    assert arrows(4, None) == [(8.0, 4.0, NEXT)]


def test_the_plan_in_words():
    assert plan_text(steps(), 3).splitlines() == [
        "cycle 3: plan",
        "1. move_base office2  done",
        "2. move_base office3  done",
        "3. pickup 1  now",
        "4. move_base office2",
        "5. deliver 1",
    ]
    assert plan_text([], 7) == "cycle 7: idle"


def test_long_plans_are_shown_in_part():
    plan = steps([f"_action_lib(pickup,{number},{number})" for number in range(1, 13)])
    beginning = plan_text(plan, 1).splitlines()
    assert (len(beginning), beginning[1], beginning[-1]) == (9, "1. pickup 1  now", "... 5 more")
    middle = plan_text(plan, 4).splitlines()
    assert (len(middle), middle[1], middle[-1]) == (9, "3. pickup 3  done", "... 3 more")
    end = plan_text(plan, 12).splitlines()
    assert (len(end), end[1], end[-1]) == (9, "5. pickup 5  done", "12. pickup 12  now")


def test_the_words_hang_from_their_upper_edge():
    low, high = (plan_shapes(steps(plan), 1, None, (8.0, -5.0, 0.0), "map")[0] for plan in (PLAN, []))
    assert low.position[1] < high.position[1] < -5.0
