"""Checks of a program beyond those of clingo, and their messages."""

import pytest

from rosoclingo.oclingo import ProgramError, ReactiveProgram


def faults(text):
    with pytest.raises(ProgramError) as caught:
        ReactiveProgram.from_text(text, "p.lp")
    return [str(fault) for fault in caught.value.faults]


@pytest.mark.parametrize(
    ("text", "missing"),
    [
        ("#program cumulative(t). #program volatile(t).", []),
        ("#program cumulative(t). p(t).", ["volatile"]),
        ("#program volatile(t).", ["cumulative"]),
        ("p.", ["cumulative", "volatile"]),
    ],
)
def test_program_warns_about_missing_but_not_empty_parts(text, missing):
    found = ReactiveProgram.from_text(text, "p.lp").warnings
    assert [one.split(" (")[0] for one in found] == [f"p.lp: the program has no {name} part" for name in missing]


@pytest.mark.parametrize("header", ["volatile", "volatile(t,s)", "cumulative", "cumulative(t,s)", "base(t)", "foo"])
def test_program_reports_parts_with_wrong_parameters(header):
    (found,) = faults(f"#program {header}.\na :- b.\n#show a/0.\n")
    assert found.startswith(f"p.lp:1:1: unknown program part {header} (")


@pytest.mark.parametrize(
    ("rules", "late"),
    [
        ("c(t) :- e(t+1).", ["e(t+1)"]),
        ("#external f(t) : e(t+1).", ["e(t+1)"]),
        ("#program base. c :- e(3).", ["e(3)"]),
    ],
)
def test_program_warns_about_externals_declared_too_late(rules, late):
    program = ReactiveProgram.from_text(f"#program cumulative(t). #external e(t). {rules} #program volatile(t).")
    found = [one for one in program.warnings if "declared" in one]
    assert [one.split("external ")[1].split(" is")[0] for one in found] == late
