"""Verification of the shipped programs, and of an early delivery encoding with known defects."""

import lint_programs
import pytest
from shipped import ENCODINGS, shipped
from verified_programs import play
from workloads import sized

from rosoclingo.checking.verifying import verification
from rosoclingo.checking.verifying.scope import DefectKind, EventSelection, VerifyLimits
from rosoclingo.checking.verifying.verification import verify
from rosoclingo.oclingo import ReactiveProgram, parse_term
from rosoclingo.oclingo.program.sources import Source

FIRST = lint_programs.DATA / "first_delivery"
THREE_OFFICES = """#program base.
office(office1). office(office2). office(office3). start(office1).
corridor(office1,office2). corridor(office2,office3)."""
#: The robot starts at the package, so that runs are shorter and have fewer places for events.
NEAR = THREE_OFFICES.replace("start(office1)", "start(office3)")
TWO_OFFICES = "#program base. office(office1). office(office2). start(office1). corridor(office1,office2)."


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


def on_a_small_floor(folder, facts, events, skipped=frozenset(), floor=THREE_OFFICES, steps=12):
    """Verify a mailbot with one goal on a floor, with at most one event between updates."""
    sources = [Source.from_file(folder / "mailbot.lp"), Source("floor", floor)]
    program = ReactiveProgram(sources, {} if folder == FIRST else {"_told": "1"})
    goal = parse_term(f"goal(office{2 if floor == TWO_OFFICES else 3},office1,1)")
    limits = VerifyLimits(events=events, together=1, steps=steps, early=0)
    return program, verify(program, EventSelection((goal,), facts, most=1), limits, 300, skipped)


@pytest.mark.slow
@pytest.mark.parametrize("fact", sized(["_aboard"], ["_aboard", "_off"]))
def test_verify_accepts_late_corrections_of_the_mailbot(fact):
    """For example, a package is reported aboard for a cycle before it was picked up."""
    _, verdict = on_a_small_floor(ENCODINGS, (fact,), 2, floor=sized(TWO_OFFICES, THREE_OFFICES))
    assert verdict.clean, verdict.text()


@pytest.mark.sampled(1)
@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "facts", "events", "word", "floor"),
    [
        (DefectKind.NO_ANSWER, ("_blocked",), 2, "_blocked(office1,office2,", TWO_OFFICES),
        (DefectKind.FAILURE_AS_SUCCESS, ("none",), 2, "_return(", TWO_OFFICES),
        (DefectKind.REPEATED, ("none",), 3, "_action_lib(pickup,1,", sized(NEAR, THREE_OFFICES)),
    ],
    ids=["late_blocked", "failure_taken_for_success", "sent_again"],
)
def test_verify_finds_defects_of_the_early_delivery(kind, facts, events, word, floor, monkeypatch):
    if floor == NEAR:  # to limit the time: with three events, only the failure reason that matters
        likely, reasons = verification.likely_repertory, {"move_base": (parse_term("blocked"),)}
        monkeypatch.setattr(verification, "likely_repertory", lambda *one: likely(*one)._replace(reasons=reasons))
    program, verdict = on_a_small_floor(FIRST, facts, events, frozenset(DefectKind) - {kind}, floor, steps=8)
    (fault,) = verdict.defects
    assert fault.kind is kind
    assert fault.cost == events
    assert word in fault.stream + fault.subject
    driver = play(program, fault.way)
    if kind is DefectKind.NO_ANSWER:
        assert any("contradicts that move_base" in problem for problem in driver.problems)
    elif kind is DefectKind.REPEATED:
        assert sum("pickup,1," in action for action in driver.journal.actions) == 2
    else:
        assert driver.awaited, "the robot continues as after success"
