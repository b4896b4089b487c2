"""Control programs: the encoding allows exactly the action sequences of the definitions."""

import pytest
from golog_interpreter import Interpreter
from golog_programs import FLUENTS, PROCEDURES, Toy, programs
from golog_traces import encoded_traces
from hypothesis import given, settings
from hypothesis import strategies as st

RUNS = settings(max_examples=settings.default.max_examples * 2 // 3)


@pytest.mark.slow
@RUNS
@given(programs(), st.frozensets(st.sampled_from(FLUENTS)), st.integers(0, 3))
def test_golog_traces_are_exactly_those_of_the_definitions(program, state, longest):
    assert encoded_traces(program, state, longest) == Interpreter(Toy, PROCEDURES).traces(program, state, longest)
