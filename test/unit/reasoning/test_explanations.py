from clingo import parse_term

from rosoclingo.reasoning.explanations import explanations_in


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
