"""Housekeeping with two robots: a table that needs both, and what they do when one of them fails."""

import re

import pytest
from core_driver import Driver

FILES = ("household.lp", "home.lp")


def household():
    return Driver.of_shipped(*FILES)


def under_way(driver):
    """Return the awaited actions by robot, as pairs of the kind and its parameter."""
    found = (re.fullmatch(r"_action_lib\((\w+)\((\w+)\),(\w+),\d+\)", one).groups() for one in map(str, driver.awaited))
    return {robot: (kind, what) for kind, robot, what in found}


def ends(driver, robot, value=None):
    """Let the action of a robot succeed, or return another value."""
    action = next(one for one in driver.core.awaited if str(one.interface.arguments[0]) == robot)
    return driver.facts(f"_return({action.interface},{value or action.parameter},{action.cycle})")


def until_both_hold(driver):
    """Let actions succeed until both robots carry the table to the kitchen."""
    for _ in range(20):
        acts = under_way(driver)
        if set(acts.values()) == {("move_base", "kitchen")} and len(acts) == 2:
            return driver
        ends(driver, sorted(acts)[0])
    raise AssertionError("they never carry it together")


@pytest.mark.slow
def test_household_robots_carry_the_table_together():
    driver = until_both_hold(household().goal("table", "bring(kitchen,table)"))
    ends(driver, "r1")
    assert under_way(driver) == {"r2": ("move_base", "kitchen")}
    ends(driver, "r2")
    assert {kind for kind, _ in under_way(driver).values()} == {"deliver"}
    assert driver.finish().states("table")[-1] == "succeeded"


@pytest.mark.slow
def test_household_both_let_go_if_one_fails():
    driver = until_both_hold(household().goal("table", "bring(kitchen,table)"))
    ends(driver, "r1", "blocked")
    ends(driver, "r2")
    while any(kind != "deliver" for kind, _ in under_way(driver).values()):
        ends(driver, sorted(under_way(driver))[0])
    assert set(under_way(driver)) == {"r1", "r2"}
    assert driver.finish().states("table")[-1] == "succeeded"


@pytest.mark.slow
def test_household_gives_up_after_repeated_failures():
    driver = household().goal("table", "bring(kitchen,table)")
    for _ in range(60):
        acts = under_way(driver)
        if not acts:
            break
        robot = sorted(acts)[0]
        ends(driver, robot, "failed" if acts[robot][0] == "pickup" else None)
    assert driver.states("table")[-1] == "aborted"
    assert "the robots keep failing" in driver.message("table")
