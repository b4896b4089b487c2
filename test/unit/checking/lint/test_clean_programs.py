"""The lint has no findings in correct programs: shipped ones, those of the documents, and oClingo's."""

import lint_programs
import pytest


@pytest.mark.sampled(13)
@pytest.mark.slow
@pytest.mark.parametrize("name", lint_programs.NAMES)
def test_lint_has_no_findings_in_correct_programs(name):
    assert list(map(str, lint_programs.lint(lint_programs.program(name)))) == []
