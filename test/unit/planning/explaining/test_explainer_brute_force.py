"""Reasons for "no plan" against brute force: clingo alone on the text without the rules and facts that are let go."""

from itertools import combinations

import clingo
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rosoclingo.oclingo import ReactiveProgram, parse_update
from rosoclingo.planning.explaining.explainer import explain
from rosoclingo.planning.explaining.questions import Stream
from rosoclingo.planning.explaining.why_not import WhyNot
from rosoclingo.planning.history import History

STEPS = 3
FACTS = ["start(1).", "goal(3).", "way(1,2).", "way(2,3).", "way(1,3).", "shut(2).", "shut(3)."]
TOLD = ["closed(2)", "closed(3)"]
RULES = """
at(P,0) :- start(P).
#program cumulative(t).
#external closed/1.
at(B,t) :- _action_lib(go,B,t).
at(A,t) :- at(A,t-1), not moved(t).
moved(t) :- _action_lib(go,B,t).
"""
CHOICES = [
    "{ _action_lib(go,B,t) : way(A,B), at(A,t-1) } 1.",
    "{ _action_lib(go,B,t) : way(A,B), at(A,t-1) }.",
    "1 { _action_lib(go,B,t) : way(A,B) } 1 :- at(1,t-1), A=1.",
]
FREE = "{ _action_lib(go,B,t) : way(A,B), at(A,t-1) }."
CONSTRAINTS = [
    ":- _action_lib(go,B,t), shut(B).",
    ":- _action_lib(go,B,t), closed(B).",
    ":- _action_lib(go,B,t), B > 2.",
    ":- not moved(t), t = 1.",
    ":- moved(t), t = 2.",
    ":- moved(t), moved(t-1).",
    "not _action_lib(go,2,t) :- t > 1.",
    ":- 2 { at(P,t) }.",
]
VOLATILE = [":- goal(G), not at(G,t).", ":- t < 2.", ":- at(1,t).", ":- #count { P : at(P,t) } = N, N != 1."]


class Case:
    """A program of one rule a line; what is kept of it is asked of clingo, with each horizon on its own."""

    def __init__(self, facts, told, choice, constraints, volatile):
        self.facts, self.told, self.choice = facts, told, choice
        self.constraints, self.volatile = constraints, volatile
        bounded = [choice] if choice != FREE else []
        self.rules = [*bounded, *constraints, *volatile]

    @property
    def text(self):
        return self._text(self.facts, self.choice, self.constraints, self.volatile)

    @staticmethod
    def _text(facts, choice, constraints, volatile):
        return "\n".join([*facts, RULES, choice, *constraints, "#program volatile(t).", *volatile, ""])

    def has_plan(self, rules=None, facts=None, told=None):
        rules, facts = self.rules if rules is None else rules, self.facts if facts is None else facts
        choice = self.choice
        if choice not in rules:
            choice = choice.replace("} 1", "}").replace("1 {", "{")
        text = self._text(
            [*facts, *(f"{one}." for one in (self.told if told is None else told))],
            choice,
            [one for one in self.constraints if one in rules],
            [one for one in self.volatile if one in rules],
        ).replace("#external closed/1.", "#defined closed/1.")
        return any(_has_answer(text, horizon) for horizon in range(1, STEPS + 2))

    def explain(self):
        program = ReactiveProgram.from_text(self.text, "case.lp")
        facts = "".join(f"{one}. " for one in self.told)
        return explain(program, Stream(History(), parse_update(f"#step 1. {facts}#endstep."), STEPS))


def _has_answer(text, horizon):
    control = clingo.Control(["-Wnone"])
    control.add("base", [], text)
    steps = [("cumulative", [clingo.Number(step)]) for step in range(1, horizon + 1)]
    control.ground([("base", []), *steps, ("volatile", [clingo.Number(horizon)])])
    return bool(control.solve().satisfiable)


def some(things, most):
    return st.lists(st.sampled_from(things), max_size=most, unique=True).map(lambda few: sorted(few, key=things.index))


CASES = st.builds(
    Case,
    st.lists(st.sampled_from(FACTS[2:]), min_size=2, max_size=5, unique=True).map(lambda more: [*FACTS[:2], *more]),
    some(TOLD, 2),
    st.sampled_from(CHOICES),
    some(CONSTRAINTS, 5),
    some(VOLATILE[1:], 1).map(lambda more: [VOLATILE[0], *more]),
)


def check(case):
    found = case.explain()
    assert (found is None) == case.has_plan()
    if found is None:
        return None
    assert WhyNot.from_message(found.to_message()) == found
    assert found.complete
    assert found.smallest
    rules = [one.rule.text for one in found.rules]
    assert set(rules) <= set(case.rules)
    assert not case.has_plan(rules)
    for rule in rules:
        assert case.has_plan([one for one in rules if one != rule]), f"{rule} is of no matter"
    for fewer in combinations(case.rules, len(rules) - 1) if rules else ():
        assert case.has_plan(fewer), f"{fewer} are enough"
    check_what_else(case, found)
    check_facts(case, found, rules)
    return found


def check_what_else(case, found):
    for one in found.rules:
        gone = [one.rule.text, *(other.text for other in one.besides)]
        assert case.has_plan([rule for rule in case.rules if rule not in gone])
        for back in gone:
            assert not case.has_plan([rule for rule in case.rules if rule not in gone or rule == back])


def check_facts(case, found, rules):
    told = [one.text[:-1] for one in found.told]
    facts = [one.text for one in found.facts]

    def some_told(few):
        return case.has_plan(rules, None, few)

    def some_facts(few):
        return case.has_plan(rules, few)

    check_each(told, case.told, some_told)
    check_each(facts, case.facts, some_facts)


def check_each(named, everything, has_plan):
    """There is a plan without any one of those that are named, with all others or with those named alone."""
    alone = all(has_plan([one for one in everything if one != fact]) for fact in named)
    together = not has_plan(named) and all(has_plan([one for one in named if one != fact]) for fact in named)
    assert alone or together
    if alone:
        assert {one for one in everything if has_plan([other for other in everything if other != one])} == set(named)


@pytest.mark.slow
@pytest.mark.once
@settings(max_examples=max(5, settings.default.max_examples // 3))
@given(CASES)
def test_reasons_hold_and_none_of_them_is_idle(case):
    check(case)


def names(found):
    return [one.rule.text for one in found.rules]


@pytest.mark.slow
def test_a_constraint_is_named_with_the_fact_that_it_needs():
    found = check(Case(FACTS[:4], [], CHOICES[0], CONSTRAINTS[:3], VOLATILE[:1]))
    assert names(found) == [CONSTRAINTS[2], VOLATILE[0]]
    found = check(Case([*FACTS[:4], "shut(2)."], [], CHOICES[0], CONSTRAINTS[:2], VOLATILE[:1]))
    assert names(found) == [CONSTRAINTS[0], VOLATILE[0]]
    assert "shut(2)." in [one.text for one in found.facts if one.hinders]
    assert found.plan.actions == ("_action_lib(go,2,1)", "_action_lib(go,3,2)")
    assert found.rules[0].breach == (1, {"B": "2"})
    assert found.rules[0].steps == (1, 2, 3)


@pytest.mark.slow
def test_a_fact_of_the_stream_is_named_like_one_of_the_program():
    found = check(Case(FACTS[:4], TOLD, CHOICES[0], CONSTRAINTS[:2], VOLATILE[:1]))
    assert names(found) == [CONSTRAINTS[1], VOLATILE[0]]
    assert [(one.text, one.hinders) for one in found.told] in ([("closed(2).", True)], [("closed(3).", True)])


def test_a_bound_of_a_choice_may_be_to_blame():
    found = check(Case(FACTS[:5], [], CHOICES[0], [], [VOLATILE[0], ":- not at(2,t)."]))
    assert names(found) == [CHOICES[0], VOLATILE[0], ":- not at(2,t)."]


@pytest.mark.slow
def test_what_would_forbid_it_as_well_is_told():
    found = check(Case([*FACTS[:4], "shut(2)."], ["closed(2)"], CHOICES[0], CONSTRAINTS[:2], VOLATILE[:1]))
    besides = {one.rule.text: [other.text for other in one.besides] for one in found.rules}
    first, second = CONSTRAINTS[:2]
    assert besides in ({first: [second], VOLATILE[0]: []}, {second: [first], VOLATILE[0]: []})
