"""The examples of the literature: the actions that their papers give, and reactions to events."""

from functools import lru_cache

import pytest
from core_scripts import scripts
from golog_scripts import plans, run
from shipped import DATA, ENCODINGS

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.oclingo.program.sources import Source
from rosoclingo.reasoning.settings import CoreSettings

GOLOG, PUBLISHED = ENCODINGS / "golog", DATA / "golog"


@lru_cache(maxsize=None)
def example(name):
    """Return an example's program."""
    return ReactiveProgram.from_files([PUBLISHED / f"{name}.golog"])


def shipped_example(name, facts, **constants):
    """Return a program of the encodings with facts of its domain."""
    return ReactiveProgram(
        [Source.from_file(GOLOG / f"{name}.golog"), Source("facts.lp", f"#program base. {facts}")], constants
    )


#: The example and the script.
RUNS = {
    "latches of a suitcase": ("suitcase", """
        facts _set(up(left),now); goal g run(by_latches,1); breaks flip(right); performs flip(right)
        is g succeeded"""),
}  # fmt: skip
SLOW_RUNS = {
    "coffee that cannot be bought is done without": ("airport", """
        facts _set(delayed,now) _set(parked(a),now); goal g run(catch_plane,1); step go(airport) look buy_paper go(a)
        breaks buy_coffee closed; performs board(a)"""),
    "the elevator serves alarm, temperature and calls in this order": ("reactive_elevator", """
        goal g run(control,1); tell _set(call(3)); step down(2) up(1); tell _set(too_hot); succeed; step fan_on
        tell _unset(too_hot) _set(alarm); performs reset(3) ring; tell _set(too_cold); does; tell _unset(alarm)
        step silence fan_off; performs down(3) down(2) down(1); tell _set(stopped); is g succeeded"""),
    "a delivery that fails is tried once more": ("coffee", """
        facts _set(wants(lab),now); goal g run(round,1); step go(kitchen) fetch go(lab); breaks serve(lab) spilled
        step go(kitchen) go(lab); breaks serve(lab) spilled; performs sorry(lab); is g succeeded"""),
    "the barber sleeps while nobody is there": ("barber", """
        goal g run(shop,1); performs sleep; tell _set(here(1)); step wake call(1)
        tell _set(here(2)) _set(here(3)) _set(here(4))
        performs cut(1) turn_away(4) call(2) cut(2) call(3) cut(3) sleep; tell _set(closed); performs wake
        is g succeeded"""),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.sampled(2)
@scripts(RUNS, SLOW_RUNS)
def test_golog_example_runs_as_published(row):
    name, script = row
    run(example(name), script, CoreSettings())


@pytest.mark.sampled(3)
@pytest.mark.mostly_slow
@pytest.mark.parametrize(
    ("name", "request_", "found"),
    [
        ("suitcase", "open_it", ["flip(left) flip(right)", "flip(right) flip(left)"]),
        ("suitcase", "by_latches", ["flip(left) flip(right)", "flip(right) flip(left)"]),
        ("blocks", "move_stack(1,3)", ["put(3) put(2) move(1,3)"]),
        ("blocks", "move_stack(3,1)", ["put(3) put(2) move(3,1)"]),
        ("blocks", "reverse", ["put(3) put(2) move(2,3) move(1,2)"]),
        ("blocks", "any_tower", []),
        (
            "hanoi",
            "tower(3,a,c,b)",
            ["move(1,a,c) move(2,a,b) move(1,c,b) move(3,a,c) move(1,b,a) move(2,b,c) move(1,a,c)"],
        ),
    ],
)
def test_golog_example_has_exactly_the_published_plans(name, request_, found):
    assert plans(example(name), request_) == found


# -- the elevator of the first paper, and mail


SERVE = "turnoff({0}) door(open) door(close)"
THIRD, FIFTH, SECOND = SERVE.format(3), SERVE.format(5), SERVE.format(2)


@pytest.mark.sampled(2)
@pytest.mark.slow
@pytest.mark.parametrize(
    ("facts", "control", "first", "found"),
    [
        (
            "calls(3). calls(5).",
            "control",
            "4",
            [
                f"down(3) {THIRD} up(5) {FIFTH} down(0) door(open)",
                f"up(5) {FIFTH} down(3) {THIRD} down(0) door(open)",
            ],
        ),
        ("", "control", "4", ["down(0) door(open)"]),
        ("", "control", "0", ["door(open)"]),
        (
            "calls(2). calls(3). calls(5).",
            "nearest",
            "4",
            [
                f"down(3) {THIRD} down(2) {SECOND} up(5) {FIFTH} down(0) door(open)",
                f"up(5) {FIFTH} down(3) {THIRD} down(2) {SECOND} down(0) door(open)",
            ],
        ),
    ],
    ids=["either call first", "no calls", "no calls, parked", "nearest"],
)
def test_golog_elevator_has_the_plans_of_the_paper(facts, control, first, found):
    constants = {} if first == "4" else {"first": first}
    assert plans(shipped_example("elevator", facts, **constants), control, pairs=True) == found


@pytest.mark.slow
def test_golog_mail_is_acknowledged_first_and_resumes_with_service():
    driver = run(
        shipped_example("mail", "customer(a;b;c). start(a)."),
        "goal g run(control); does; facts _order(1,b,c,now); step ack,1; facts _order(2,b,a,now); step go,b;"
        "facts _suspend(now); step ack,2; does",
        CoreSettings(),
        pairs=True,
    )
    done = driver.facts("_resume(now)").rest()
    assert sorted(done[:2]) == ["take,1", "take,2"]
    assert done[2:] in (["go,c", "hand,1", "go,a", "hand,2"], ["go,a", "hand,2", "go,c", "hand,1"])
    assert driver.states("g")[-1] == "active"
    assert driver.cancel("g").states("g")[-1] == "preempted"
