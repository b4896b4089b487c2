"""Random control programs: the translated rules allow exactly the traces of the semantics."""

import pytest
from golog_interpreter import Interpreter
from golog_programs import FLUENTS, PROCEDURES, Toy, conditions, programs
from golog_traces import encoded_traces
from hypothesis import given, settings
from hypothesis import strategies as st

about_x = st.sampled_from([("h", "X"), ("not", ("h", "X"))])
quantified = st.recursive(
    conditions,
    lambda c: (
        st.tuples(st.just("some"), st.just("X"), st.just((1, 2)), about_x | st.tuples(st.just("and"), about_x, c))
        | st.tuples(st.just("not"), c)
        | st.tuples(st.sampled_from(["and", "or"]), c, c)
    ),
    max_leaves=4,
)
asking = st.tuples(st.sampled_from(["test", "await"]), quantified) | st.tuples(
    st.just("if"), quantified, st.just(("do", ("a",))), st.just(("do", ("c",)))
)


def check(program, state, longest):
    """Compare the traces that the translated text allows with those of the interpreter."""
    assert encoded_traces(program, state, longest) == Interpreter(Toy, PROCEDURES).traces(program, state, longest)


@pytest.mark.slow
@settings(max_examples=settings.default.max_examples * 4 // 3)
@given(programs() | programs() | asking, st.frozensets(st.sampled_from(FLUENTS)), st.integers(0, 3))
def test_translation_has_the_traces_of_the_interpreter(program, state, longest):
    check(program, state, longest)


def some(condition):
    """Return the condition that some value of X satisfies a condition."""
    return ("some", "X", (1, 2), condition)


@pytest.mark.parametrize(
    "condition",
    [
        ("and", some(("h", "X")), some(("not", ("h", "X")))),
        ("not", ("or", ("not", some(("h", "X"))), ("not", some(("not", ("h", "X")))))),
        some(("and", ("h", "X"), some(("not", ("h", "X"))))),
    ],
)
def test_quantifiers_have_separate_variables(condition):
    check(("test", condition), frozenset({("h", 1)}), 0)
