import pytest
from clingo import parse_term

from rosoclingo.reasoning.explanations import Explanations, UnmetGoal, text_of
from rosoclingo.reasoning.goals import Goal
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
    explanations = Explanations(frozenset(parse_term(atom) for atom in atoms))
    assert explanations.of(parse_term("1")) == "new"
    assert explanations.of(parse_term("_return(go,blocked,3)")) == "shut"
    assert explanations.of(parse_term("3")) == "late"
    assert explanations.of(parse_term("2")) is None
    assert explanations.faults == []


def goal(text):
    return Goal(text, parse_term(text))


FAILED = Observation(parse_term("_return(go,blocked,3)"), 3, (action_of(parse_term("_action_lib(go,office4,3)")),))
TOLD = Observation(parse_term("_shut(d)"), 5)


@pytest.mark.parametrize(
    ("loss", "text"),
    [
        (UnmetGoal(goal("go(a,3)"), sure=False), "go(a,3) cannot be met: there is none"),
        (
            UnmetGoal(goal("go(a,3)"), (goal("go(b,2)"), goal("go(c,1)")), (TOLD,)),
            "go(a,3) cannot be met together with go(b,2) and go(c,1) since _shut(d) was reported in cycle 5",
        ),
        (
            UnmetGoal(goal("go(a,3)"), (), (FAILED, TOLD), sure=False),
            "go(a,3) cannot be met perhaps since go(office4) returned blocked in cycle 3"
            " and _shut(d) was reported in cycle 5",
        ),
    ],
)
def test_explanation_of_losses_in_generic_words(loss, text):
    assert loss.text(Explanations(), "there is none") == text


def test_explanation_of_losses_in_words_of_program():
    atoms = ['_explain(3,(office4," is unreachable"),5)', '_explain(_return(go,blocked,3),("the way was blocked"),3)']
    explanations = Explanations(frozenset(parse_term(atom) for atom in atoms))
    loss = UnmetGoal(goal("go(a,3)"), (goal("go(b,2)"),), (FAILED, FAILED, TOLD))
    assert loss.text(explanations, "") == (
        "go(a,3) cannot be met together with go(b,2): office4 is unreachable"
        " since the way was blocked and _shut(d) was reported in cycle 5"
    )


def test_explanation_of_failure_with_two_candidate_actions():
    actions = tuple(action_of(parse_term(f"_action_lib(go,{what},3)")) for what in "ab")
    seen = Observation(parse_term("_return(go,lost,3)"), 3, actions)
    assert str(seen) == "go(a) or go(b) returned lost in cycle 3"
    assert {str(fact) for fact in seen.facts} == {
        *("_return(go,lost,3)", "_action_lib(go,a,3)", "_action_lib(go,b,3)"),
    }
