"""Random control programs: the translated rules allow exactly the traces of the semantics."""

import pytest
from golog_interpreter import Interpreter
from golog_programs import FLUENTS, PROCEDURES, Toy, conditions, programs
from golog_text import program_text
from golog_traces import encoded_traces
from hypothesis import given, settings
from hypothesis import strategies as st

from rosoclingo.golog import translate

RUNS = settings(max_examples=max(1, settings.default.max_examples // 3))

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
STATES = st.frozensets(st.sampled_from(FLUENTS))


def interrupts_end(program):
    """Rewrite ``every`` for the interpreter like the text does: interrupts that can end at once, before an await."""
    if isinstance(program, tuple):
        inner = tuple(interrupts_end(one) for one in program)
        if inner[:1] == ("every",):
            return ("prio", ("prio", inner, ("await", ("less", 0, 1))), ("nil",))
        return inner
    return program


def check(program, state, longest):
    """Compare the traces of the translated text with those of the interpreter."""
    text = program_text("main", program)
    rules = translate(text, "main.golog").text.replace("#program cumulative(_step).", "").replace("_step", "t")
    wanted = Interpreter(Toy, PROCEDURES).traces(interrupts_end(program), state, longest)
    assert encoded_traces(("call", "main", ()), state, longest, rules) == wanted


@pytest.mark.slow
@RUNS
@given(programs(), STATES, st.integers(0, 3))
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


@pytest.mark.slow
@RUNS
@given(asking, STATES)
def test_conditions_have_the_truth_values_of_the_interpreter(program, state):
    check(program, state, 1)
