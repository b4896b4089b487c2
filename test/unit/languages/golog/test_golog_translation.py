"""Control programs as text: what they are translated to means what they say."""

import pytest
from golog_interpreter import Interpreter
from golog_programs import FLUENTS, PROCEDURES, Toy, conditions, programs
from golog_text import program_text
from golog_traces import encoded_traces
from hypothesis import given, settings
from hypothesis import strategies as st

from rosoclingo.languages.golog import translate

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
    """The text has no interrupts alone: those that end at once are the definitions' ``every``, before an await."""
    if isinstance(program, tuple):
        inner = tuple(interrupts_end(one) for one in program)
        if inner[:1] == ("every",):
            return ("prio", ("prio", inner, ("await", ("less", 0, 1))), ("nil",))
        return inner
    return program


def check(program, state, longest):
    """The translated text allows the traces that the definitions allow."""
    text = program_text("main", program)
    rules = translate(text, "main.golog").text.replace("#program cumulative(_step).", "").replace("_step", "t")
    wanted = Interpreter(Toy, PROCEDURES).traces(interrupts_end(program), state, longest)
    assert encoded_traces(("call", "main", ()), state, longest, rules) == wanted


@pytest.mark.slow
@RUNS
@given(programs(), STATES, st.integers(0, 3))
def test_traces_are_those_of_the_definitions(program, state, longest):
    check(program, state, longest)


def test_long_rows_are_whole():
    """Of a row only so much is in one term; what is behind it is left after that."""
    names = "acaccaacacac"
    program = ("do", (names[-1],))
    for name in reversed(names[:-1]):
        program = ("seq", ("do", (name,)), program)
    check(program, frozenset(), len(names))


@pytest.mark.slow
@RUNS
@given(asking, STATES)
def test_conditions_mean_what_they_say(program, state):
    check(program, state, 1)
