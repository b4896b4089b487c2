"""Control programs as goals of a core: what fails, is cancelled or happens meanwhile, and other goals beside them."""

from functools import lru_cache

import pytest
from core_driver import Driver
from golog_programs import ENCODINGS

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.oclingo.program.sources import Source
from rosoclingo.reasoning.settings import CoreSettings

#: Actions named act, of which one is not possible while ``no(Action)`` holds; fluents are what somebody tells.
DOMAIN = """
#include "golog.lp".
#program base.
act(a;b;c;d;tidy).
#program cumulative(t).
#external _set/2. #external _unset/2.
golog_action(A,act,A,t) :- act(A), not holds(no(A),t).
holds(F,t) :- _set(F,t).
holds(F,t) :- holds(F,t-1), not _unset(F,t).
golog_holds(F,t) :- holds(F,t).
golog_holds(is(X),t) :- act(X).
golog_free(t) :- holds(shared,t).
:- 2 { _action_lib(A,X,t) }.
"""


PROCEDURES = """
proc other { a; await f; b; }
proc other(X) { pick Y: is(Y) and X = Y { if Y = a { a; } else { b; } } }
"""


FAILING = [
    ("a; b;", {"a": 1}, "a a b", "succeeded"),
    ("a; b;", {"a": 3}, "a a a", "aborted"),
    ("choose { a; b; } or { c; d; a; }", {"b": 3}, "a b b b", "aborted"),
    ("choose { a; } or { c; d; }", {"a": 3}, "a a a c d", "succeeded"),
    ("choose { a; c; } or { a; b; d; }", {"c": 3}, "a b c c c d", "succeeded"),
    ("try { a; b; } else { c; } d;", {"b": 1}, "a b c d", "succeeded"),
    ("try { try { a; } else { b; } } else { c; }", {"a": 1, "b": 1}, "a b c", "succeeded"),
    ("try { while not f { a; test f; } } else { c; }", {}, "", "aborted"),
    ("retry 1 { a; b; } c;", {"b": 1}, "a a b b c", "succeeded"),
    ("try { retry 1 { a; b; } } else { c; }", {"b": 2}, "a a b b c", "succeeded"),
    ("interleave { try { a; } else { b; } } with { c; d; }", {"a": 1}, "a b c d", "succeeded"),
    ("prefer { try { a; } else { } } over { c; }", {"a": 1}, "a c", "succeeded"),
    ("prefer { a; } over { c; }", {"a": 3}, "a a a", "aborted"),
    ("search { a; b; } c;", {"b": 1}, "a b b c", "succeeded"),
    ("any order { a; } and { try { b; } else { c; } }", {"b": 1}, "a b c", "succeeded"),
    ("pick X in {b, a} { try { other(X); } else { d; } }", {"a": 1, "b": 1}, "d", "succeeded"),
    ("do { a; b; } on cancel { tidy; }", {"a": 1, "b": 1}, "a a b b", "succeeded"),
    ("do { a; b; } on cancel { tidy; }", {"b": 3}, "a b b b tidy", "aborted"),
    ("star { a; } b;", {"b": 1}, "b b", "succeeded"),
    ("test true; if f { a; } else { b; } c;", {"b": 1}, "b b c", "succeeded"),
    ("achieve true; any;", {"a": 1, "b": 1, "c": 1, "d": 1, "tidy": 1}, None, "succeeded"),
    ("prefer { interrupts { when f { } } until true; } over { a; }", {"a": 2}, "a a a", "succeeded"),
    ("other(a);", {"a": 2}, "a a a", "succeeded"),
]

CANCELLED = [
    ("a; b; c;", 1, ""),
    ("do { a; b; } on cancel { tidy; } c;", 1, "tidy"),
    ("do { a; b; } on cancel { tidy; } c;", 2, ""),
    ("do { do { a; b; } on cancel { c; } } on cancel { tidy; }", 1, "c tidy"),
    ("interleave { do { a; b; } on cancel { c; } } with { test false; }", 0, None),
    ("search { do { a; b; } on cancel { tidy; } }", 1, "tidy"),
    ("try { do { a; b; } on cancel { tidy; } } else { d; }", 1, ""),  # what has failed has been left
    ("retry 2 { do { a; b; } on cancel { tidy; } }", 1, ""),
    ("while not f { do { a; b; } on cancel { tidy; } test f; }", 1, None),
    ("prefer { await f; a; } over { do { b; c; } on cancel { tidy; d; } }", 1, "tidy d"),
    ("any order { do { a; b; } on cancel { tidy; } } and { do { c; d; } on cancel { tidy; } }", 1, "tidy"),
]

HAPPENING = [
    ("a; if f { b; } else { c; }", ["_set(f,now)"], "a b"),
    ("a; while f { b; } c;", [], "a c"),
    ("a; await f; b;", ["_set(f,now)"], "a b"),
    ("a; test f; b;", ["_set(f,now)"], None),
    ("choose { a; b; } or { a; c; }", ["_set(no(b),now)"], "a c"),
    ("choose { a; test not f; b; } or { a; c; d; }", ["_set(f,now)"], "a c d"),
    ("a; pick X: wanted(X) { if X = 1 { b; } else { c; } }", ["_set(wanted(2),now)"], None),
    ("a; await some X: wanted(X); pick X: wanted(X) { if X = 1 { b; } else { c; } }", ["_set(wanted(2),now)"], "a c"),
    ("interrupts { when f { b; } when not g { a; } } until g;", [], None),
    ("prefer { interrupts { when f { b; await not f; } } until g; } over { a; c; }", ["_set(g,now)"], "a c"),
    ("any order { a; } and { await f; b; }", ["_set(f,now)"], "a b"),
    ("interleave { a; c; } with { await f; b; d; }", ["_set(f,now)"], "a b c d"),
    ("search { a; await f; b; }", ["_set(f,now)"], "a b"),
    ("star { a; } await f; b;", ["_set(f,now)"], "b"),
    ("prefer { alone { a; await f; b; } } over { c; }", ["_set(f,now)"], "a b c"),
    (
        "prefer { interrupts { when not g { alone { a; await g; b; } } } until g; } over { d; }",
        ["_set(g,now)"],
        "a b d",
    ),
    ("try { a; await f; b; } else { }", ["_set(f,now)"], "a b"),
    ("retry 2 { a; await f; b; }", ["_set(f,now)"], "a b"),
    ("do { a; await f; b; } on cancel { }", ["_set(f,now)"], "a b"),
    ("other;", ["_set(f,now)"], "a b"),
    ("interrupts { when f { c; } } until true; await f; b;", ["_set(f,now)"], "b"),
]

OTHERS = [
    "interrupts { when f { c; await not f; } when not g { a; b; } } until g;",
    "prefer { interrupts { when f { c; await not f; } } until g; } over { a; b; d; }",
    "a; await f; b;",
    "a; c;",
    "c;",
    "d;",
    "search { a; b; c; }",
    "await g; d;",
    "interleave { alone { a; await f; b; } d; } with { c; }",
    "interleave { interleave { alone { a; await f; b; } } with { d; } } with { c; }",
    "interleave { try { alone { a; await f; b; } } else { } d; } with { c; }",
    "d; search { a; c; await f; b; }",
    "a; b; a; c;",
    "if f { b; } else { a; c; }",
    "alone { d; if f { b; } else { a; c; } }",
    "prefer { a; while f { d; } await g; } over { b; c; }",
    "prefer { a; if f { d; } else { } await g; } over { b; c; }",
]

#: Programs that lead nowhere, and what is said of them.
UNMET = [
    ("test f;", "the test in line {} of test.golog does not hold"),
    ("pick X: is(X) and f { a; }", "there is nothing to pick in line {} of test.golog"),
]

#: The number of each program.
TEXTS = {
    text: number
    for number, text in enumerate(
        dict.fromkeys([*(row[0] for row in [*FAILING, *CANCELLED, *HAPPENING, *UNMET]), *OTHERS])
    )
}


@lru_cache(maxsize=None)
def program():
    """All programs of this file as procedures p0, p1, ... in the domain."""
    texts = [f"proc p{number} {{ {text} }}" for text, number in TEXTS.items()]
    sources = [Source("domain.lp", DOMAIN, ENCODINGS), Source("test.golog", PROCEDURES + "\n".join(texts))]
    return ReactiveProgram(sources)


def core(text, identity=1):
    """A core that has been asked for a program of TEXTS."""
    return Driver(program=program()).goal("g", goal(text, identity))


def goal(text, identity):
    """The goal for a program of TEXTS."""
    return f"run(p{TEXTS[text]},{identity})"


def done(driver, **reasons):
    """What is done, one after the other, until nothing is; an action fails for the reasons given for it, one by one."""
    found = []
    while driver.core.awaited:
        (action,) = driver.core.awaited
        found.append(str(action.parameter))
        why = reasons.get(found[-1])
        if why:
            driver.fail(why.pop(0))
        else:
            driver.succeed()
        assert len(found) < 40
    return " ".join(found)


@pytest.mark.mostly_slow
@pytest.mark.parametrize(("text", "reasons", "actions", "end"), FAILING)
def test_what_is_done_when_actions_fail(text, reasons, actions, end):
    """Each of these actions fails so many times; what is done is told in alphabetic order."""
    driver = core(text)
    found = done(driver, **{name: ["stuck"] * times for name, times in reasons.items()})
    assert driver.states("g")[-1] == end
    if actions == "d":  # whichever it was
        assert found in ("a d", "b d")
    elif actions is not None:
        assert " ".join(sorted(found.split())) == actions


@pytest.mark.slow
def test_who_is_preempted_tries_on():
    driver = core("a; b;")
    assert done(driver, a=["preempted"] * 5) == "a a a a a a b"


@pytest.mark.mostly_slow
@pytest.mark.parametrize(("text", "before", "after"), CANCELLED)
def test_what_is_done_when_it_is_cancelled(text, before, after):
    """So many actions are done, a cancel comes while the next one is under way, and that fails."""
    driver = core(text)
    if after is None:
        assert driver.states("g")[-1] == "aborted"
        return
    for _ in range(before):
        driver.succeed()
    driver.cancel("g")
    assert driver.states("g")[-1] == "preempting"
    driver.fail("stuck")
    assert done(driver) == after
    assert driver.states("g")[-1] == "preempted"


def test_what_is_done_stays_done_when_it_is_cancelled_and_asked_for_anew():
    driver = core("a; b;").succeed().cancel("g").succeed()
    assert driver.states("g")[-1] in ("preempted", "succeeded")
    assert done(driver.goal("h", goal("a; b;", 1))) == "a b"
    assert driver.states("h")[-1] == "succeeded"


@pytest.mark.mostly_slow
@pytest.mark.parametrize(("text", "facts", "actions"), HAPPENING)
def test_what_is_done_when_something_happens_meanwhile(text, facts, actions):
    """The facts come while a is under way; what never has a plan is given up."""
    driver = core(text)
    assert driver.awaited in ([], ["_action_lib(act,a,1)"])
    if driver.states("g")[-1] == "active":
        driver.facts(*facts)
    found = done(driver)
    if actions is None:
        assert driver.states("g")[-1] in ("aborted", "active")
        return
    assert sorted(found.split()) == sorted(actions.split())
    assert driver.states("g")[-1] == "succeeded"


@pytest.mark.slow
def test_an_interrupt_goes_before_what_is_under_way():
    driver = core("interrupts { when f { c; await not f; } when not g { a; b; } } until g;")
    assert driver.states("g")[-1] == "aborted"  # it has no end that could be planned
    driver = core("prefer { interrupts { when f { c; await not f; } } until g; } over { a; b; d; }")
    driver.facts("_set(f,now)").succeed()
    assert driver.awaited == ["_action_lib(act,c,2)"]
    driver.facts("_unset(f,now)").succeed()
    assert done(driver) == "b d"
    assert driver.states("g")[-1] == "active"
    driver.facts("_set(g,now)")
    assert driver.states("g")[-1] == "succeeded"


def test_a_program_that_waits_takes_no_actions_and_lets_others_act():
    driver = core("a; await f; b;")
    assert done(driver) == "a"
    assert done(driver.goal("h", goal("c;", 2))) == "c"
    assert [driver.states(key)[-1] for key in "gh"] == ["active", "succeeded"]
    assert done(driver.facts("_set(f,now)")) == "b"
    assert driver.states("g")[-1] == "succeeded"


def test_each_action_is_of_one_program():
    driver = core("a; b;").goal("h", goal("a; c;", 2))
    assert sorted(done(driver).split()) == ["a", "a", "b", "c"]
    assert [driver.states(key)[-1] for key in "gh"] == ["succeeded", "succeeded"]


def test_nothing_comes_into_a_search():
    driver = core("search { a; b; c; }").goal("h", goal("d;", 2))
    assert "a b c" in done(driver)


def test_an_action_may_have_been_another_ones_where_others_may_act():
    driver = Driver(program=program()).facts("_set(shared,now)").goal("g", goal(OTHERS[-4], 1))
    assert done(driver.facts("_set(f,now)", "_set(no(c),now)")) == "a b"
    assert driver.states("g")[-1] == "succeeded"


@pytest.mark.parametrize("before", [0, 1])
def test_nobody_acts_while_a_search_waits(before):
    driver = core("d; search { a; c; await f; b; }").succeed().succeed()
    driver = driver.succeed().goal("h", goal("d;", 2)) if before else driver.goal("h", goal("d;", 2)).succeed()
    assert driver.awaited == []
    assert driver.states("h")[-1] == "active"
    assert done(driver.facts("_set(f,now)")) == "b d"
    assert [driver.states(key)[-1] for key in "gh"] == ["succeeded", "succeeded"]


@pytest.mark.mostly_slow
@pytest.mark.parametrize("text", OTHERS[8:11])
def test_a_search_that_waits_within_others_holds_all_of_them_off(text):
    driver = core(text)
    assert driver.awaited == ["_action_lib(act,a,1)"]
    assert driver.succeed().awaited == []
    assert sorted(done(driver.facts("_set(f,now)"))) == sorted("b c d")
    assert driver.states("g")[-1] == "succeeded"


@pytest.mark.slow
def test_failures_are_counted_anew_once_the_action_has_worked():
    driver = core(OTHERS[-5])
    for action, works in zip("aaabaaac", [False, False, True, True] * 2):
        assert [str(one.parameter) for one in driver.core.awaited] == [action]
        driver = driver.succeed() if works else driver.fail("stuck")
    assert driver.states("g")[-1] == "succeeded"


@pytest.mark.slow
def test_failures_are_counted_anew_when_a_program_is_asked_for_or_cancelled():
    driver = core("a; b;").fail("stuck").fail("stuck").goal("h", goal("await g; d;", 2))
    driver.fail("stuck").fail("stuck").cancel("h").fail("stuck").fail("stuck")
    assert [driver.states(key)[-1] for key in "gh"] == ["active", "preempted"]
    assert done(driver) == "a b"


@pytest.mark.slow
def test_in_the_midst_of_a_search_an_action_was_its_own_though_others_may_act():
    driver = core(OTHERS[-3]).facts("_set(shared,now)").succeed()
    assert driver.awaited == ["_action_lib(act,a,2)"]
    assert done(driver.facts("_set(f,now)", "_set(no(c),now)")) == "a"
    assert driver.states("g")[-1] == "aborted"


@pytest.mark.parametrize("text", OTHERS[-2:])
def test_what_has_ended_does_not_begin_again(text):
    driver = core(text).succeed()
    assert driver.awaited == ["_action_lib(act,b,2)"]
    assert done(driver.facts("_set(f,now)")) == "b c"


def test_a_goal_may_name_itself_and_is_cancelled_by_that():
    driver = Driver(program=program()).goal("h", "run(other)").cancel("h").succeed()
    assert driver.states("h")[-1] == "preempted"


def test_a_program_that_there_is_not_is_rejected():
    driver = Driver(program=program()).goal("g", "run(othr,1)").goal("h", "run(other(1,2),2)")
    assert driver.message("g") == "the program rejects run(othr,1): there is no program othr"
    assert driver.message("h") == "the program rejects run(other(1,2),2): there is no program other(1,2)"


@pytest.mark.slow
def test_it_is_told_why_a_program_is_given_up():
    driver = Driver(program=program()).facts("_set(no(b),now)").goal("g", goal("a; b;", 1))
    assert driver.states("g")[-1] == "aborted"
    assert " cannot be met" in driver.message("g")
    driver = core("a; b;")
    assert done(driver, a=["stuck"] * 3) == "a a a"
    assert "a has failed 3 times in a row" in driver.message("g")


@pytest.mark.parametrize(("text", "why"), UNMET)
def test_it_is_told_where_a_program_leads_no_further(text, why):
    assert why.format(TEXTS[text] + 4) in core(text).message("g")


#: A search that waits for the evening, and one that is asked for where it would wait at once.
HOLDING = """
proc hold { alone { go(office2); await hour(evening); go(office1); } }
proc wait { alone { go(office2); if hour(morning) { await hour(evening); } go(office1); } }
"""


@lru_cache(maxsize=None)
def mailbot():
    """The mailbot's program with its day, and what is above."""
    files = [ENCODINGS / name for name in ("mailbot.lp", "office.lp", "golog/mailbot_day.golog")]
    more = Source("more.golog", f'include "mailbot_day.golog";{HOLDING}', ENCODINGS / "golog")
    return ReactiveProgram([*map(Source.from_file, files), more])


@pytest.mark.slow
def test_requests_of_the_domain_are_served_beside_programs():
    driver = Driver(program=mailbot())
    driver.goal("round", "run(morning_round)").goal("mail", "goal(office2,office4,1)").finish()
    assert [driver.states(key)[-1] for key in ("round", "mail")] == ["succeeded", "succeeded"]
    assert driver.core.cycle <= 8


@pytest.mark.slow
@pytest.mark.once
@pytest.mark.parametrize(("first", "ends"), [("hold", True), ("wait", False)])
def test_a_request_of_the_domain_waits_while_a_search_does(first, ends):
    driver = Driver(settings=CoreSettings(), program=mailbot()).facts("_hour(morning,now)").goal("g", f"run({first})")
    driver.goal("early", "goal(office4,office1,1)").succeed()
    assert driver.awaited == []
    driver.goal("late", "goal(office3,office1,2)")
    assert [driver.states(key)[-1] for key in ("early", "late")] == ["active", "active"]
    driver.goal("called off", "goal(office3,office1,3)").cancel("called off")
    assert driver.states("called off")[-1] == "preempted"
    (driver.facts("_hour(evening,now)") if ends else driver.cancel("g")).finish()
    assert [driver.states(key)[-1] for key in ("early", "late")] == ["succeeded", "succeeded"]


@pytest.mark.slow
@pytest.mark.once
def test_no_search_is_begun_to_put_a_request_off():
    driver = Driver(settings=CoreSettings(), program=mailbot()).goal("g", "goal(office4,office3,1)")
    driver.goal("h", "run(hold)").finish()
    assert [driver.states(key)[-1] for key in "gh"] == ["succeeded", "active"]
