"""Control programs as goals of a core: failures, cancels, events during execution, and concurrent goals."""

from functools import lru_cache

import pytest
from core_scripts import play, scripts
from golog_programs import ENCODINGS
from golog_scripts import domain_with, run

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.oclingo.program.sources import Source
from rosoclingo.reasoning.settings import CoreSettings

PROCEDURES = """
proc other { a; await f; b; }
proc other(X) { pick Y: is(Y) and X = Y { if Y = a { a; } else { b; } } }
proc pair { a; b; }
proc ac { a; c; }
proc one(X) { pick Y: is(Y) and X = Y { if Y = c { c; } else { d; } } }
proc row { search { a; b; c; } }
proc waiting { await g; d; }
proc endless { interrupts { when f { c; await not f; } when not g { a; b; } } until g; }
proc served { prefer { interrupts { when f { c; await not f; } } until g; } over { a; b; d; } }
proc search1 { interleave { alone { a; await f; b; } d; } with { c; } }
proc search2 { interleave { interleave { alone { a; await f; b; } } with { d; } } with { c; } }
proc search3 { interleave { try { alone { a; await f; b; } } else { } d; } with { c; } }
proc late { d; search { a; c; await f; b; } }
proc twice { a; b; a; c; }
proc either { if f { b; } else { a; c; } }
proc lonely { alone { d; if f { b; } else { a; c; } } }
proc ended1 { prefer { a; while f { d; } await g; } over { b; c; } }
proc ended2 { prefer { a; if f { d; } else { } await g; } over { b; c; } }
"""

FAILING = [
    ("a; b;", {"a": 1}, "a a b", "succeeded"),
    ("a; b;", {"a": 3}, "a a a", "aborted"),
    ("choose { a; } or { c; d; }", {"a": 3}, "a a a c d", "succeeded"),
    ("try { a; b; } else { c; } d;", {"b": 1}, "a b c d", "succeeded"),
    ("try { while not f { a; test f; } } else { c; }", {}, "", "aborted"),
    ("try { retry 1 { a; b; } } else { c; }", {"b": 2}, "a a b b c", "succeeded"),
    ("interleave { try { a; } else { b; } } with { c; d; }", {"a": 1}, "a b c d", "succeeded"),
    ("do { a; b; } on cancel { tidy; }", {"b": 3}, "a b b b tidy", "aborted"),
]

CANCELLED = [
    ("a; b; c;", 1, ""),
    ("do { do { a; b; } on cancel { c; } } on cancel { tidy; }", 1, "c tidy"),
    ("interleave { do { a; b; } on cancel { c; } } with { test false; }", 0, None),
    ("search { do { a; b; } on cancel { tidy; } }", 1, "tidy"),
    ("prefer { await f; a; } over { do { b; c; } on cancel { tidy; d; } }", 1, "tidy d"),
    ("any order { do { a; b; } on cancel { tidy; } } and { do { c; d; } on cancel { tidy; } }", 1, "tidy"),
]

HAPPENING = [
    ("a; if f { b; } else { c; }", ["_set(f,now)"], "a b"),
    ("a; test f; b;", ["_set(f,now)"], None),
    ("choose { a; b; } or { a; c; }", ["_set(no(b),now)"], "a c"),
    ("a; await some X: wanted(X); pick X: wanted(X) { if X = 1 { b; } else { c; } }", ["_set(wanted(2),now)"], "a c"),
    ("prefer { interrupts { when f { b; await not f; } } until g; } over { a; c; }", ["_set(g,now)"], "a c"),
    ("interleave { a; c; } with { await f; b; d; }", ["_set(f,now)"], "a b c d"),
    ("search { a; await f; b; }", ["_set(f,now)"], "a b"),
    ("do { a; await f; b; } on cancel { }", ["_set(f,now)"], "a b"),
]

#: Programs without a continuation, and their reasons.
UNMET = [
    ("test f;", "the test in line {} of test.golog does not hold"),
    ("pick X: is(X) and f { a; }", "there is nothing to pick in line {} of test.golog"),
]

#: The number of each program.
TEXTS = {
    text: number
    for number, text in enumerate(dict.fromkeys(row[0] for row in [*FAILING, *CANCELLED, *HAPPENING, *UNMET]))
}


@lru_cache(maxsize=None)
def program():
    """Return all programs of this file as procedures p0, p1, ... in the domain."""
    texts = [f"proc p{number} {{ {text} }}" for text, number in TEXTS.items()]
    return domain_with(PROCEDURES + "\n".join(texts))


def core(text):
    """Return a core with a request for a program of TEXTS."""
    return run(program(), f"goal g run(p{TEXTS[text]},1)")


@pytest.mark.sampled(3)
@pytest.mark.slow
@pytest.mark.parametrize(("text", "reasons", "actions", "end"), FAILING)
def test_golog_program_reacts_to_failing_actions(text, reasons, actions, end):
    """Each of these actions fails a number of times; the executed actions are in alphabetical order."""
    driver = core(text)
    found = driver.rest(**{name: ["stuck"] * times for name, times in reasons.items()})
    assert driver.states("g")[-1] == end
    assert sorted(found) == actions.split()


@pytest.mark.sampled(4)
@pytest.mark.slow
@pytest.mark.parametrize(("text", "before", "after"), CANCELLED)
def test_golog_program_reacts_to_a_cancel(text, before, after):
    """After a number of actions, a cancel arrives during the next one, which fails."""
    driver = core(text)
    if after is None:
        assert driver.states("g")[-1] == "aborted"
        return
    for _ in range(before):
        driver.succeed()
    play(driver, f"cancel g; is g preempting; fail stuck; performs {after}; is g preempted")


@pytest.mark.sampled(5)
@pytest.mark.slow
@pytest.mark.parametrize(("text", "facts", "actions"), HAPPENING)
def test_golog_program_reacts_to_events_during_execution(text, facts, actions):
    """The facts arrive while a is under way; a program that never has a plan is aborted."""
    driver = core(text)
    assert driver.awaited in ([], ["_action_lib(act,a,1)"])
    if driver.states("g")[-1] == "active":
        driver.facts(*facts)
    found = driver.rest()
    if actions is None:
        assert driver.states("g")[-1] in ("aborted", "active")
        return
    assert sorted(found) == sorted(actions.split())
    assert driver.states("g")[-1] == "succeeded"


SCENES = {
    "executed actions stay after a cancel and a repeated request": """
        goal g run(pair,1); step a; cancel g; succeed; goal h run(pair,1); performs a b; is h succeeded""",
    "program that waits lets others act": """
        goal g run(other,1); performs a; goal h run(one(c),2); performs c; is g active; is h succeeded
        facts _set(f,now); performs b; is g succeeded""",
    "nobody acts while a search waits": """
        goal g run(late,1); step d a; goal h run(one(d),2); succeed; does; is h active; facts _set(f,now)
        performs b d; is g succeeded; is h succeeded""",
    **{f"ended program does not begin again: {name}": f"""
        goal g run({name},1); step a; does act,b,2; facts _set(f,now); performs b c"""
       for name in ("ended1", "ended2")},
    "goal that names itself is cancelled by that": "goal h run(other); cancel h; succeed; is h preempted",
    "programs that there are not are rejected": """
        goal g run(othr,1); goal h run(other(1,2),2); says g the program rejects run(othr,1): there is no program othr
        says h the program rejects run(other(1,2),2): there is no program other(1,2)""",
}  # fmt: skip
SLOW_SCENES = {
    "preempted program tries again": f"""
        goal g run(pair,1); {"breaks a preempted;" * 5} performs a b""",
    "interrupt precedes the action under way": """
        goal g run(served,1); facts _set(f,now); step a; does act,c,2; facts _unset(f,now); step c; performs b d
        is g active; facts _set(g,now); is g succeeded""",
    "failures are counted again when a program is asked for or cancelled": """
        goal g run(pair,1); breaks a; breaks a; goal h run(waiting,2); breaks a; breaks a; cancel h; breaks a; breaks a
        is g active; is h preempted; performs a b""",
    "action within a search was its own though others can act": """
        goal g run(lonely,1); facts _set(shared,now); step d; does act,a,2; facts _set(f,now) _set(no(c),now)
        performs a; is g aborted""",
    "reason of an impossible action": """
        facts _set(no(b),now); goal g run(pair,1); is g aborted; says g ... cannot be met...""",
    "reason of failures": """
        goal g run(pair,1); breaks a; breaks a; breaks a; does; says g ...a has failed 3 times in a row...""",
}  # fmt: skip


@pytest.mark.sampled(4)
@pytest.mark.slow
@scripts(SCENES, SLOW_SCENES)
def test_golog_scene_follows_the_script(row):
    run(program(), row)


@pytest.mark.parametrize(("text", "why"), UNMET)
def test_golog_reason_names_where_a_program_is_stuck(text, why):
    assert why.format(TEXTS[text] + PROCEDURES.count("\n") + 1) in core(text).message("g")


#: A search that waits for the evening, and a request for one that would wait at once.
HOLDING = """
proc hold { alone { go(office2); await hour(evening); go(office1); } }
proc wait { alone { go(office2); if hour(morning) { await hour(evening); } go(office1); } }
"""


@lru_cache(maxsize=None)
def mailbot():
    """Return the mailbot's program with its day and the programs above."""
    files = [ENCODINGS / name for name in ("mailbot.lp", "office.lp", "golog/mailbot_day.golog")]
    more = Source("more.golog", f'include "mailbot_day.golog";{HOLDING}', ENCODINGS / "golog")
    return ReactiveProgram([*map(Source.from_file, files), more])


@pytest.mark.slow
def test_golog_domain_requests_are_served_with_programs():
    driver = run(mailbot(), """
        goal round run(morning_round); goal mail goal(office2,office4,1); finish; is round succeeded; is mail succeeded
        """)  # fmt: skip
    assert driver.core.cycle <= 8


@pytest.mark.sampled(1)
@pytest.mark.slow
@pytest.mark.parametrize(("first", "end"), [("hold", "facts _hour(evening,now)"), ("wait", "cancel g")])
def test_golog_domain_request_waits_during_a_search(first, end):
    run(
        mailbot(),
        f"""
        facts _hour(morning,now); goal g run({first}); goal early goal(office4,office1,1); succeed; does
        goal late goal(office3,office1,2); is early active; is late active; goal off goal(office3,office1,3)
        cancel off; is off preempted; {end}; finish; is early succeeded; is late succeeded""",
        CoreSettings(),
    )
