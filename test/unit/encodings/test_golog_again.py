"""Control programs as goals that are cancelled, given up, sent again and withdrawn, in any order, by the pure core."""

from functools import lru_cache

import pytest
from busy_driver import BusyDriver
from core_driver import Driver, shortest
from golog_programs import ENCODINGS
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from rosoclingo.oclingo import ReactiveProgram, parse_update
from rosoclingo.oclingo.program.sources import Source

#: Actions named act; a fluent no(A) makes one impossible. What is done is told by acts.
DOMAIN = """
#include "golog.lp".
#program base.
act(a;b;c;d;tidy;calm).
#program cumulative(t).
#external _set/2. #external _unset/2.
golog_action(A,act,A,t) :- act(A), not holds(no(A),t).
holds(F,t) :- _set(F,t).
holds(F,t) :- holds(F,t-1), not _unset(F,t).
golog_holds(F,t) :- holds(F,t).
:- 2 { _action_lib(A,X,t) }.
"""

PROGRAMS = """
proc short { a; b; }
proc tidied { do { a; b; } on cancel { tidy; calm; } }
proc waiting { a; do { await f; b; } on cancel { tidy; } }
proc doubtful { do { a; b; } on cancel { tidy; test g; calm; } }
proc caught { try { a; b; } else { c; } }
proc again { retry 1 { do { a; b; } on cancel { tidy; } } }
proc whole { alone { do { a; b; c; } on cancel { tidy; calm; } } }
proc both { interleave { short; } with { tidied; } }
proc open { interrupts { when not f { c; await f; } } until f; b; }
proc late { await g; c; }
proc patient { do { a; b; } on cancel { await f; tidy; } }
proc nothing { }
"""
NAMES = [line.split()[1] for line in PROGRAMS.splitlines() if line]


@lru_cache(maxsize=None)
def program():
    """The domain with these programs."""
    return ReactiveProgram([Source("domain.lp", DOMAIN, ENCODINGS), Source("test.golog", PROGRAMS)])


def core():
    """A core that has nothing to do yet."""
    return Driver(program=program())


def failing(driver, times):
    """What is under way fails so many times."""
    for _ in range(times):
        driver.fail("stuck")
    return driver


def doing(driver):
    """What is under way."""
    return " ".join(str(action.parameter) for action in driver.core.awaited)


def all_done(driver):
    """What is done, until nothing is."""
    found = []
    while driver.core.awaited:
        found.append(doing(driver))
        driver.succeed()
    return " ".join(found)


def given_up(identity=1):
    """A core that has given up a program after it has begun, and tidies up."""
    driver = failing(core().goal("old", f"run(tidied,{identity})").succeed(), 3)
    assert (driver.states("old")[-1], doing(driver)) == ("aborted", "tidy")
    return driver


@pytest.mark.slow
def test_an_identifier_is_used_again_while_its_old_program_is_undone():
    driver = given_up().goal("new", "run(short,1)").succeed()
    assert driver.states("new")[-1] == "active"
    driver.finish()
    assert driver.states("new")[-1] == "succeeded"
    assert not driver.problems


@pytest.mark.slow
def test_a_second_program_of_an_identifier_is_undone_beside_the_first_one():
    driver = given_up().goal("new", "run(tidied,1)").succeed()
    done = []
    while doing(driver) not in ("b", ""):
        done.append(doing(driver))
        driver.succeed()
    done.append(all_done(driver.cancel("new").fail("stuck")))
    assert sorted(" ".join(done).split()) == ["a", "calm", "calm", "tidy"]
    assert driver.states("new")[-1] == "preempted"
    assert not driver.problems


@pytest.mark.slow
def test_what_waits_to_be_undone_is_undone_for_each_program_of_an_identifier():
    driver = failing(core().goal("old", "run(patient,1)").succeed(), 3)
    driver.goal("new", "run(patient,1)").succeed().cancel("new").fail("stuck")
    assert [driver.states(key)[-1] for key in ("old", "new")] == ["aborted", "preempting"]
    assert not driver.core.awaited
    assert all_done(driver.facts("_set(f,now)")) == "tidy tidy"
    assert driver.states("new")[-1] == "preempted"


@pytest.mark.slow
def test_who_is_rejected_does_not_end_what_is_done_for_an_earlier_one():
    driver = given_up().goal("new", "run(othr,1)").succeed()
    assert driver.states("new")[-1] == "rejected"
    assert doing(driver) == "calm"
    driver.succeed().goal("last", "run(short,1)").finish()
    assert driver.states("last")[-1] == "succeeded"


@pytest.mark.mostly_slow
@pytest.mark.parametrize("ended", [True, False])
def test_what_cannot_be_undone_is_left(ended):
    driver = given_up() if ended else core().goal("old", "run(tidied,1)").succeed().cancel("old").fail("stuck")
    failing(driver, 3)
    assert not driver.core.awaited
    assert driver.states("old")[-1] == ("aborted" if ended else "preempted")
    assert ended or "not all that was begun could be undone" in driver.message("old")
    assert not driver.problems
    assert driver.goal("new", "run(short,1)").finish().states("new")[-1] == "succeeded"


def test_a_further_cancel_ends_what_is_done_for_the_first_one():
    solver, done = (
        shortest(program()),
        ":- not _action_lib(act,{0},{1}). _return(act,{0},{1}). _request(cancel(1),{2}).",
    )
    solver.update(parse_update("#step 1 : 20. _request(run(tidied,1),2). #endstep."))
    (answer,) = solver.update(parse_update(f"#step 2 : 20. {done.format('a', 1, 2)} #endstep.")).answers
    assert {"_action_lib(act,tidy,2)", "_action_lib(act,calm,3)"} <= set(map(str, answer))
    (answer,) = solver.update(parse_update(f"#step 3 : 20. {done.format('tidy', 2, 3)} #endstep.")).answers
    assert "_status(1,canceled,3)" in map(str, answer)
    assert not any(atom.name == "_action_lib" and atom.arguments[2].number > 2 for atom in answer)


def test_what_can_be_undone_in_part_is_undone_in_part():
    driver = core().goal("g", "run(doubtful,1)").succeed().cancel("g").fail("stuck")
    assert doing(driver) == "tidy"
    assert driver.succeed().states("g")[-1] == "preempted"
    assert not driver.problems


def test_runs_of_the_same_program_do_not_touch_each_other():
    driver = core().goal("g", "run(tidied,1)").goal("h", "run(tidied,2)").goal("i", "run(short)").succeed()
    driver.cancel("h").finish()
    assert [driver.states(key)[-1] for key in "ghi"] == ["succeeded", "preempted", "succeeded"]
    assert not driver.problems


@pytest.mark.slow
def test_identifiers_are_any_terms():
    driver = core()
    for key, text in {"g": "undo(1)", "h": "1", "i": "run(1)", "j": "run(1,1)", "k": '"x"', "l": "-2"}.items():
        driver.goal(key, f"run(tidied,{text})")
    driver.succeed()
    for key in "hik":
        driver.cancel(key)
    driver.finish()
    assert [driver.states(key)[-1] for key in "gjl"] == ["succeeded"] * 3
    assert [driver.states(key)[-1] for key in "hik"] == ["preempted"] * 3


# ---- withdrawn -------------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_program_that_has_not_begun_is_withdrawn_and_comes_again():
    driver = BusyDriver(program=program(), most=2).goal("g", "run(waiting,1)").succeed().goal("h", "run(late,2)")
    driver.most = 1
    driver.facts("_set(g,now)")
    assert [goal.key for goal in driver.core.queue.waiting] == ["h"]
    assert all_done(driver.facts("_set(f,now)")) == "b c"
    assert "#withdraw _request(run(late,2)," in driver.journal.stream
    assert [driver.states(key)[-1] for key in "gh"] == ["succeeded", "succeeded"]


@pytest.mark.slow
def test_programs_that_have_begun_are_not_withdrawn():
    driver = BusyDriver(program=program(), most=2)
    for key in "gh":
        driver.goal(key, f"run(waiting,{key})").succeed()
    driver.most = 1
    driver.facts("_set(f,now)")
    assert driver.core.queue.waiting == []
    assert all_done(driver) == "b b"
    assert [driver.states(key)[-1] for key in "gh"] == ["succeeded", "succeeded"]


# ---- in any order ----------------------------------------------------------------------------------------------------

FLUENTS = ["f", "g", "no(a)", "no(b)", "no(tidy)"]
HAPPENED = st.one_of(
    st.tuples(st.just("ask"), st.sampled_from([*NAMES, "missing"]), st.integers(1, 2)),
    st.tuples(st.just("ask"), st.sampled_from(NAMES), st.integers(1, 2)),
    st.tuples(st.just("cancel"), st.integers(0, 3)),
    st.tuples(st.sampled_from(["succeed", "succeed", "fail", "preempted"])),
    st.tuples(st.just("told"), st.sampled_from(["_set", "_unset"]), st.sampled_from(FLUENTS)),
)


class Play:
    """Goals of a core, and what happens to them."""

    def __init__(self):
        self.driver, self.keys = core(), []

    def ask(self, name, identity):
        self.keys.append(f"{len(self.keys)} {name}")
        self.driver.goal(self.keys[-1], f"run({name},{identity})")

    def cancel(self, number):
        if self.keys:
            self.driver.cancel(self.keys[-1 - number % len(self.keys)])

    def succeed(self):
        self.driver.succeed()

    def fail(self):
        if self.driver.core.awaited:
            self.driver.fail("stuck")

    def preempted(self):
        if self.driver.core.awaited:
            self.driver.fail("preempted")

    def told(self, word, fluent):
        self.driver.facts(f"{word}({fluent},now)")

    def end(self):
        """All is possible again and works: each goal ends."""
        self.driver.facts("_set(f,now)", "_set(g,now)", *(f"_unset({one},now)" for one in FLUENTS[2:])).finish()
        for key in self.keys:
            last = (self.driver.states(key) or ["refused"])[-1]
            assert last in ("refused", "rejected", "recalled", "preempted", "succeeded", "aborted"), key
            assert last != "rejected" or "missing" in key, self.driver.message(key)
        assert not self.driver.problems


@pytest.mark.slow
@pytest.mark.once
@settings(max_examples=max(1, settings.default.max_examples // 2), phases=[Phase.explicit, Phase.reuse, Phase.generate])
@given(st.lists(HAPPENED, min_size=4, max_size=12))
def test_each_goal_ends_and_the_core_goes_on(script):
    play = Play()
    for name, *values in script:
        getattr(play, name)(*values)
    play.end()
