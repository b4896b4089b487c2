"""The model of a fleet: it refuses collisions and actions without their package."""

import pytest
from deliveries import Request, row
from fleet_world import FleetWorld
from planning_domains.task import RuleError


def world(room=1, **starts):
    """Return a row of four offices with a package from office 1 to office 2."""
    found = FleetWorld(row(4), starts, room)
    found.ask([Request(1, 1, 2)])
    return found


@pytest.mark.parametrize(
    ("starts", "begun", "action", "fault"),
    [
        ({"r1": 1, "r2": 2}, [], ("r1", "move_base", 2), "r2 hold it"),
        ({"r1": 1, "r2": 2}, [("r2", "move_base", 3)], ("r1", "move_base", 2), "r2 hold it"),
        ({"r1": 1, "r2": 3}, [("r2", "move_base", 2)], ("r1", "move_base", 2), "r2 hold it"),
        ({"r1": 1}, [], ("r1", "move_base", 3), "no corridor leads there"),
        ({"r1": 1}, [("r1", "move_base", 2)], ("r1", "pickup", 1), "it still has to move_base 2"),
        ({"r1": 2}, [], ("r1", "pickup", 1), "it does not wait there"),
        ({"r1": 2}, [], ("r1", "deliver", 1), "it is not on board"),
    ],
)
def test_fleet_world_refuses_impossible_actions(starts, begun, action, fault):
    fleet = world(**starts)
    for one in begun:
        fleet.begin(*one)
    with pytest.raises(RuleError, match=fault):
        fleet.begin(*action)


def test_fleet_world_robots_do_not_meet_on_a_connection():
    fleet = world(room=2, r1=1, r2=2)
    fleet.begin("r2", "move_base", 1)
    with pytest.raises(RuleError, match="it meets r2"):
        fleet.begin("r1", "move_base", 2)


def test_fleet_world_robot_between_offices_holds_both():
    fleet = world(r1=1)
    fleet.begin("r1", "move_base", 2)
    fleet.fail("r1")
    assert fleet.holders(1) == fleet.holders(2) == {"r1"}
    with pytest.raises(RuleError, match="between two offices"):
        fleet.begin("r1", "pickup", 1)
    fleet.begin("r1", "move_base", 1)
    fleet.end("r1")
    assert not fleet.holders(2)
    fleet.begin("r1", "pickup", 1)


def test_fleet_world_packages_arrive_at_their_ends():
    fleet = world(r1=1)
    for verb, what in (("pickup", 1), ("move_base", 2), ("deliver", 1)):
        assert fleet.begin("r1", verb, what) > 0.0
        fleet.end("r1")
    assert (fleet.delivered, fleet.open) == ([1], 0)
