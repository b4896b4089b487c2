"""The possible values of arguments: complete, and as precise as the rules allow."""

import clingo
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rosoclingo.checking.lint.argument_values import ArgumentValues
from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.oclingo.progression.terms import signature_of

STEPS = "\n#program cumulative(t).\n{ act(t) }.\n#program volatile(t).\n"


def program(text):
    return ReactiveProgram.from_text(text + STEPS)


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
