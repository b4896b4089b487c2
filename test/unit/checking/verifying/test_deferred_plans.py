"""Plans that are deferred forever: the core of the verification reports them, and so do circular runs."""

import pytest
from core_driver import DeferringSolver, Driver
from verified_programs import VISITS, edited, more

from rosoclingo.checking.verifying.moves import GOAL, Arrival, Move
from rosoclingo.checking.verifying.scope import DefectKind, EventSelection, VerifyLimits
from rosoclingo.checking.verifying.trial_core import BrokenError, TrialCore
from rosoclingo.checking.verifying.verification import verify
from rosoclingo.oclingo import ReactiveProgram, parse_atom
from rosoclingo.reasoning.settings import CoreSettings


def test_trial_core_reports_a_deferred_plan():
    core = TrialCore(ReactiveProgram.from_text(VISITS), DeferringSolver, CoreSettings(horizon_limit=5))
    core.start()
    core.make(Move((Arrival(GOAL, parse_atom("visit(hall)")),)))
    for _ in range(4):
        core.make(Move())
    with pytest.raises(BrokenError) as broken:
        core.make(Move())
    assert broken.value.kind is DefectKind.PUT_OFF


#: No goal is served before cycle 3, and acting earlier has a cost.
WAITS = edited(
    more(VISITS, "told(t) :- asked(P,t). told(t) :- told(t-1). #minimize { 1,P,t : _action_lib(go,P,t), t < 3 }."),
    (":- wanted(P,t), not at", ":- told(t), t < 3.\n:- wanted(P,t), not at"),
)


def test_verify_accepts_a_program_that_waits():
    program = ReactiveProgram.from_text(WAITS)
    driver = Driver(program=program).goal("a", "visit(hall)")
    assert driver.awaited == ["_action_lib(go,hall,3)"], "the first cycles have no actions"
    assert verify(
        program, EventSelection((parse_atom("visit(hall)"),), ("none",)), VerifyLimits(1, steps=8), 60.0
    ).clean
