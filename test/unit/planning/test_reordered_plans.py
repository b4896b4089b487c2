"""Plans in another order as the improvement asks for them."""

from types import SimpleNamespace

import pytest
from plain_deeds import deeds_of

from rosoclingo.oclingo import parse_atom
from rosoclingo.planning.history import Plan, cycle_of
from rosoclingo.planning.question import UNKNOWN, Reply
from rosoclingo.planning.strategies import reordered_plans
from rosoclingo.planning.strategies.improve import Improvement
from rosoclingo.planning.strategies.reordered_plans import ReorderedPlans

#: From a over b to c and back, twice; 7 steps are enough behind the first.
TO_AND_FRO = "go a; go b; go c; water fern; go b; go a; water rose; go b; go c; water lily; go b; go a; water ivy"


def plan_of(text, first=1):
    deeds = [(*deed, cycle) for cycle, deed in enumerate(deeds_of(text), first)]
    return Plan(frozenset(parse_atom("_action_lib({},{},{})".format(*one)) for one in deeds), first + len(deeds) - 1)


def found_by(plans, plan, step=1):
    return [one for one in plans.shorter(plan, step) if one is not None]


def test_plans_go_on_behind_the_present_step_and_get_shorter():
    found = found_by(ReorderedPlans(), plan_of(TO_AND_FRO))
    assert [one.horizon for one in found] == sorted({one.horizon for one in found}, reverse=True)
    assert found[-1].horizon == 7
    assert sorted(map(cycle_of, found[-1].actions)) == [*range(2, 8)]


def test_a_plan_of_later_cycles_is_the_same():
    found = found_by(ReorderedPlans(), plan_of(TO_AND_FRO, 40), 40)
    assert found[-1].horizon == 46


def test_what_was_found_is_gone_on_from_when_the_robot_has_gone_on():
    plans, plan = ReorderedPlans(), plan_of(TO_AND_FRO)
    found_by(plans, plan)
    (at_once,) = found_by(plans, plan, 2)
    assert at_once.horizon == 9, "what was to be done at a is done at the end"


def test_it_is_looked_for_a_stop_now_and_then(monkeypatch):
    monkeypatch.setattr(reordered_plans, "EFFORT", 400)
    assert [*ReorderedPlans().shorter(plan_of(TO_AND_FRO), 1)].count(None) >= 400 // 4 // reordered_plans.LOOK - 4


@pytest.mark.parametrize("text", ["", "go a; go b; go a", "water fern; water rose"])
def test_where_there_is_nothing_to_order_none_is_found(text):
    assert found_by(ReorderedPlans(), plan_of(text, 2)) == []


def test_of_a_plan_that_does_several_things_at_once_none_is_found():
    plan = plan_of(TO_AND_FRO)
    both = plan._replace(actions=plan.actions | {parse_atom("_action_lib(sing,song,5)")})
    assert found_by(ReorderedPlans(), both) == []
    past = plan._replace(actions=plan.actions | {parse_atom("_action_lib(sing,song,1)")})
    assert found_by(ReorderedPlans(), past) != []


def test_what_brings_nothing_is_looked_for_ever_less():
    plans, asked = ReorderedPlans(), 0
    for _ in range(100):
        found = found_by(plans, plan_of(TO_AND_FRO))
        asked += bool(found)
        if found:
            plans.learn(useful=False)
    assert 2 <= asked <= 40
    other = ReorderedPlans()
    for first in range(1, 21):
        assert found_by(other, plan_of(TO_AND_FRO, first), first)
        other.learn(useful=True)


def test_where_it_brings_nothing_ways_are_taken_as_they_were_gone_and_so_on_in_turns(monkeypatch):
    back = []
    monkeypatch.setattr(reordered_plans, "Orders", lambda past, plan, random, way_back, before: back.append(way_back))
    monkeypatch.setattr(reordered_plans, "Random", lambda seed: SimpleNamespace(random=lambda: 0.0))
    plans = ReorderedPlans()
    for useful in (True, False, True, False, True):
        found_by(plans, plan_of("go a"))
        found_by(plans, plan_of("go a"))
        plans.learn(useful)
    assert back == [True, False, True]


class Asked:
    """What an improvement knows of its grounding, with ``reply``, of given actions and a horizon, which tells a plan.

    Notes the last horizon of each question, of which there are ``most``.
    """

    def __init__(self, reply):
        self.program, self.step, self.horizon = SimpleNamespace(advises=True), 1, 99
        self.reply, self.asked, self.most = reply, [], 0

    @staticmethod
    def actions(first, last):
        return []

    def is_stopped(self):
        return len(self.asked) >= self.most

    def run(self, improvement, most):
        strategy, self.most = improvement.run(self), most
        try:
            question = next(strategy)
            while True:
                self.asked.append(question.last)
                answer = self.reply(frozenset(action for action, value in question.given if value), question.last)
                question = strategy.send(UNKNOWN if answer is None else Reply(True, (answer,), question.last))
        except StopIteration as end:
            return end.value


@pytest.mark.parametrize("least", [8, 9, 10])
def test_where_the_shortest_is_no_plan_one_of_the_others_may_be(least):
    """Those of fewer steps are none; half as many of the others are left each time."""
    plan = plan_of(TO_AND_FRO)

    def reply(actions, last):
        return actions | plan.since(0).actions - plan.since(2).actions if last >= least and actions else None

    asked, expected = Asked(reply), []
    shorter = [one.horizon for one in found_by(ReorderedPlans(), plan)]
    while shorter and not (expected and expected[-1] >= least):
        expected.append(shorter[-1])
        shorter = shorter[: len(shorter) // 2]
    result = asked.run(Improvement(plan, 1, 1), len(expected))
    assert asked.asked == expected
    assert len(expected) > 1
    assert (None if result is None else result.horizon) == (expected[-1] if expected[-1] >= least else None)


def test_a_question_that_the_robot_overtook_is_asked_again_for_what_is_left():
    plan = plan_of(TO_AND_FRO)
    asked = Asked(lambda actions, last: None)
    tried = Improvement(plan, 1, 1)
    assert asked.run(tried, 1) is None
    assert tried.goes_on(plan, 2, 2)
    assert asked.run(tried, 2) is None
    assert asked.asked == [7, 9]
