"""Verification of the shipped programs."""

import lint_programs
import pytest
from shipped import ENCODINGS, shipped
from workloads import sized

from rosoclingo.checking.verifying.likely_events import likely_repertory
from rosoclingo.checking.verifying.scope import EventSelection, VerifyLimits
from rosoclingo.checking.verifying.verification import verify
from rosoclingo.oclingo import ReactiveProgram, parse_term


@pytest.mark.slow
@pytest.mark.parametrize("name", ["paper", "garden", "template"])
def test_verify_finds_small_programs_clean(name):
    limits = VerifyLimits(events=2, steps=12)
    verdict = verify(ReactiveProgram(lint_programs.program(name)), EventSelection(most=1), limits, seconds=300)
    assert verdict.clean, verdict.text()


@pytest.mark.sampled(1)
@pytest.mark.slow
@pytest.mark.parametrize("files", [("mailbot.lp", "office.lp"), ("house.lp", "home.lp")], ids=["office", "house"])
def test_verify_finds_delivery_programs_clean(files):
    verdict = verify(shipped(*files), EventSelection(most=1), VerifyLimits(events=1, steps=20), seconds=300)
    assert verdict.clean, verdict.text()


def test_likely_events_of_the_house_lead_to_actions():
    """The things to bring are known from other atoms in the rules for requests."""
    found = likely_repertory(shipped("house.lp", "home.lp"), EventSelection(most=1))
    assert [*map(str, found.goals)] == ["bring(study,cup)"]
    assert set(found.reasons) == {"move_base", "pickup", "deliver"}
    assert "_seen(cup,study,1)" in map(str, found.facts)


@pytest.mark.slow
@pytest.mark.parametrize("fact", sized(["_aboard"], ["_aboard", "_off"]))
def test_verify_accepts_late_corrections_of_the_mailbot(fact):
    """For example, a package is reported aboard for a cycle before it was picked up."""
    files = [ENCODINGS / "mailbot.lp", lint_programs.DATA / "two_offices.lp"]
    program = ReactiveProgram.from_files(files, {"_told": "1"})
    selection = EventSelection((parse_term("goal(office2,office1,1)"),), (fact,), most=1)
    limits = VerifyLimits(events=2, together=1, steps=12, early=0)
    verdict = verify(program, selection, limits, seconds=300)
    assert verdict.clean, verdict.text()
