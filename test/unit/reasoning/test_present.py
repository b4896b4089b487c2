"""Beliefs about the present, extracted from answers: of small programs, and of the shipped ones."""

import pytest
from clingo import Number, String, parse_term
from core_driver import PLANS, Driver, soon
from shipped import shipped

from rosoclingo.reasoning.events import ActionsDispatched, StateChanged
from rosoclingo.reasoning.present import Present

pytestmark = pytest.mark.once


def present(driver):
    """Return the beliefs that were published last."""
    return sorted(map(str, driver.journal.of(StateChanged)[-1].atoms))


def test_beliefs_are_atoms_of_cycle_or_without_time():
    position = {("at", 2): 1, ("first", 2): 0, ("", 2): 1, ("odd", 1): 0}
    reader = Present(lambda name, arity: position.get((name, arity)))
    answer = frozenset(
        map(parse_term, ["at(a,1)", "at(b,2)", "-at(c,2)", "first(2,x)", "(y,2)", "room(2)", "odd(a)", "now"])
    ) | {Number(2), String("two")}
    timeless = {"room(2)", "odd(a)", "now", "2", '"two"'}
    assert set(map(str, reader.of(answer, 1))) == {"at(a,now)", *timeless}
    assert set(map(str, reader.of(answer, 2))) == {"at(b,now)", "-at(c,now)", "first(now,x)", "(y,now)", *timeless}
    assert set(map(str, reader.of(answer, 3))) == timeless
    assert reader.of(frozenset(), 3) == frozenset()


@pytest.mark.parametrize("plan", PLANS)
def test_beliefs_of_a_delivery(plan):
    driver = Driver(program=shipped("mailbot.lp", "office.lp"), solver=PLANS[plan])
    assert present(driver) == ["robot_at(office1,now)"]
    driver.goal("a", "goal(office2,office3,1)")
    accepted = "_status(1,accepted,now)"
    waits = "waits(1,office2,office3,now)"
    moving = "_action_lib(move_base,office2,now)"
    assert present(driver) == [moving, accepted, "robot_at(office1,now)", waits]
    driver.succeed()
    assert present(driver) == ["_action_lib(pickup,1,now)", accepted, "robot_at(office2,now)", waits]
    driver.succeed()
    has = "robot_has(1,office3,now)"
    assert present(driver) == ["_action_lib(move_base,office3,now)", accepted, "robot_at(office2,now)", has]
    driver.finish()
    assert present(driver) == ["_status(1,succeeded,now)", "robot_at(office3,now)"]


@pytest.mark.slow
def test_beliefs_include_predicted_and_improved_answers():
    driver = Driver(program=shipped("mailbot.lp", "office.lp"), solver=lambda program: soon(program, 0.0))
    driver.goal("a", "goal(office4,office1,1)").goal("b", "goal(office4,office2,2)")
    while driver.core.awaited:
        while driver.core.improve(lambda: False):
            pass
        actions = driver.journal.of(ActionsDispatched)[-1].actions
        shown = [atom for atom in present(driver) if atom.startswith("_action_lib")]
        assert shown == [f"_action_lib({one.interface},{one.parameter},now)" for one in actions]
        driver.succeed()
