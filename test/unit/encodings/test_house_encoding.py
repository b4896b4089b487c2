"""The house encoding with the shared delivery rules, run by the pure core."""

import pytest
from core_scripts import scripts
from delivery_scripts import deliver


@pytest.mark.slow
def test_house_rejects_unknown_things():
    deliver(
        "house",
        """
        goal 1 bring(cellar,cup); all 1 rejected; says 1 ...there is no place cellar
        goal 2 bring(f(x),cup); says 2 ...there is no place f(x); goal 3 bring(bedroom,lamp); says 3 ...there is no lamp
        goal 4 bring(bedroom,"cup"); says 4 ...there is no "cup": this is a string, write it without quotes""",
    )


STORIES = {
    "the new place of a thing is known, also after it was cancelled": """
        goal a bring(bedroom,cup); finish; drives kitchen hallway bedroom; goal b bring(study,cup); finish; drives study
        all b active succeeded; goal c bring(bedroom,tray); succeed; succeed; until pickup; succeed; cancel c; finish
        is c preempted; goal d bring(study,tray); until pickup; does pickup,tray,...; finish; is d succeeded""",
    "detour round a closed door, which is tried again later": """
        goal a bring(bedroom,newspaper); does move_base,living_room,1; fail blocked; finish
        drives living_room kitchen living_room kitchen hallway bedroom; all a active succeeded
        goal b bring(living_room,newspaper); finish; drives hallway living_room""",
    "missing thing is looked for by nobody until somebody sees it": """
        goal a bring(bedroom,cup); goal b bring(bedroom,tray); succeed; reach pickup,cup; fail not_here; finish
        all a active aborted; says a ...the cup is not at kitchen; all b active succeeded
        goal c bring(bedroom,cup); says c ...nobody knows where the cup is
        facts _seen(cup,study,now); goal d bring(bedroom,cup); finish; all d active succeeded""",
    "things that could not be put down are asked for again": """
        goal a bring(bedroom,cup); until deliver; fail failed; fail failed; fail failed
        says a ...the cup could not be put down at bedroom: failed; goal b bring(cellar,cup)
        says b ...there is no place cellar; goal c bring(study,cup); finish; all c active succeeded
        drives kitchen hallway bedroom study; goal d bring(kitchen,cup); finish; all d active succeeded""",
}  # fmt: skip


@pytest.mark.sampled(2)
@pytest.mark.slow
@scripts(STORIES)
def test_house_follows_the_script(row):
    deliver("house", row)
