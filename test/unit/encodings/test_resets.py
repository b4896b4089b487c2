"""Corrections of the robot's world by people: its position, its load, and places of things."""

import pytest
from core_scripts import scripts
from delivery_scripts import deliver

DETOUR = "acts move_base,office2 move_base,office3 pickup,1 move_base,office4 deliver,1"
FROM_4 = "acts move_base,office3 pickup,1 move_base,office4 deliver,1"


CORRECTIONS = {
    "plan begins where the robot is said to be": f"""
        facts _at(office4,now); goal a goal(office3,office4,1); finish; {FROM_4}; all a active succeeded; problems 0""",
    **{f"{fact} arrives late, after further steps": f"""
        goal a goal(office3,office4,1); succeed; succeed; succeed; facts {fact}; finish; all a active succeeded
        acts move_base,office2 move_base,office3 pickup,1 move_base,office4 deliver,1; problems 0"""
       for fact in ("_at(office4,1)", "_at(office2,2)")},
    "thing that is said to be aboard is delivered": """
        goal a goal(office3,office2,1); facts _aboard(1,now); finish; acts move_base,office2 deliver,1
        all a active succeeded""",
    "thing that nobody asked for stays aboard until it is asked for": """
        facts _aboard(1,now) _at(office2,now); goal wrong goal(office3,office4,1)
        says wrong ...package 1 is on the robot, which picked it up at office2; goal a goal(office2,office3,1); finish
        acts move_base,office3 deliver,1""",
    "thing that was taken off and lies elsewhere is fetched there": """
        goal a goal(office1,office4,1); succeed; acts pickup,1 move_base,office2; facts _lies(1,office1,now); finish
        acts move_base,office1 pickup,1 move_base,office2 move_base,office3 move_base,office4 deliver,1
        all a active succeeded""",
    "places that there are not are refused": f"""
        goal a goal(office3,office4,1); facts _at(cellar,now) _lies(1,cellar,now); finish; {DETOUR}; problems 2
        problem '_at(cellar,now)' from 'interface' is ignored: there is no place cellar...
        problem '_lies(1,cellar,now)' from 'interface' is ignored: there is no place cellar...""",
}  # fmt: skip
SLOW_CORRECTIONS = {
    **{f"two places at once: {facts}": f"""
        goal a goal(office3,office4,1); facts {facts}; finish; problems 2; problem ...is reported at two places...
        {DETOUR}"""
       for facts in ("_lies(1,office1,now) _lies(1,office2,now)", "_at(office2,now) _at(office4,now)")},
    "things aboard take their room": """
        facts _aboard(1,now) _aboard(2,now) _aboard(3,now); goal a goal(office1,office2,4)
        says a ...the robot is full of things that it could not put down since _aboard(1,1) was reported...
        facts _off(2,now); goal b goal(office1,office2,4); finish; all b active succeeded""",
}  # fmt: skip


@pytest.mark.sampled(6)
@pytest.mark.slow
@scripts(CORRECTIONS, SLOW_CORRECTIONS)
def test_correction_follows_the_script(row):
    deliver("mailbot", row)
