"""What people correct of the robot's world: where it is, what is on it, where things lie."""

import pytest
from core_driver import Driver
from shipped import shipped

from rosoclingo.reasoning.events import ActionsPreempted
from rosoclingo.reasoning.settings import CoreSettings


@pytest.fixture
def mailbot():
    return Driver.of_shipped("mailbot.lp", "office.lp")


@pytest.fixture
def house():
    return Driver.of_shipped("house.lp", "home.lp")


def done(driver, since=0):
    """The actions that went out, without their cycles."""
    return [text[len("_action_lib(") :].rpartition(",")[0] for text in driver.journal.actions[since:]]


@pytest.mark.parametrize("name", ["_at", "_aboard", "_off"])
def test_what_is_told_now_counts_for_the_next_action(name):
    assert shipped("mailbot.lp", "office.lp").delay_of(name, 2) == 1
    assert shipped("house.lp", "home.lp").delay_of("_lies", 3) == 1


def test_a_plan_begins_where_the_robot_is_said_to_be(mailbot):
    mailbot.facts("_at(office4,now)").goal("key", "goal(office3,office4,1)").finish()
    assert done(mailbot) == ["move_base,office3", "pickup,1", "move_base,office4", "deliver,1"]
    assert mailbot.states("key") == ["active", "succeeded"]
    assert mailbot.problems == []


def test_a_robot_that_is_carried_away_under_way_plans_from_there(mailbot):
    mailbot.goal("key", "goal(office3,office4,1)").facts("_at(office4,now)")
    assert mailbot.awaited == ["_action_lib(move_base,office2,1)"], "what is under way ends first"
    mailbot.finish()
    assert done(mailbot, 1) == ["move_base,office3", "pickup,1", "move_base,office4", "deliver,1"]


@pytest.mark.slow
def test_a_robot_that_was_not_where_it_should_be_may_act_where_it_is_said_to_be(mailbot):
    mailbot.goal("key", "goal(office1,office2,1)").fail("not_at_label")
    mailbot.fail("failed").facts("_at(office1,now)")
    mailbot.finish()
    assert mailbot.states("key") == ["active", "succeeded"]


def test_where_it_was_is_told_late(mailbot):
    """The robot went on to a place since, so that is where it is: nothing that was done is denied."""
    mailbot.goal("key", "goal(office3,office4,1)").succeed().succeed().succeed()
    mailbot.facts("_at(office4,1)").finish()
    assert mailbot.states("key") == ["active", "succeeded"]
    assert done(mailbot, 4) == ["deliver,1"]
    assert mailbot.problems == []


@pytest.mark.slow
def test_where_it_cannot_have_been_denies_nothing_that_was_done(mailbot):
    """It went on to a place since, so that is where it is."""
    mailbot.goal("key", "goal(office3,office4,1)").succeed().succeed().succeed()
    mailbot.facts("_at(office2,2)").finish()
    assert mailbot.states("key") == ["active", "succeeded"]
    assert mailbot.problems == []
    assert done(mailbot, 4) == ["deliver,1"]


def test_what_is_said_to_be_aboard_is_delivered(mailbot):
    mailbot.goal("key", "goal(office3,office2,1)").facts("_aboard(1,now)").finish()
    assert done(mailbot) == ["move_base,office2", "deliver,1"]
    assert mailbot.states("key") == ["active", "succeeded"]


def test_what_nobody_asked_for_stays_aboard_until_it_is_asked_for(mailbot):
    mailbot.facts("_aboard(1,now)", "_at(office2,now)")
    mailbot.goal("wrong", "goal(office3,office4,1)")
    assert mailbot.message("wrong").endswith("package 1 is on the robot, which picked it up at office2")
    mailbot.goal("key", "goal(office2,office3,1)").finish()
    assert done(mailbot) == ["move_base,office3", "deliver,1"]


@pytest.mark.slow
def test_it_takes_its_room(mailbot):
    mailbot.facts("_aboard(1,now)", "_aboard(2,now)", "_aboard(3,now)").goal("key", "goal(office1,office2,4)")
    assert "the robot is full of what it could not put down since _aboard(1,1) was told" in mailbot.message("key")
    mailbot.facts("_off(2,now)").goal("again", "goal(office1,office2,4)").finish()
    assert mailbot.states("again") == ["active", "succeeded"]


def test_what_was_taken_off_and_lies_elsewhere_is_fetched_there(mailbot):
    mailbot.goal("key", "goal(office1,office4,1)").succeed()
    mailbot.facts("_lies(1,office1,now)").finish()
    assert done(mailbot, 2) == [
        "move_base,office1",
        "pickup,1",
        "move_base,office2",
        "move_base,office3",
        "move_base,office4",
        "deliver,1",
    ]
    assert mailbot.states("key") == ["active", "succeeded"]


def test_what_waits_elsewhere_is_fetched_there(mailbot):
    mailbot.goal("key", "goal(office3,office4,1)").facts("_lies(1,office2,now)").finish()
    assert done(mailbot) == ["move_base,office2", "pickup,1", "move_base,office3", "move_base,office4", "deliver,1"]


@pytest.mark.slow
def test_what_was_taken_off_and_is_nowhere_is_given_up(mailbot):
    mailbot.goal("key", "goal(office1,office4,1)").goal("other", "goal(office2,office3,2)").succeed()
    mailbot.facts("_off(1,now)").finish()
    assert mailbot.states("key") == ["active", "aborted"]
    assert mailbot.message("key").endswith("package 1 is not on the robot")
    assert mailbot.states("other") == ["active", "succeeded"]
    assert mailbot.goal("again", "goal(office3,office4,1)").finish().states("again") == ["active", "succeeded"]


def test_what_was_picked_up_and_taken_off_at_once(mailbot):
    mailbot.goal("key", "goal(office1,office4,1)").facts("_off(1,now)").finish()
    assert mailbot.states("key") == ["active", "aborted"]
    assert mailbot.problems == []


def test_what_waits_is_not_on_the_robot_anyway(mailbot):
    mailbot.goal("key", "goal(office3,office4,1)").facts("_off(1,now)").finish()
    assert mailbot.states("key") == ["active", "succeeded"]


def test_a_cancelled_request_whose_package_was_taken_off_has_ended(mailbot):
    mailbot.goal("key", "goal(office1,office4,1)").succeed().cancel("key")
    mailbot.facts("_lies(1,office3,now)").finish()
    assert mailbot.states("key")[-1] == "preempted"
    assert "deliver" not in " ".join(mailbot.journal.actions)


@pytest.mark.parametrize(
    ("fact", "why"),
    [
        ("_at(cellar,now)", "there is no place cellar"),
        ("_lies(1,cellar,now)", "there is no place cellar"),
    ],
)
def test_a_place_that_there_is_not_is_refused(mailbot, fact, why):
    mailbot.goal("key", "goal(office3,office4,1)").facts(fact).finish()
    assert mailbot.states("key") == ["active", "succeeded"]
    (problem,) = mailbot.problems
    assert f"'{fact}' from 'interface' is ignored: {why}" in problem


@pytest.mark.mostly_slow
@pytest.mark.parametrize(
    "facts",
    [
        ("_at(office2,now)", "_at(office4,now)"),
        ("_aboard(1,now)", "_off(1,now)"),
        ("_lies(1,office1,now)", "_lies(1,office2,now)"),
        ("_aboard(1,now)", "_lies(1,office2,now)"),
    ],
)
def test_who_is_said_to_be_in_two_places_at_once_has_been_told_nothing(mailbot, facts):
    mailbot.goal("key", "goal(office3,office4,1)").facts(*facts).finish()
    assert len(mailbot.problems) == 2
    assert all("to be in two places" in problem for problem in mailbot.problems)
    assert done(mailbot) == ["move_base,office2", "move_base,office3", "pickup,1", "move_base,office4", "deliver,1"]


@pytest.mark.slow
def test_things_of_the_house(house):
    house.facts("_lies(cup,study,now)", "_at(bedroom,now)").goal("key", "bring(hallway,cup)").finish()
    assert done(house) == ["move_base,study", "pickup,cup", "move_base,hallway", "deliver,cup"]
    house.facts("_aboard(tray,now)").goal("second", "bring(kitchen,tray)").finish()
    assert done(house, 4) == ["move_base,kitchen", "deliver,tray"]
    house.facts("_off(book,now)").goal("third", "bring(kitchen,book)")
    assert house.states("third")[0] == "active", "it was not on the robot anyway"
    assert house.finish().states("third") == ["active", "succeeded"]


@pytest.mark.slow
def test_a_thing_that_was_taken_off_by_hand(house):
    house.goal("key", "bring(bedroom,cup)").until("deliver")
    house.facts(f"_return(deliver,not_carried,{house.core.cycle})", "_lies(cup,bathroom,now)").finish()
    assert house.states("key") == ["active", "succeeded"]
    assert "move_base,bathroom" in done(house)


def test_with_preempt_what_is_under_way_in_vain_is_ended():
    mailbot = Driver(settings=CoreSettings(preempt=True), program=shipped("mailbot.lp", "office.lp"))
    mailbot.goal("key", "goal(office3,office4,1)").facts("_at(office4,now)")
    (preempted,) = mailbot.journal.of(ActionsPreempted)
    assert [str(action.atom) for action in preempted.actions] == ["_action_lib(move_base,office2,1)"]
    mailbot.fail("preempted").finish()
    assert done(mailbot, 1) == ["move_base,office3", "pickup,1", "move_base,office4", "deliver,1"]
