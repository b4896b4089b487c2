import pytest
from clingo import parse_term

from rosoclingo.reasoning.explanations import explanations_in, text_of
from rosoclingo.reasoning.keywords import action_of
from rosoclingo.reasoning.observations import Observation


@pytest.mark.parametrize(
    ("term", "text"),
    [
        ('"no way"', "no way"),
        ("f(a,1)", "f(a,1)"),
        ('("package ",3," is not at ",office2)', "package 3 is not at office2"),
        ("()", ""),
        ('f("a")', 'f("a")'),
    ],
)
def test_explanation_terms_become_text(term, text):
    assert text_of(parse_term(term)) == text


def test_explanation_that_came_last_counts():
    atoms = [
        "_explain(1,old,2)",
        "_explain(1,new,10)",
        "_explain(1,older,1)",
        '_explain(_return(go,blocked,3),"shut",3)',
        "_explain(3,early,1)",
        "_explain(3,late,7)",
        "_other(1,2)",
    ]
    explanations, faults = explanations_in(frozenset(parse_term(atom) for atom in atoms))
    assert explanations[parse_term("1")] == "new"
    assert explanations[parse_term("_return(go,blocked,3)")] == "shut"
    assert explanations[parse_term("3")] == "late"
    assert parse_term("2") not in explanations
    assert faults == []


def test_explanation_of_failure_with_two_candidate_actions():
    actions = tuple(action_of(parse_term(f"_action_lib(go,{what},3)")) for what in "ab")
    seen = Observation(parse_term("_return(go,lost,3)"), 3, actions)
    assert str(seen) == "go(a) or go(b) returned lost in cycle 3"
    assert {str(fact) for fact in seen.facts} == {
        *("_return(go,lost,3)", "_action_lib(go,a,3)", "_action_lib(go,b,3)"),
    }
