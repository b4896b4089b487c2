"""Further examples of the literature: what is done, as their papers say, and when something happens."""

from functools import lru_cache
from pathlib import Path

import pytest
from core_driver import Driver

from rosoclingo.oclingo import ReactiveProgram, parse_update
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.reasoning.settings import CoreSettings

DATA = Path(__file__).resolve().parents[2] / "data" / "golog"


@lru_cache(maxsize=None)
def example(name):
    """An example's program."""
    return ReactiveProgram.from_files([DATA / f"{name}.golog"])


def plans(name, request):
    """All shortest plans for a request."""
    solver = PlanSolver(example(name), models=0)
    result = solver.update(parse_update(f"#step 1 : 30. _request(run({request},1),2). #endstep."))
    found = []
    for answer in result.answers:
        steps = {one.arguments[2].number: one.arguments[1] for one in answer if one.name == "_action_lib"}
        found.append(" ".join(str(steps[step]) for step in sorted(steps)))
    return sorted(found)


class Played:
    """A program that runs; ``done`` tells what is done until nothing is."""

    def __init__(self, name, request, *facts):
        self.driver = Driver(settings=CoreSettings(), program=example(name))
        if facts:
            self.driver.facts(*facts)
        self.driver.goal("g", f"run({request},1)")

    def tell(self, *facts):
        self.driver.facts(*(f"{fact[:-1]},now)" for fact in facts))
        return self

    @property
    def doing(self):
        return " ".join(str(one.parameter) for one in self.driver.core.awaited)

    def step(self, reason=None):
        """What is under way is done, or fails for a reason; return what it was."""
        found = self.doing
        if reason:
            self.driver.fail(reason)
        else:
            self.driver.succeed()
        return found

    def done(self):
        found = []
        while self.doing:
            found.append(self.step())
            assert len(found) < 30
        return " ".join(found)

    @property
    def end(self):
        return self.driver.states("g")[-1]


@pytest.mark.slow
@pytest.mark.once
def test_the_reactive_elevator_serves_alarm_temperature_and_calls_in_this_order():
    run = Played("reactive_elevator", "control")
    assert run.doing == "down(2)"
    run.tell("_set(call(3))").step()
    assert run.step() == "up(1)"
    run.tell("_set(too_hot)").step()
    assert run.step() == "fan_on"
    run.tell("_unset(too_hot)", "_set(alarm)")
    assert run.done() == "reset(3) ring"
    assert run.tell("_set(too_cold)").doing == ""
    assert run.tell("_unset(alarm)").step() == "silence"
    assert run.step() == "fan_off"
    assert run.done() == "down(3) down(2) down(1)"
    assert run.tell("_set(stopped)").end == "succeeded"


@pytest.mark.slow
def test_the_tower_is_reversed_in_the_one_way_there_is():
    assert plans("blocks", "reverse") == ["put(3) put(2) move(2,3) move(1,2)"]


@pytest.mark.slow
@pytest.mark.once
def test_each_tower_of_three_blocks_is_built():
    found = plans("blocks", "some_tower")
    assert len(found) == 6
    assert all(one.startswith("put(3) put(2) move(") for one in found)
    assert plans("blocks", "any_tower") == []


@pytest.mark.slow
def test_the_gate_is_seen_at_the_airport_and_a_paper_bought_while_there_is_time():
    run = Played("airport", "catch_plane")
    assert run.done() == "go(airport) look"
    assert run.end == "active"
    run.tell("_set(delayed)", "_set(parked(b))")
    assert run.step() == "buy_paper"
    assert run.tell("_unset(delayed)").done() == "go(b) board(b)"
    assert run.end == "succeeded"


def test_coffee_that_cannot_be_bought_is_done_without():
    run = Played("airport", "catch_plane", "_set(delayed,now)", "_set(parked(a),now)")
    assert [run.step() for _ in range(4)] == ["go(airport)", "look", "buy_paper", "go(a)"]
    assert run.step("closed") == "buy_coffee"
    assert run.done() == "board(a)"


WANTED = ("_set(wants(lab),now)", "_set(wants(office),now)")


@pytest.mark.slow
def test_coffee_goes_to_all_who_want_some():
    found = Played("coffee", "round", *WANTED).done()
    served = ["go(kitchen) fetch go({}) serve({})".format(*[one] * 2) for one in ("lab", "office")]
    assert found in (" ".join(served), " ".join(reversed(served)))


@pytest.mark.slow
def test_a_delivery_that_fails_is_tried_once_more_and_then_told():
    run = Played("coffee", "round", WANTED[0])
    assert [run.step(), run.step(), run.step()] == ["go(kitchen)", "fetch", "go(lab)"]
    assert run.step("spilled") == "serve(lab)"
    assert [run.step(), run.step()] == ["go(kitchen)", "go(lab)"]
    assert run.step("spilled") == "serve(lab)"
    assert run.done() == "sorry(lab)"
    assert run.end == "succeeded"


def test_coffee_that_is_cancelled_goes_back():
    run = Played("coffee", "round", WANTED[1])
    assert [run.step(), run.step()] == ["go(kitchen)", "fetch"]
    run.driver.cancel("g")
    assert run.step() == "go(office)"
    assert run.done() == "go(kitchen) pour_back"
    assert run.end == "preempted"


def test_a_suitcase_opens_once_both_latches_are_up():
    both = ["flip(left) flip(right)", "flip(right) flip(left)"]
    assert plans("suitcase", "open_it") == plans("suitcase", "by_latches") == both
    run = Played("suitcase", "by_latches", "_set(up(left),now)")
    assert run.step("stuck") == "flip(right)"
    assert run.done() == "flip(right)"
    assert run.end == "succeeded"


@pytest.mark.slow
def test_the_barber_sleeps_while_nobody_is_there():
    run = Played("barber", "shop")
    assert run.done() == "sleep"
    run.tell("_set(here(1))")
    assert [run.step(), run.step()] == ["wake", "call(1)"]
    run.tell("_set(here(2))", "_set(here(3))", "_set(here(4))")
    assert run.done() == "cut(1) turn_away(4) call(2) cut(2) call(3) cut(3) sleep"
    assert run.tell("_set(closed)").done() == "wake"
    assert run.end == "succeeded"


def test_stacks_are_cleared_before_a_block_is_moved():
    assert plans("blocks", "move_stack(1,3)") == ["put(3) put(2) move(1,3)"]
    assert plans("blocks", "move_stack(3,1)") == ["put(3) put(2) move(3,1)"]


def test_a_tower_of_hanoi_is_moved_in_the_one_way_there_is():
    assert plans("hanoi", "tower(3,a,c,b)") == [
        "move(1,a,c) move(2,a,b) move(1,c,b) move(3,a,c) move(1,b,a) move(2,b,c) move(1,a,c)"
    ]
