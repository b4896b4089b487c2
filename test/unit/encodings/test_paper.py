"""The case study of the paper (section IV): its three printed updates and Table I, run by the pure core."""

import pytest
from core_driver import PLANS
from core_scripts import play
from delivery_scripts import Delivery
from shipped import ENCODINGS

from rosoclingo.reasoning.events import PlanMade

UPDATES = """
#step 1.
_request(goal(office3, office2, 1), 2).
#end step.

#step 2.
:- not _action_lib(move_base, office2, 1).
   _return(move_base, office2, 1).
#end step.

#step 3.
:- not _action_lib(move_base, office3, 2).
   _request(cancel(1), 3).
   _return(move_base, office3, 2).
#end step.
"""
PLAN_1 = ["move_base,office2,1", "move_base,office3,2", "pickup,1,3", "move_base,office2,4", "deliver,1,5"]
PLAN_2 = ["move_base,office2,1", "move_base,office3,2"]
PLAN_3 = ["move_base,office2,1", "move_base,office3,2", "pickup,2,4", "move_base,office4,5", "deliver,2,6"]


@pytest.fixture(params=[(name, plan) for name in ("paper", "mailbot") for plan in sorted(PLANS)])
def mailbot(request):
    """Return either program, with either setting of ``~plan``."""
    name, plan = request.param
    return Delivery(name, solver=PLANS[plan])


def test_paper_encoding_is_one_short_file():
    text = (ENCODINGS / "paper.lp").read_text()
    assert len(text.splitlines()) <= 60
    assert "#include" not in text


def squeezed(text):
    return "".join(text.split())


def plan(driver):
    return [str(action.atom)[len("_action_lib(") : -1] for action in driver.core.plan.actions]


@pytest.mark.mostly_slow
def test_paper_case_study_has_its_published_plans(mailbot):
    assert (plan(mailbot), mailbot.core.cycle, mailbot.journal.updates) == ([], 1, [])
    mailbot.goal("first", "goal(office3,office2,1)")
    assert plan(mailbot) == PLAN_1
    assert mailbot.journal.of(PlanMade)[-1].horizon == 5
    mailbot.succeed()
    assert plan(mailbot) == PLAN_1
    play(mailbot, "cancel first; all first active preempting; succeed; all first active preempting preempted; does")
    assert plan(mailbot) == PLAN_2
    mailbot.goal("second", "goal(office3,office4,2)")
    assert plan(mailbot) == PLAN_3
    play(mailbot, f"finish; all second active succeeded; done {' '.join(PLAN_3)}; problems 0")
    assert plan(mailbot) == PLAN_3
    assert squeezed("".join(mailbot.journal.updates[:3])) == squeezed(UPDATES)
    assert squeezed(mailbot.journal.updates[3]) == "#step4._request(goal(office3,office4,2),5).#endstep."


@pytest.mark.sampled(2)
@pytest.mark.slow
def test_paper_example_handles_cancels_and_failures(mailbot):
    """A package on the robot is returned, and a failed action is tried again."""
    play(
        mailbot,
        """
        goal a goal(office3,office2,1); succeed; succeed; succeed; does move_base,office2,4; cancel a; finish
        acts move_base,office2 move_base,office3 pickup,1 move_base,office2 move_base,office3 deliver,1
        all a active preempting preempted; goal b goal(office2,office1,2); does move_base,office2,8; fail failed
        does move_base,office2,9; finish; all b active succeeded""",
    )
