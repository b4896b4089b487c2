"""Seeded defects in small programs: found by the shortest run, and reproduced by a core; programs of other domains."""

import pytest
from foreign_programs import GRIPPER, LIFT, SOUND
from verified_programs import MACHINES, VISITS, edited, more, play

from rosoclingo.checking.verifying.scope import DefectKind, EventSelection, VerifyLimits
from rosoclingo.checking.verifying.verification import verify
from rosoclingo.oclingo import ReactiveProgram, parse_term

FAILED = "failed(P,t) :- _action_lib(go,P,t), _return(go,V,t), V != P."
NO_ANSWER, NEVER_ENDED, TAKEN = DefectKind.NO_ANSWER, DefectKind.NEVER_ENDED, DefectKind.FAILURE_AS_SUCCESS

#: The program, what is found, its events, its updates.
SEEDS = {
    "a late fact forbids what was done": (
        more(VISITS, ":- _action_lib(go,P,t), _closed(P,t)."), NO_ANSWER, 2, 2),
    "a fact forbids all": (
        more(VISITS, ":- seen(P,t)."), NO_ANSWER, 1, 1),
    "a request forbids all, cancelled or not": (
        more(VISITS, ":- _request(visit(P),t+1)."), NO_ANSWER, 1, 1),
    "a cancel forbids what was done": (
        more(VISITS, ":- _request(cancel(P),t), _action_lib(go,P,t-1)."), NO_ANSWER, 2, 2),
    "there is no answer at all": (
        more(VISITS, ":- at(home,t-1)."), NO_ANSWER, 0, 1),
    "returns are never looked at": (
        edited(VISITS, (FAILED, "#defined failed/2.")), TAKEN, 2, 2),
    "what another action is about is success": (
        edited(VISITS, ("V != P.", "V != P, not place(V).")), TAKEN, 2, 2),
    "returns are looked at in the wrong cycle": (
        edited(LIFT, ("_return(A,V,t), V != P.", "_return(A,V,t-1), V != P.")), TAKEN, 2, 2),
    "it stays accepted after a failure": (
        more(VISITS, "broken(P,t) :- failed(P,t-1). broken(P,t) :- broken(P,t-1), not asked(P,t).\n"
             "_status(P,accepted,t) :- broken(P,t).").replace("_status(P,aborted,t) :-", "aborted(P,t) :-"),
        NEVER_ENDED, 2, 2),
    "success is not seen, and it is done for ever": (
        edited(VISITS, (FAILED, "failed(P,t) :- _action_lib(go,P,t), _return(go,P,t)."),
               ("not failed(P,t-1), not _request", "not _request"),
               ("_status(P,aborted,t) :- wanted(P,t-1), failed(P,t-1).", "")), NEVER_ENDED, 1, 3),
    "it stays accepted when it is cancelled": (
        edited(VISITS, ("_status(P,canceled,t) :- _request(cancel(P),t), not at(P,t-1), not failed(P,t-1).",
                        "stopped(P,t) :- _request(cancel(P),t), not at(P,t-1), not failed(P,t-1).\n"
                        "stopped(P,t) :- stopped(P,t-1). _status(P,accepted,t) :- stopped(P,t).")),
        NEVER_ENDED, 3, 2),
    "a place that must not be gone to": (
        more(VISITS, '_never("nobody goes to the den",t) :- _action_lib(go,den,t).'), DefectKind.FORBIDDEN, 1, 1),
    "a plan with an invalid action": (
        VISITS.replace("at(home,0).", "at(home,0). _action_lib(beep,home,0)."), DefectKind.MALFORMED, 1, 1),
    "what is held is forgotten, and taken again": (
        edited(GRIPPER, ("not dropped(B,t).\nfull", "not dropped(B,t), fetch(B,t).\nfull")), DefectKind.REPEATED, 3, 3),
    "a cancel forbids an action that goes on": (
        edited(MACHINES, ("_action_lib(M,on,t) :- _running(M,on,t-1).",
                          ":- _running(M,on,t-1), not _action_lib(M,on,t).")),
        NO_ANSWER, 2, 2),
    "a failure is not seen while another action runs": (
        more(MACHINES, "others(t) :- _running(M,on,t).").replace("not _running(M,on,t).\ndone", "not others(t).\ndone"),
        TAKEN, 3, 2),
}  # fmt: skip


ASKED = {"visit(P)": "visit(hall) visit(den)", "fetch(B)": "fetch(red)", "ride(F)": "ride(1)",
         "use(M)": "use(saw) use(drill)"}  # fmt: skip


def found(name):
    """Return the program of a seed, and its verification."""
    text, _, cost, _ = SEEDS[name]
    goals = next(terms.split() for word, terms in ASKED.items() if word in text)
    heeds_facts = text.count("_closed") + text.count("seen") > 4
    program = ReactiveProgram.from_text(text)
    selection = EventSelection(tuple(map(parse_term, goals)), () if heeds_facts else ("none",), most=1)
    return program, verify(program, selection, VerifyLimits(events=max(cost, 1), steps=8), seconds=300)


def shows(kind, driver, finding):
    """Return whether a core shows the defect."""
    problems, core = " ".join(driver.problems), driver.core
    if kind is NO_ANSWER:
        return any(one in problems for one in ("contradict", "withheld", "forgets its history", "no answer"))
    if kind is NEVER_ENDED:
        return bool(core.live_goals) and (finding.circular or not core.awaited)
    if kind is DefectKind.MALFORMED:
        return finding.subject in problems
    if kind is DefectKind.REPEATED:
        return finding.subject in driver.awaited and finding.subject[:-2] in " ".join(driver.journal.actions[:-1])
    if kind is DefectKind.FORBIDDEN:
        return bool(driver.awaited)
    return not core.live_goals or bool(core.plan.remaining(core.cycle))


@pytest.mark.sampled(12)
@pytest.mark.mostly_slow
@pytest.mark.parametrize("name", SEEDS)
def test_verify_finds_a_defect_by_the_shortest_run_and_a_core_shows_it(name):
    _, kind, cost, updates = SEEDS[name]
    program, verdict = found(name)
    first = next(one for one in verdict.defects if one.kind is kind)
    assert (first.cost, first.length) == (cost, updates)
    assert verdict.progress.proven == cost - 1, "there is no defect with fewer events"
    for one in verdict.defects:
        assert shows(one.kind, play(program, one.way, 8), one)


@pytest.mark.sampled(1)
@pytest.mark.slow
@pytest.mark.parametrize("text", [VISITS, MACHINES], ids=["visits", "machines"])
def test_verify_finds_sound_programs_clean(text):
    verdict = verify(ReactiveProgram.from_text(text), EventSelection(), VerifyLimits(events=2, steps=8), seconds=300)
    assert verdict.clean, verdict.text()


@pytest.mark.sampled(1)
@pytest.mark.slow
@pytest.mark.parametrize("name", SOUND)
def test_verify_finds_sound_foreign_programs_clean(name):
    text, goals = SOUND[name]
    selection = EventSelection(tuple(map(parse_term, goals)), (), most=1)
    verdict = verify(ReactiveProgram.from_text(text), selection, VerifyLimits(events=2, steps=8), seconds=300)
    assert verdict.clean, verdict.text()
