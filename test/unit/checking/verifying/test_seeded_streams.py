"""Seeded defects in small programs and foreign domains: found by the shortest run, and reproduced by a core."""

import pytest
from foreign_programs import GRIPPER, LIFT, PATROL, SOUND, VACUUM
from verified_programs import CARRIES, ECHO, MACHINES, VISITS, edited, more, play

from rosoclingo.checking.verifying.scope import DefectKind, EventSelection, VerifyLimits
from rosoclingo.checking.verifying.verification import verify
from rosoclingo.oclingo import ReactiveProgram, parse_term

FAILED = "failed(P,t) :- _action_lib(go,P,t), _return(go,V,t), V != P."
NO_ANSWER, NEVER_ENDED, TAKEN = DefectKind.NO_ANSWER, DefectKind.NEVER_ENDED, DefectKind.FAILURE_AS_SUCCESS

#: The program, what is found, its events, its updates.
SEEDS = {
    "a late fact forbids what was done": (
        more(VISITS, ":- _action_lib(go,P,t), _closed(P,t)."), NO_ANSWER, 2, 2),
    "so does one of the cycle before": (
        more(VISITS, ":- _action_lib(go,P,t), _closed(P,t-1)."), NO_ANSWER, 3, 3),
    "a fact forbids all": (
        more(VISITS, ":- seen(P,t)."), NO_ANSWER, 1, 1),
    "a request forbids all, cancelled or not": (
        more(VISITS, ":- _request(visit(P),t+1)."), NO_ANSWER, 1, 1),
    "a cancel forbids what was done": (
        more(VISITS, ":- _request(cancel(P),t), _action_lib(go,P,t-1)."), NO_ANSWER, 2, 2),
    "a reason that is named forbids all": (
        more(VISITS, ":- _return(go,blocked,t)."), NO_ANSWER, 2, 2),
    "there is no answer at all": (
        more(VISITS, ":- at(home,t-1)."), NO_ANSWER, 0, 1),
    "returns are never looked at": (
        edited(VISITS, (FAILED, "#defined failed/2.")), TAKEN, 2, 2),
    "one reason alone is a failure": (
        edited(VISITS, (FAILED, "failed(P,t) :- _action_lib(go,P,t), _return(go,stuck,t).")), TAKEN, 2, 2),
    "what another action is about is success": (
        edited(VISITS, ("V != P.", "V != P, not place(V).")), TAKEN, 2, 2),
    "any return is success, a step later": (
        edited(ECHO, ("_return(run,J,t-1).", "_return(run,V,t-1)."),
               ("_return(run,V,t-1), V != J.", "_return(run,V,t-1), V = never.")), TAKEN, 2, 2),
    "goal without a status after its action failed": (
        edited(VISITS, ("_status(P,aborted,t) :- wanted(P,t-1), failed(P,t-1).", "")), TAKEN, 2, 2),
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
    "two places one after the other": (
        more(VISITS, "_never(hurry,t) :- _action_lib(go,P,t), _action_lib(go,Q,t-1), P != Q."),
        DefectKind.FORBIDDEN, 2, 2),
    "a plan with an invalid action": (
        VISITS.replace("at(home,0).", "at(home,0). _action_lib(beep,home,0)."), DefectKind.MALFORMED, 1, 1),
    "what is held is forgotten, and grabbed again": (
        edited(CARRIES, ("held(X,t-1), not dropped(X,t).", "held(X,t-1), not dropped(X,t), wanted(X,t).")),
        DefectKind.REPEATED, 3, 3),
    "a cancel forbids an action that goes on": (
        edited(MACHINES, ("_action_lib(M,on,t) :- _running(M,on,t-1).",
                          ":- _running(M,on,t-1), not _action_lib(M,on,t).")),
        NO_ANSWER, 2, 2),
    "a failure is not seen while another action runs": (
        more(MACHINES, "others(t) :- _running(M,on,t).").replace("not _running(M,on,t).\ndone", "not others(t).\ndone"),
        TAKEN, 3, 2),
}  # fmt: skip


#: The same in domains of other people: the domain, the program, what is found, its events, its updates.
FOREIGN = {
    "vacuum: a room was locked when it drove there": (
        more(VACUUM, ":- _action_lib(drive,C,k), locked(C,k)."), NO_ANSWER, 2, 2),
    "vacuum: a room stays locked, and it is in it": (
        more(VACUUM, "locked(C,k) :- locked(C,k-1). :- pos(C,k), locked(C,k)."), NO_ANSWER, 1, 1),
    "vacuum: only drives can fail": (
        edited(VACUUM, ("bad(A,k) :- _action_lib(A,P,k),", "bad(A,k) :- _action_lib(A,P,k), A = drive,")), TAKEN, 2, 3),
    "gripper: a ball was slippery when it was taken": (
        more(GRIPPER, ":- _action_lib(take,(H,B),t), slips(B,t)."), NO_ANSWER, 2, 2),
    "gripper: what it holds is forgotten with the goal": (
        edited(GRIPPER, ("not dropped(B,t).\nfull", "not dropped(B,t), fetch(B,t).\nfull")), DefectKind.REPEATED, 3, 3),
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


ASKED = {"visit(P)": "visit(hall) visit(den)", "bring(X)": "bring(cup)", "do(J)": "do(wash) do(iron)",
         "use(M)": "use(saw) use(drill)"}  # fmt: skip
NAMES = [*SEEDS, *(pytest.param(name, marks=pytest.mark.slow) for name in FOREIGN)]


def found(name):
    """Return the program of a seed, and its verification."""
    text, kind, cost, _ = {**SEEDS, **FOREIGN}[name]
    if name in SEEDS:
        goals = next(terms.split() for word, terms in ASKED.items() if word in text)
        heeds_facts, most = text.count("_closed") + text.count("seen") > 4, 1
    else:
        goals = SOUND[name.partition(":")[0]][1][:1]
        heeds_facts, most = kind is NO_ANSWER, 3 if cost < 2 else 1
    program = ReactiveProgram.from_text(text)
    selection = EventSelection(tuple(map(parse_term, goals)), () if heeds_facts else ("none",), most=most)
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
@pytest.mark.parametrize("name", NAMES)
def test_verify_finds_a_defect_by_the_shortest_run_and_a_core_shows_it(name):
    _, kind, cost, updates = {**SEEDS, **FOREIGN}[name]
    program, verdict = found(name)
    first = next(one for one in verdict.defects if one.kind is kind)
    assert (first.cost, first.length) == (cost, updates)
    assert verdict.progress.proven == cost - 1, "there is no defect with fewer events"
    for one in verdict.defects:
        assert shows(one.kind, play(program, one.way, 8), one)


@pytest.mark.sampled(1)
@pytest.mark.slow
@pytest.mark.parametrize("text", [VISITS, CARRIES, ECHO, MACHINES], ids=["visits", "carries", "echo", "machines"])
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
