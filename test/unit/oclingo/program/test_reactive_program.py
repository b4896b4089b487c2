"""Reactive programs: parts, directives, constants, and complete lists of faults with file, line and fix."""

import pytest

from rosoclingo.oclingo import ProgramError, ReactiveProgram, ReactiveSolver, parse_update

STEPS = "#program cumulative(t).\n{ m(t) }.\n#program volatile(t).\n"


def faults(text, **constants):
    with pytest.raises(ProgramError) as caught:
        ReactiveProgram.from_text(text, "p.lp", constants)
    return [(fault.file, fault.line, str(fault)) for fault in caught.value.faults]


def answers(text, update, constants=None):
    result = ReactiveSolver(ReactiveProgram.from_text(text, constants=constants), models=0).update(parse_update(update))
    return sorted(" ".join(sorted(map(str, answer))) for answer in result.answers)


BC = "#program cumulative(t). b(t). #program volatile(t). c(t). "


@pytest.mark.parametrize(
    ("text", "step", "answer"),
    [
        # parts
        ("a. #cumulative t. b(t). #volatile k. c(k). #base. d.", "1 : 0.", "a b(1) c(1) d"),
        ("#iinit 0. #iinit (2 - |-3|)/2 + 1. #cumulative t. b(t).", "1 : 0.", "b(1)"),
        # volatile parts
        *(
            (f"#program cumulative(t). b(t). {part} c(t) :- b(t).", "3 : 0.", "b(1) b(2) b(3) c(3)")
            for part in ("#program volatile(t).", "#volatile t.", "#volatile t : 1.", "#volatile t : 4/3.")
        ),
        (BC + "#show. #show x(t) : b(t).", "2 : 0.", "x(2)"),
        (BC + "#defined q/1. #const n = 1. #project b/1.", "2 : 0.", "b(1) b(2) c(2)"),
    ],
)
def test_program_has_the_expected_answer(text, step, answer):
    assert answers(text, f"#step {step} #endstep.") == [answer]


def test_program_replaces_constants_by_given_terms():
    assert answers("#const n = 2. #cumulative t. a(n).", "#step 1 : 0. #endstep.", {"n": "f(x)"}) == ["a(f(x))"]


def test_invalid_characters_are_reported_with_their_place():
    with pytest.raises(ProgramError) as caught:
        ReactiveProgram.from_text("a.\n%* x\n*% b.\n  c § d.\n" + STEPS, "p.lp")
    assert (caught.value.faults[0].line, caught.value.faults[0].column) == (4, 5)


def test_program_includes_files_that_include_each_other(tmp_path):
    (tmp_path / "main.lp").write_text('#include "world.lp".\n#cumulative t. b(t).\n', encoding="utf-8")
    (tmp_path / "world.lp").write_text('a.\n#include "main.lp".\n', encoding="utf-8")
    program = ReactiveProgram.from_files([tmp_path / "main.lp"])
    result = ReactiveSolver(program).solve()
    assert sorted(map(str, result.answers[0])) == ["a", "b(1)"]


@pytest.mark.parametrize("named", [("main.lp", "world.lp"), ("world.lp", "world.lp", "main.lp")])
def test_file_both_included_and_named_loads_once(tmp_path, named):
    (tmp_path / "main.lp").write_text('#include "world.lp".\n#program cumulative(t). b(n,t).\n', encoding="utf-8")
    (tmp_path / "world.lp").write_text("#const n = 2.\n", encoding="utf-8")
    program = ReactiveProgram.from_files([tmp_path / name for name in named])
    assert list(map(str, ReactiveSolver(program).solve().answers[0])) == ["b(2,1)"]


def test_program_reports_all_faults_at_once():
    found = faults("a(X) :- b(Y).\n_request(x).\nc(X) :- not d(X).\n" + STEPS)
    assert [line for _, line, _ in found] == [2, 1, 3]
    assert "_request(Goal,C)" in found[0][2]
    assert "unsafe variable X in a(X)" in found[1][2]
    assert "domain" in found[2][2]


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("a :- b(.\n" + STEPS, 1, "syntax error"),
        *(
            (f"#program {part}.\n", 1, f"unknown program part {part} (")
            for part in ("foo", "base(t)", "cumulative", "volatile(t,s)")
        ),
        ("#volatile t : w.\n", 1, "'w' is not a number"),
        ("#iinit x.\n", 1, "'x' is not a number"),
        (STEPS + "_action_lib(a,b) :- m(1).\n", 4, "_action_lib(Action,Parameter,C)"),
        ("_action_lib(a,b,1).\n", 0, "no cumulative part"),
        (STEPS + "#program cumulative(t).\nw :- m(t).\n", 5, "redefinition: w is defined by the rules of two steps"),
        (
            "#program cumulative(t).\n#external e(t).\n_status(1,accepted,t) :- e(t+1).\n#program volatile(t).\n",
            3,
            "write #external e(t+1).",
        ),
        (
            "_status(1,accepted,1) :- e(1).\n#program cumulative(t).\n#external e(t).\n",
            1,
            "used in base but declared in steps",
        ),
        ('#include "nowhere.lp".\n' + STEPS, 1, "nowhere.lp"),
        ("#begin_lua\n#end_lua.\n" + STEPS, 1, "scripts"),
    ],
)
def test_program_faults_name_line_and_fix(text, line, words):
    found = faults(text)
    assert any(place == line and words in message for _, place, message in found), found


def test_program_reports_invalid_names_and_values_of_constants():
    assert "'N' is not a valid name" in faults("a.", N="1")[0][2]
    assert "the value is not a term: X is a variable" in faults("a.", n="X")[0][2]


def test_program_reports_missing_and_undecodable_files(tmp_path):
    (tmp_path / "bytes.lp").write_bytes(b"a.\xff")
    with pytest.raises(ProgramError, match="not UTF-8 text"):
        ReactiveProgram.from_files([tmp_path / "bytes.lp"])
    with pytest.raises(ProgramError, match="can't be read"):
        ReactiveProgram.from_files([tmp_path / "none.lp"])


def test_search_for_redefinitions_ends_without_a_result():
    """The check is abandoned if only a complete grounding could decide it."""
    text = STEPS + "#program cumulative(t).\nn(0) :- t > 1.\nn(X+1) :- n(X), X < 2000000000.\n"
    assert ReactiveProgram.from_text(text).parts
