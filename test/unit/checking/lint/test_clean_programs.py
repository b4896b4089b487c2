"""The lint says nothing of programs in which nothing is wrong: the shipped ones, those of the documents, oClingo's."""

import lint_programs
import pytest


@pytest.mark.slow
@pytest.mark.once
@pytest.mark.parametrize("name", lint_programs.NAMES)
def test_nothing_is_said_of_a_program_that_is_right(name):
    assert list(map(str, lint_programs.lint(lint_programs.program(name)))) == []
