"""Locations of robot and things, as the program shows them."""

import pytest

from rosoclingo.runs.believed_places import believed_places
from rosoclingo.runs.drawing import DrawingKind, Drawings

LABELS = frozenset({"kitchen", "hall"})
DRAWN = Drawings({"me": (DrawingKind.ROBOT, ""), "on": (DrawingKind.THING, ""), "has": (DrawingKind.CARRIED, "")})


@pytest.mark.parametrize(
    ("atoms", "robot", "things"),
    [
        (["at(kitchen,now)"], "kitchen", {}),
        (["robot_at(hall)"], "hall", {}),
        (["at(robot,hall,now)", "at(cup,kitchen,now)"], "hall", {"cup": "kitchen"}),
        (["at(kitchen,cup,now)"], "", {"cup": "kitchen"}),
        (["robot_at(r1,hall,now)"], "hall", {}),
        (["thing_at(1,hall,now)", "carries(2,now)", "holding(3)", "carried(4,now)"], "", {"1": "hall"}),
        (["near(kitchen)", "at(", "at(now)", "((", "at"], "", {}),
        ([], "", {}),
    ],
)
def test_places_are_read_by_the_usual_names(atoms, robot, things):
    found = believed_places(atoms, Drawings(), LABELS)
    carried = dict.fromkeys("234", "carried") if "holding(3)" in atoms else {}
    assert found == (robot, {**things, **carried}, {})


def test_places_are_read_as_the_program_declares():
    atoms = ["me(hall,now)", "on(cup,kitchen,now)", "has(mug,now)", "at(x,y,now)", "me(attic)"]
    assert believed_places(atoms, DRAWN, LABELS) == ("hall", {"cup": "kitchen", "mug": "carried"}, {})
    atoms = ["me(r1,hall,now)", "me(r2,kitchen,now)", "has(r1,mug,now)", "on(cup,kitchen,now)"]
    things, robots = {"cup": "kitchen", "mug": "r1"}, {"r1": "hall", "r2": "kitchen"}
    assert believed_places(atoms, DRAWN, LABELS) == ("", things, robots), "several robots have names"
