"""In domains of other people the known faults are found, on the shortest stream, and show on the real core."""

from functools import lru_cache

import pytest
from foreign_programs import GRIPPER, LIFT, PATROL, SOUND, VACUUM
from verified_programs import edited, more, play

from rosoclingo.checking.verifying.scope import DefectKind, EventSelection, VerifyLimits
from rosoclingo.checking.verifying.verification import verify
from rosoclingo.oclingo import ReactiveProgram, parse_term

NO_ANSWER, TAKEN, REPEATED = DefectKind.NO_ANSWER, DefectKind.FAILURE_AS_SUCCESS, DefectKind.REPEATED

#: Where it is seeded, the program, what is found, its events, its updates.
SEEDS = {
    "vacuum: a room was locked when it drove there": (
        more(VACUUM, ":- _action_lib(drive,C,k), locked(C,k)."), NO_ANSWER, 2, 2),
    "vacuum: a room stays locked, and it is in it": (
        more(VACUUM, "locked(C,k) :- locked(C,k-1). :- pos(C,k), locked(C,k)."), NO_ANSWER, 1, 1),
    "vacuum: only drives can fail": (
        edited(VACUUM, ("bad(A,k) :- _action_lib(A,P,k),", "bad(A,k) :- _action_lib(A,P,k), A = drive,")), TAKEN, 2, 3),
    "gripper: a ball was slippery when it was taken": (
        more(GRIPPER, ":- _action_lib(take,(H,B),t), slips(B,t)."), NO_ANSWER, 2, 2),
    "gripper: what it holds is forgotten with the goal": (
        edited(GRIPPER, ("not dropped(B,t).\nfull", "not dropped(B,t), fetch(B,t).\nfull")), REPEATED, 3, 3),
    "gripper: only one reason is a failure": (
        edited(GRIPPER, ("_return(A,V,t), V != P.", "_return(A,jammed,t).")), TAKEN, 2, 2),
    "lift: the door was held when it went": (
        more(LIFT, ":- _action_lib(A,F,t), held(t)."), NO_ANSWER, 2, 2),
    "lift: returns are looked at in the wrong cycle": (
        edited(LIFT, ("_return(A,V,t), V != P.", "_return(A,V,t-1), V != P.")), TAKEN, 2, 2),
    "patrol: it rained where the guard went": (
        more(PATROL, ":- _action_lib(goto,P,s), rains(P,s)."), NO_ANSWER, 2, 2),
    "patrol: a drive that failed has led there": (
        edited(PATROL, ("stands(P,s) :- _action_lib(goto,P,s), not out(s).", "stands(P,s) :- _action_lib(goto,P,s).")),
        TAKEN, 2, 2),
}  # fmt: skip


@lru_cache(maxsize=None)
def found(name):
    """The program of a seed, and what came of it."""
    text, kind, cost, _ = SEEDS[name]
    goals = SOUND[name.partition(":")[0]][1][:1]
    program = ReactiveProgram.from_text(text)
    wanted = EventSelection(
        tuple(map(parse_term, goals)), () if kind is NO_ANSWER else ("none",), most=3 if cost < 2 else 1
    )
    return program, verify(program, wanted, VerifyLimits(events=cost, steps=8), seconds=300)


@pytest.mark.slow
@pytest.mark.once
@pytest.mark.parametrize("name", SEEDS)
def test_a_fault_is_found_and_shows_on_the_real_core(name):
    _, kind, cost, updates = SEEDS[name]
    program, verdict = found(name)
    fault = next(one for one in verdict.defects if one.kind is kind)
    finding = fault
    assert (finding.cost, finding.length) == (cost, updates)
    assert verdict.progress.proven == cost - 1, "and with fewer events there is none"
    driver = play(program, finding.way, 8)
    if kind is NO_ANSWER:
        problems = " ".join(driver.problems)
        assert any(one in problems for one in ("contradict", "withheld", "begins anew", "no answer"))
    elif kind is REPEATED:
        assert finding.subject in driver.awaited
    else:
        assert not driver.core.live_goals or driver.core.plan.remaining(driver.core.cycle)


@pytest.mark.slow
@pytest.mark.once
@pytest.mark.parametrize("name", SOUND)
def test_nothing_is_found_where_nothing_is_wrong(name):
    text, goals = SOUND[name]
    wanted = EventSelection(tuple(map(parse_term, goals)), (), most=1)
    verdict = verify(ReactiveProgram.from_text(text), wanted, VerifyLimits(events=2, steps=8), seconds=300)
    assert verdict.clean, verdict.text()
    assert verdict.progress.proven == 2
