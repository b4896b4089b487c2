"""Nodes keep their place in the source file, also in statements composed of other nodes."""

from clingo.ast import BodyAggregateElement, Position, Sign

from rosoclingo.oclingo.program.nodes import make, parse


def moved(text):
    """Return the statements of ``text``, moved ten lines down in a file."""
    statements = parse(text)
    for one in statements:
        one.move(lambda position: Position("file.lp", position.line + 10, position.column))
    return statements[1:]


def places(node):
    return [
        (one.text, one.location.begin.filename, one.location.begin.line)
        for one in node.nodes
        if hasattr(one, "location")
    ]


def test_move_changes_all_nodes_of_a_statement():
    (rule,) = moved("p(X,a) :-\n  q(f(X)),\n  X != 3.")
    assert ("X", "file.lp", 11) in places(rule.head)
    assert places(rule.body[0]) == [
        ("q(f(X))", "file.lp", 12),
        ("q(f(X))", "file.lp", 12),
        ("f(X)", "file.lp", 12),
        ("X", "file.lp", 12),
    ]
    (other,) = (one for one in rule.body[1].nodes if one.text == "3")
    assert other.location.end == Position("file.lp", 13, 9)


def test_update_copies_nodes_and_keeps_their_places():
    rule, other = moved("p(X) :- q(X).\nr(Y) :- s(Y).")
    assert "s(Y)" not in [one.text for one in rule.nodes]
    twin = rule.update(body=[*rule.body, *other.body])
    assert twin.text == "p(X) :- q(X); s(Y)."
    assert [one for one in places(twin) if one[0] in "XY"] == [
        ("X", "file.lp", 11),
        ("X", "file.lp", 11),
        ("Y", "file.lp", 12),
    ]
    assert "s(Y)" in [one.text for one in twin.nodes]
    negated = twin.body[1].update(sign=Sign.Negation)
    assert (negated.text, negated.sign) == ("not s(Y)", Sign.Negation)
    assert places(negated)[-1] == ("Y", "file.lp", 12)


def test_make_keeps_the_places_of_its_nodes():
    (rule,) = moved("p(X) :- q(X).")
    term = rule.head.atom.symbol.arguments[0]
    element = make(BodyAggregateElement, [term], [rule.body[0]])
    assert element.text == "X: q(X)"
    assert [one.location.begin.line for one in element.nodes if one.text == "X"] == [11, 11]
