"""The house encoding on the shared rules of delivery, through the pure core."""

from pathlib import Path

import pytest
from core_driver import Driver

ENCODINGS = Path(__file__).resolve().parents[2] / "encodings"


@pytest.fixture
def house():
    return Driver.from_files(ENCODINGS / "house.lp", ENCODINGS / "home.lp")


def moves(driver):
    return [action.split(",")[1] for action in driver.journal.actions if "move_base" in action]


def test_things_are_brought_and_their_new_place_is_known(house):
    house.goal("first", "bring(bedroom,cup)").finish()
    assert moves(house) == ["kitchen", "hallway", "bedroom"]
    house.goal("second", "bring(study,cup)").finish()
    assert moves(house)[3:] == ["study"]
    assert house.states("second") == ["active", "succeeded"]


def test_a_detour_round_a_closed_door(house):
    house.goal("first", "bring(bedroom,newspaper)")
    assert house.awaited == ["_action_lib(move_base,living_room,1)"]
    house.facts("_return(move_base,blocked,1)").finish()
    assert moves(house) == ["living_room", "kitchen", "living_room", "kitchen", "hallway", "bedroom"]
    assert house.states("first") == ["active", "succeeded"]


def test_the_way_is_tried_again_later(house):
    house.goal("first", "bring(bedroom,newspaper)").facts("_return(move_base,blocked,1)").finish()
    house.goal("second", "bring(living_room,newspaper)").finish()
    assert moves(house)[-2:] == ["hallway", "living_room"]


def test_a_door_that_is_seen_open_is_used_again(house):
    house.facts("_blocked(hallway,living_room,1)", "_opened(living_room,hallway,2)")
    house.goal("first", "bring(bedroom,newspaper)").finish()
    assert moves(house) == ["living_room", "hallway", "bedroom"]


@pytest.mark.parametrize("place", ["cellar", "f(x)"])
def test_a_place_that_there_is_not_is_rejected(house, place):
    house.goal("bad", f"bring({place},cup)")
    assert house.states("bad") == ["rejected"]
    assert house.message("bad").endswith(f"there is no place {place}")


def test_a_thing_that_there_is_not_is_rejected(house):
    house.goal("bad", "bring(bedroom,lamp)")
    assert house.message("bad").endswith("there is no lamp")


def test_a_missing_thing_is_looked_for_by_nobody_until_somebody_sees_it(house):
    house.goal("first", "bring(bedroom,cup)").goal("other", "bring(bedroom,tray)").succeed()
    while "pickup,cup" not in house.awaited[0]:
        house.succeed()
    cycle = house.core.cycle
    house.facts(f"_return(pickup,not_here,{cycle})").finish()
    assert house.states("first") == ["active", "aborted"]
    assert house.message("first").endswith("the cup is not at kitchen")
    assert house.states("other") == ["active", "succeeded"]
    house.goal("again", "bring(bedroom,cup)")
    assert house.message("again").endswith("nobody knows where the cup is")
    house.facts(f"_seen(cup,study,{house.core.cycle})")
    house.goal("third", "bring(bedroom,cup)").finish()
    assert house.states("third") == ["active", "succeeded"]


def test_cancelled_after_the_pickup_it_goes_back(house):
    house.goal("first", "bring(bedroom,cup)").succeed().succeed()
    house.cancel("first").finish()
    assert house.states("first")[-1] == "preempted"
    house.goal("second", "bring(study,cup)").finish()
    assert "pickup" in house.journal.actions[-4]
    assert house.states("second") == ["active", "succeeded"]
