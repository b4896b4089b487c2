"""The office's packages: the effects of picking up and putting down; no package is ever lost or duplicated."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rosoclingo.common.reading import Reader
from rosoclingo.robot.simulation import office_packages as packages
from rosoclingo.robot.simulation.office_packages import PackageError, PackageOffice

OFFICES = ("office1", "office2", "office3", "office4")


def office_of(packages, **options):
    """Return an office with packages as a parameter gives them."""
    found, reader = PackageOffice(OFFICES, **options), Reader(packages, "packages")
    found.read(reader)
    reader.check(PackageError)
    return found


def office(**options):
    return office_of({"office3": [1, 2], "office1": [10]}, **options)


@pytest.mark.parametrize(
    ("verb", "package", "robot_at", "outcome", "message"),
    [
        ("pickup", "1", None, packages.NOT_AT_LABEL, "the robot is at no known location"),
        ("pickup", "4", "office3", packages.UNKNOWN_PACKAGE, "there is no package 4"),
        ("pickup", "1", "office2", packages.NOT_HERE, "package 1 is at office3, the robot at office2"),
        ("pickup", "10", "office1", packages.NOT_HERE, "the robot carries package 10 already"),
        ("deliver", "1", "office3", packages.NOT_CARRIED, "the robot does not carry package 1, it lies at office3"),
    ],
)
def test_packages_act_fails_with_reason_and_moves_nothing(verb, package, robot_at, outcome, message):
    world = office()
    world.pickup("10", "office1")
    before = world.places
    result = getattr(world, verb)(package, robot_at)
    assert (result.outcome, result.message) == (outcome, message)
    assert result.location == (robot_at or "")
    assert not result.succeeded
    assert world.places == before


def test_packages_of_several_robots_are_apart():
    world = office_of({"office1": [1, 2, 3, 4]})
    assert [world.pickup(one, "office1", "r1").outcome for one in "1234"] == [0, 0, 0, packages.FULL]
    assert world.pickup("4", "office1", "r2").succeeded
    assert world.pickup("1", "office1", "r2")[:2] == (packages.NOT_HERE, "robot r1 carries package 1 already")
    wrong = world.deliver("1", "office2", "r2")
    assert wrong[:2] == (packages.NOT_CARRIED, "the robot does not carry package 1, robot r1 carries it")
    assert (world.carried_by("r1"), world.carried_by("r2")) == (["1", "2", "3"], ["4"])
    heir, reader = PackageOffice(OFFICES), Reader({"r1": ["1", "2", "3"], "r2": ["4"]})
    heir.read(Reader({}), reader)
    assert heir.places == world.places
    world.put("1", "office4")
    world.remove("2")
    assert [place.package for place in world.places if not place.carried] == ["1"]


def test_packages_unknown_before_can_appear():
    assert office(appear=True).pickup("4", "office2").succeeded
    assert office(appear=True).pickup("4", None).outcome == packages.NOT_AT_LABEL
    assert office(appear=True).deliver("4", "office2").outcome == packages.UNKNOWN_PACKAGE


@pytest.mark.parametrize(
    ("act", "fault"),
    [
        (
            lambda: office_of({"cellar": [1]}),
            r"packages.cellar\[0\]: package 1: no label cellar; known labels: office1",
        ),
        (lambda: office_of({"office1": 3}), "packages.office1: must be a list of packages, not 3"),
        (lambda: office_of({"office1": [3, 3]}), r"packages.office1\[1\]: package 3 is listed twice"),
        (lambda: office().put("", "office1"), "needs an identifier"),
        (lambda: office().remove("4"), "there is no package 4"),
    ],
)
def test_packages_refuse_impossible_changes(act, fault):
    with pytest.raises(PackageError, match=fault):
        act()


COMMANDS = st.tuples(
    st.sampled_from(["pickup", "deliver"]),
    st.sampled_from(["1", "2", "3", "4", "5"]),
    st.sampled_from([None, *OFFICES]),
)


@given(st.lists(COMMANDS, max_size=40))
def test_packages_are_never_lost_and_restored_in_their_places(commands):
    world = office_of({"office1": [1, 2, 3, 4]})
    for verb, package, robot_at in commands:
        before = {place.package: place for place in world.places}
        result = getattr(world, verb)(package, robot_at)
        after = {place.package: place for place in world.places}
        assert set(after) == set(before) == {"1", "2", "3", "4"}
        assert len(world.carried_by("")) <= 3
        changed = [name for name in after if after[name] != before[name]]
        assert changed == ([package] if result.succeeded else [])
        if result.succeeded:
            assert after[package].carried == (verb == "pickup")
            assert robot_at == (before if verb == "pickup" else after)[package].location
    heir, reader = PackageOffice(OFFICES), Reader({"lying": world.lying, "carried": world.carried_by("")})
    heir.read(reader.at("lying"), reader.at("carried"))
    reader.check(PackageError)
    assert heir.places == world.places
