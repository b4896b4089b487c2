"""The possible values of arguments: complete, and as precise as the rules allow."""

import clingo
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rosoclingo.checking.lint.argument_values import ArgumentValues
from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.oclingo.progression.terms import Signature, signature_of
from rosoclingo.planning.explaining.atom_patterns import ANY
from rosoclingo.planning.explaining.reach import Reach

STEPS = "\n#program cumulative(t).\n{ act(t) }.\n#program volatile(t).\n"


def program(text):
    return ReactiveProgram.from_text(text + STEPS)


def values_of(one, name, arity, position):
    """Return the values of an argument as text, None for any."""
    reach, signature = Reach(one), Signature(name, arity)
    known = {atom.arguments[position] for atom in reach.atoms(signature)}
    return None if signature in reach.free or ANY in known else sorted(map(str, known))


@pytest.mark.parametrize(
    ("rules", "expected"),
    [
        ("p(a). p(b).", ["a", "b"]),
        ("p((a;b)). p(c;d).", ["a", "b", "c", "d"]),
        ("#const n = 2. p(n). p(-1). p(n*3).", ["-1", "2", "6"]),
        ("q(a). q(b). r(b). p(X) :- q(X), r(X).", ["b"]),
        ("q(a). p(f(X,X)) :- q(X).", ["f(a,a)"]),
        ("q(f(a)). q(g(b)). p(X) :- q(f(X)).", ["a"]),
        ("q(a;b;c). p(X) :- q(X), X != b.", ["a", "c"]),
        ("q(a). p(X) :- q(Y), X = (Y;b).", ["a", "b"]),
        ("q(a). 1 <= #sum { 1,X : p(X) : q(X) }. % dialect: clingo 5", ["a"]),
        (
            "#external _running/3. q(a;b). _action_lib(go,X,0) :- q(X). _action_lib(A,X,1) :- _running(A,X,0). "
            "p(X) :- _action_lib(go,X,1).",
            ["a", "b"],
        ),
        ("q(1). p(X+1) :- q(X).", None),
        ("q(a,1). q(b,x). p(X) :- q(a,X).", ["1"]),
        ("q(a,1). q(b,x). s(Y,X) :- q(Y,X). _action_lib(Y,X,1) :- s(Y,X). p(X) :- s(a,X).", ["1"]),
        ("q(1). r(f(X+1)) :- q(X). r(a). s(f(b)). p(X) :- r(X), s(X).", ["f(b)"]),
        ("p(a). p(X) :- p(Y), X = f(Y).", ["a", "f(__oclingo_any)"]),
        ("p(X) :- q(X). #defined q/1.", None),
        ("p(a). p(X) :- -q(X). -q(b).", ["a", "b"]),
        (
            "#external e/1. q(X) :- e(X). q(c). p(X) :- " + ", ".join(f"q(g({n}))" for n in range(9)) + ", r(X). r(a).",
            ["a"],
        ),
        ("q(a). r(b). p(X) :- q(X), r(X). p(c).", ["c"]),
    ],
)
def test_argument_values_follow_from_the_rules(rules, expected):
    assert values_of(program(rules), "p", 1, 0) == expected


@pytest.mark.parametrize("rules", ["p(X) :- q(X). q(X) :- p(X).", "p(X) :- q(X), X = b. q(a).", "p(a) :- q(b). q(a)."])
def test_argument_values_find_impossible_predicates(rules):
    assert not ArgumentValues(program(rules)).is_possible(Signature("p", 1))


def check(found, atoms):
    """Check that each atom has possible values."""
    for atom in atoms:
        signature = signature_of(atom)
        assert found.is_possible(signature), atom
        assert found.impossible_value(atom) is None, atom


TERM = st.sampled_from(
    ["a", "b", "c", "1", "2", "X", "Y", "f(X)", "f(a)", "g(X,b)", "1..2", "(a;b)", "X+1", "-X", "(X,a)"]
)
NAMES = st.sampled_from(["p", "q", "r", "-p"])
ATOM = st.builds("{}({})".format, NAMES, TERM) | st.builds("{}({},{})".format, NAMES, TERM, TERM)
TEST = st.builds("{} {} {}".format, TERM, st.sampled_from(["=", "!=", "<"]), TERM)
BODY = st.lists(ATOM | ATOM.map("not {}".format) | TEST, max_size=3)


def rule(head, body, choice):
    """Return a safe rule, whose variables range over a domain."""
    used = [name for name in "XY" if any(name in one for one in [head, *body])]
    bound = [f"d({name})" for name in used]
    return "{}{}{} :- {}.".format("{ " * choice, head, " }" * choice, "; ".join([*bound, *body]) or "#true")


RULES = st.lists(st.tuples(ATOM, BODY, st.booleans()), min_size=1, max_size=6)
DOMAIN = "d((a;b;c;1;2;f(a);f(b);(b,a);g(a,b))).\n"


@pytest.mark.slow
@given(RULES)
def test_argument_values_cover_all_derivable_atoms(rules):
    """Compare with the atoms that are derivable without negation."""
    positive = [rule(head, [one for one in body if not one.startswith("not ")], True) for head, body, _ in rules]
    control = clingo.Control(["--warn=none"], logger=lambda code, message: None)
    control.add("base", [], DOMAIN + "\n".join(positive))
    found = ArgumentValues(program(DOMAIN + "\n".join(rule(*one) for one in rules)))

    class Bounded(clingo.backend.Observer):
        left = 2000

        def rule(self, choice, head, body):
            self.left -= 1
            if self.left < 0:
                raise OverflowError

    control.register_observer(Bounded())
    try:
        control.ground([("base", [])])
    except OverflowError:
        return  # the grounding is infinite
    check(found, [one.symbol for one in control.symbolic_atoms])


FIXED, STEPPED = ["p({},{})", "q({},{})", "s(f({},{}))"], ["r({},{},t)", "r(({},{}),t)"]
ACTING = "_action_lib({},{},t)"
DEFINED = "p(a,b). q(b,c). s(f(c,a)).\n", "{ r(X,Y,t) } :- p(X,Y). { r((Y,X),t) } :- q(X,Y).\n"
VARIABLE = st.sampled_from("XYZ")


def joined(head, body):
    """Return a rule with the last and the first variable of its body in its head."""
    atoms = ", ".join(one.format(*names) for one, *names in body)
    return f"{{ {head.format(body[-1][2], body[0][1])} }} :- {atoms}."


def joins(heads, atoms):
    """Return a strategy for rules that join, swap and nest arguments."""
    body = st.lists(st.tuples(st.sampled_from(atoms), VARIABLE, VARIABLE), min_size=1, max_size=3)
    return st.lists(st.builds(joined, st.sampled_from(heads), body), min_size=1, max_size=3).map("\n".join)


CONSTANT = st.sampled_from("abc")
FACTS = st.lists(st.builds("p({0},{1}). q({1},{2}).".format, CONSTANT, CONSTANT, CONSTANT), max_size=3).map("\n".join)


@pytest.mark.slow
@given(FACTS, joins(FIXED, FIXED), joins([*STEPPED, ACTING, ACTING], [*FIXED, *STEPPED]))
def test_argument_values_of_actions_are_exact(facts, fixed, stepped):
    """Compare with the grounding of one step, for rules without negation and sums."""
    base, cumulative = f"{DEFINED[0]}{facts}\n{fixed}\n", f"{DEFINED[1]}{stepped}\n"
    control = clingo.Control(["--warn=none", "--const", "t=1"], logger=lambda code, message: None)
    control.add("base", [], base + cumulative)
    control.ground([("base", [])])
    expected = {tuple(one.symbol.arguments[:2]) for one in control.symbolic_atoms.by_signature("_action_lib", 3)}
    found = ArgumentValues(program(f"{base}#program cumulative(t).\n{cumulative}"))
    rows = {tuple(one.arguments[:2]) for number in range(len(found.rules)) for one in found.derived_by(number)}
    assert rows == expected
