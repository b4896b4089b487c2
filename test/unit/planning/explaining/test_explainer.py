"""Explanations of infeasibility, checked by brute force with plain clingo on subsets of the rules and facts."""

from itertools import combinations

import clingo
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from stream_logs import stream_of

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.planning.explaining.explainer import explain

STEPS = 3
FACTS = ["start(1).", "goal(3).", "way(1,2).", "way(2,3).", "way(1,3).", "shut(2).", "shut(3)."]
STREAM = ["closed(2)", "closed(3)"]
RULES = """
at(P,0) :- start(P).
#program cumulative(t).
#external closed/1.
at(B,t) :- _action_lib(go,B,t).
at(A,t) :- at(A,t-1), not moved(t).
moved(t) :- _action_lib(go,B,t).
"""
FREE = "{ _action_lib(go,B,t) : way(A,B), at(A,t-1) }."
CHOICES = [
    "{ _action_lib(go,B,t) : way(A,B), at(A,t-1) } 1.",
    FREE,
    "1 { _action_lib(go,B,t) : way(A,B) } 1 :- at(1,t-1), A=1.",
    "#count { B : _action_lib(go,B,t) : way(A,B), at(A,t-1) } 1.",
]
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


def text_of(facts, choice, constraints, volatile):
    return "\n".join([*facts, RULES, choice, *constraints, "#program volatile(t).", *volatile, ""])


def has_answer(text, horizon):
    control = clingo.Control(["-Wnone"])
    control.add("base", [], text)
    steps = [("cumulative", [clingo.Number(step)]) for step in range(1, horizon + 1)]
    control.ground([("base", []), *steps, ("volatile", [clingo.Number(horizon)])])
    return bool(control.solve().satisfiable)


class Case:
    """A program with one rule per line, whose subsets plain clingo can solve for each horizon."""

    def __init__(self, facts, stream=(), choice=CHOICES[0], constraints=(), volatile=VOLATILE[:1]):
        self.facts, self.stream, self.choice = facts, stream, choice
        self.constraints, self.volatile = constraints, volatile
        self.rules = [*([choice] if choice != FREE else []), *constraints, *volatile]

    def has_plan(self, rules=None, facts=None, stream=None):
        rules, facts = self.rules if rules is None else rules, self.facts if facts is None else facts
        choice = self.choice if self.choice in rules else self.choice.replace("} 1", "}").replace("1 {", "{")
        text = text_of(
            [*facts, *(f"{one}." for one in (self.stream if stream is None else stream))],
            choice,
            [one for one in self.constraints if one in rules],
            [one for one in self.volatile if one in rules],
        ).replace("#external closed/1.", "#defined closed/1.")
        return any(has_answer(text, horizon) for horizon in range(1, STEPS + 2))

    def explain(self):
        text = text_of(self.facts, self.choice, self.constraints, self.volatile)
        facts = "".join(f"{one}. " for one in self.stream)
        return explain(ReactiveProgram.from_text(text, "case.lp"), stream_of(f"#step 1. {facts}", STEPS))


def some(things, most):
    return st.lists(st.sampled_from(things), max_size=most, unique=True).map(lambda few: sorted(few, key=things.index))


CASES = st.builds(
    Case,
    st.lists(st.sampled_from(FACTS[2:]), min_size=2, max_size=5, unique=True).map(lambda more: [*FACTS[:2], *more]),
    some(STREAM, 2),
    st.sampled_from(CHOICES),
    some(CONSTRAINTS, 5),
    some(VOLATILE[1:], 1).map(lambda more: [VOLATILE[0], *more]),
)


def all_but(things, *removed):
    return [one for one in things if one not in removed]


def check(case):
    """Check that the explanation has the fewest conflicting rules, and that its other statements are true."""
    found = case.explain()
    assert (found is None) == case.has_plan()
    if found is None:
        return None
    assert found.complete
    assert found.smallest
    rules = [one.rule.text for one in found.rules]
    assert set(rules) <= set(case.rules)
    assert not case.has_plan(rules)
    for fewer in combinations(case.rules, len(rules) - 1) if rules else ():
        assert case.has_plan(fewer), f"{fewer} are enough"
    for one in found.rules:
        removed = [one.rule.text, *(other.text for other in one.besides)]
        assert case.has_plan(all_but(case.rules, *removed))
        for restored in removed:
            assert not case.has_plan([*all_but(case.rules, *removed), restored])
    check_facts([one.text[:-1] for one in found.stream_facts], case.stream, lambda few: case.has_plan(rules, None, few))
    check_facts([one.text for one in found.facts], case.facts, lambda few: case.has_plan(rules, few))
    return found


def check_facts(named, everything, has_plan):
    """Check that dropping any named fact permits a plan, given all other facts or only the named ones."""
    alone = all(has_plan(all_but(everything, fact)) for fact in named)
    together = not has_plan(named) and all(has_plan(all_but(named, fact)) for fact in named)
    assert alone or together
    if alone:
        assert {one for one in everything if has_plan(all_but(everything, one))} == set(named)


@pytest.mark.slow
@settings(max_examples=max(5, settings.default.max_examples // 3))
@example(Case(["start(1).", "goal(2).", "goal(3).", "way(1,2).", "way(1,3)."], choice=CHOICES[3]))
@given(CASES)
def test_explain_finds_the_fewest_conflicting_rules(case):
    check(case)
