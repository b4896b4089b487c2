"""The case study of the paper (section IV): its three printed updates and Table I, through the pure core."""

import pytest
from core_driver import PLANS, Driver
from shipped import ENCODINGS, shipped

from rosoclingo.reasoning.events import PlanMade
from rosoclingo.reasoning.settings import CoreSettings

UPDATE_1 = """
#step 1.
_request(goal(office3, office2, 1), 2).
#end step.
"""
UPDATE_2 = """
#step 2.
:- not _action_lib(move_base, office2, 1).
   _return(move_base, office2, 1).
#end step.
"""
UPDATE_3 = """
#step 3.
:- not _action_lib(move_base, office3, 2).
   _request(cancel(1), 3).
   _return(move_base, office3, 2).
#end step.
"""
PLAN_1 = ["move_base,office2,1", "move_base,office3,2", "pickup,1,3", "move_base,office2,4", "deliver,1,5"]
PLAN_2 = ["move_base,office2,1", "move_base,office3,2"]
PLAN_3 = ["move_base,office2,1", "move_base,office3,2", "pickup,2,4", "move_base,office4,5", "deliver,2,6"]


@pytest.fixture(params=[(names, plan) for names in ("paper.lp", "mailbot.lp office.lp") for plan in sorted(PLANS)])
def mailbot(request):
    """Either program, with either setting of ``~plan``."""
    names, plan = request.param
    return Driver(settings=CoreSettings(), program=shipped(*names.split()), solver=PLANS[plan])


@pytest.fixture
def talking_mailbot():
    """The one that says by _status what has become of goals."""
    return Driver.of_shipped("mailbot.lp", "office.lp")


def test_the_paper_in_one_file_is_short_and_needs_no_other():
    text = (ENCODINGS / "paper.lp").read_text()
    assert len(text.splitlines()) <= 60
    assert "#include" not in text


def squeezed(text):
    return "".join(text.split())


def plan(driver):
    return [str(action.atom)[len("_action_lib(") : -1] for action in driver.core.plan.actions]


def test_nothing_to_do_at_first(mailbot):
    assert mailbot.core.plan.actions == ()
    assert mailbot.core.cycle == 1
    assert mailbot.journal.updates == []


@pytest.mark.mostly_slow
def test_the_case_study(mailbot):
    mailbot.goal("first", "goal(office3,office2,1)")
    assert plan(mailbot) == PLAN_1
    mailbot.succeed()
    assert plan(mailbot) == PLAN_1
    mailbot.cancel("first")
    assert mailbot.states("first") == ["active", "preempting"]
    mailbot.succeed()
    assert plan(mailbot) == PLAN_2
    assert mailbot.states("first") == ["active", "preempting", "preempted"]
    assert mailbot.awaited == []
    mailbot.goal("second", "goal(office3,office4,2)")
    assert plan(mailbot) == PLAN_3
    mailbot.finish()
    assert plan(mailbot) == PLAN_3
    assert mailbot.states("second") == ["active", "succeeded"]

    assert [squeezed(text) for text in mailbot.journal.updates[:3]] == [
        squeezed(text) for text in (UPDATE_1, UPDATE_2, UPDATE_3)
    ]
    assert squeezed(mailbot.journal.updates[3]) == "#step4._request(goal(office3,office4,2),5).#endstep."
    assert mailbot.journal.actions == [f"_action_lib({action})" for action in PLAN_3]
    assert mailbot.journal.problems == []


def test_horizon_is_that_of_the_shortest_plan(mailbot):
    mailbot.goal("first", "goal(office3,office2,1)")
    assert mailbot.journal.of(PlanMade)[-1].horizon == 5


def test_cancel_after_pickup_takes_the_package_back(mailbot):
    mailbot.goal("first", "goal(office3,office2,1)").succeed().succeed().succeed()
    assert mailbot.awaited == ["_action_lib(move_base,office2,4)"]
    mailbot.cancel("first").finish()
    assert mailbot.journal.actions[-1] == "_action_lib(deliver,1,6)"
    assert mailbot.journal.actions[-2] == "_action_lib(move_base,office3,5)"
    assert mailbot.states("first") == ["active", "preempting", "preempted"]


def test_cancel_while_delivering_comes_too_late(talking_mailbot):
    talking_mailbot.goal("first", "goal(office3,office2,1)")
    for _ in range(4):
        talking_mailbot.succeed()
    assert talking_mailbot.awaited == ["_action_lib(deliver,1,5)"]
    talking_mailbot.cancel("first").finish()
    assert talking_mailbot.states("first")[-1] == "succeeded"


def test_failed_action_is_tried_again(mailbot):
    mailbot.goal("first", "goal(office2,office1,1)").facts("_return(move_base,failed,1)")
    assert mailbot.awaited == ["_action_lib(move_base,office2,2)"]
    assert mailbot.finish().states("first") == ["active", "succeeded"]


def test_unknown_office_is_rejected_and_the_rest_unharmed(talking_mailbot):
    talking_mailbot.core.add_goal("bad", "goal(office9,office2,1)")
    talking_mailbot.goal("good", "goal(office2,office1,2)").finish()
    assert talking_mailbot.states("bad") == ["rejected"]
    assert "goal(office9,office2,1)" in talking_mailbot.message("bad")
    assert talking_mailbot.states("good") == ["active", "succeeded"]


@pytest.mark.slow
def test_five_requests_with_capacity_three(mailbot):
    for number in range(1, 6):
        mailbot.core.add_goal(str(number), f"goal(office{number % 4 + 1},office{(number + 1) % 4 + 1},{number})")
    mailbot.run().finish()
    carried = most = 0
    for action in mailbot.journal.actions:
        carried += ("pickup" in action) - ("deliver" in action)
        most = max(most, carried)
    assert carried == 0
    assert most <= 3
    assert all(mailbot.states(str(number)) == ["active", "succeeded"] for number in range(1, 6))


def test_a_goal_that_the_program_does_not_know_is_rejected(talking_mailbot):
    talking_mailbot.goal("odd", "dance(98)").goal("first", "goal(office1,office2,1)").finish()
    assert talking_mailbot.message("odd").startswith("no rule of the program can see dance(98)")
    assert talking_mailbot.states("first")[-1] == "succeeded"
