"""Errors in control programs: places, messages and fixes. Any text is either translated or has errors."""

import subprocess
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st
from shipped import ENCODINGS

from rosoclingo.golog import translate
from rosoclingo.golog.golog_command import main
from rosoclingo.oclingo import ProgramError, ReactiveProgram
from rosoclingo.oclingo.grammars import DEEPEST as DEPTH
from rosoclingo.oclingo.program.sources import Source

FAULTS = [
    ("proc p { a", 1, 8, "the bracket '{' is never closed", "write }"),
    ("a;", 1, 1, "'a' outside a procedure", "write proc NAME(X)"),
    ("proc p(x) { }", 1, 8, "expected a variable after '(', found 'x'", "upper-case letter"),
    (
        "proc while { }",
        1,
        6,
        "expected the procedure's name after 'proc', found the keyword 'while'",
        "lower-case letter",
    ),
    ("proc p { else { } }", 1, 10, "expected a statement after '{', found 'else'", "directly after"),
    ("proc p { a(X); }", 1, 12, "variable X is unbound", "pick"),
    ("proc p { test 3; }", 1, 15, "expected a condition, found a term", "write =, !=, <"),
    ("proc p { test (f and g) + 1 < 2; }", 1, 16, "expected a term, found a condition", "a number"),
    ("proc p { f?; }", 1, 11, "'?' is not part of the language", "test"),
    ('proc p { a("x); }', 1, 12, "the string does not end on its line", 'write "'),
    ("proc p { pick X: not f(X) { a; } }", 1, 15, "no fluent determines the values of X", "1..3"),
    ("proc p { test some X: X > 3; }", 1, 20, "no fluent determines the values of X", "1..3"),
    ("proc p { retry { a; } }", 1, 16, "expected the number of attempts after 'retry', found '{'", "retry 3"),
    ("proc p { do { a; } }", 1, 20, "expected 'on cancel' after '}', found '}'", "on cancel"),
    (
        "proc p { interrupts { when f { a; } } b; }",
        1,
        39,
        "expected 'until' after '}', found 'b'",
        "until CONDITION; after the interrupts: they end when it holds",
    ),
    ("proc p { test all X: f(X); }", 1, 26, "expected '->' after ')', found ';'", "write ->"),
    ("proc p { q(1); }\nproc q { }", 1, 10, "procedure q has 0 arguments, not 1", "number of arguments"),
    ("proc p { }\nproc p { }", 2, 6, "procedure p with 0 arguments is already defined in line 1", "rename"),
    ("proc p(X,X) { }", 1, 10, "two parameters X", "rename"),
    ("proc p { test g;\n  a(2147483647, 2147483648); }", 2, 17, "the number 2147483648 is too large", "2147483647"),
    ("proc p { p; }", 1, 10, "p can call itself endlessly without an action in between", "action"),
    ("proc p { test " + "(" * DEPTH + "f" + ")" * DEPTH + "; }", 1, None, "nesting is too deep", "procedures"),
    ("proc p { any order { a; }" + " and { b; }" * 20 + " }", 1, 6, "21 parts in any order", "at most 20"),
    ("proc p(X) { test X == 2; }", 1, 20, "'==' is not part of the language", "write ="),
    ("include 'x.lp';", 1, 9, "'x.lp' is not a string", 'write "x.lp"'),
    ("proc p { if f { a; } esle { b; } }", 1, 22, "'esle' is not a keyword", "did you mean else?"),
    ('include "x.lp"', 1, 15, "expected ';' after '\"x.lp\"', found the end of the file", "write ;"),
]


@pytest.mark.parametrize(("text", "line", "column", "message", "remedy"), FAULTS)
def test_translate_reports_place_message_and_fix(text, line, column, message, remedy):
    with pytest.raises(ProgramError) as caught:
        translate(text, "x.golog")
    fault = caught.value.faults[0]
    assert (fault.file, fault.line) == ("x.golog", line)
    assert fault.column == (fault.column if column is None else column)
    assert message in fault.message
    assert remedy in fault.remedy


def test_translate_reports_all_errors_at_once():
    with pytest.raises(ProgramError) as caught:
        translate("proc p { a(X); }\nproc q { if }\nproc r { ? }\nproc s { s; }", "x.golog")
    assert [fault.line for fault in caught.value.faults] == [1, 2, 3, 4]


def translate_procedure(head, body):
    """Translate a program with a single procedure."""
    return translate(f"proc {head} {{ {body} }}", "x.golog")


@pytest.mark.parametrize(
    ("head", "body"),
    [
        ("p(I, N)", "test I < N; p(I + 1, N);"),
        ("p(X, N)", "pick Y: f(Y, X) and N > 0 { choose { p(Y, N - 1); } or { try { p(X, N - 1); } else { } } }"),
    ],
)
def test_recursion_that_counts_to_a_bound_is_accepted(head, body):
    translate_procedure(head, body)


@pytest.mark.parametrize(
    ("head", "body"),
    [
        ("p(N)", "if N > 0 { p(N); }"),
        ("p(N)", "if N > 0 or f { p(N - 1); }"),
        ("p(N)", "if N != 0 { p(N - 1); }"),
        ("p(N)", "if N > 0 { pick N: f(N) { p(N - 1); } }"),
        ("p(N, M)", "if N > 0 and M > 0 { choose { p(N - 1, M + 1); } or { p(N + 1, M - 1); } }"),
    ],
)
def test_recursion_that_can_pass_its_bound_is_rejected(head, body):
    with pytest.raises(ProgramError, match="can call itself endlessly"):
        translate_procedure(head, body)


WORDS = "proc p q { } ( ) ; , X Y f(X) a 1 .. = < if else while pick choose or any order and not some in : -> test"


@given(st.lists(st.sampled_from(WORDS.split()), max_size=25).map(" ".join) | st.text(max_size=30))
def test_any_text_is_translated_or_has_errors(text):
    try:
        translate("proc p { " + text, "x.golog")
    except ProgramError as error:
        for fault in error.faults:
            assert fault.line >= 1, fault
            assert fault.column >= 1, fault
            assert fault.message, fault
            assert fault.remedy, fault


def test_missing_file_is_reported_at_its_include():
    with pytest.raises(ProgramError) as caught:
        ReactiveProgram([Source("mail.golog", '\n\ninclude "nowhere.lp";')])
    assert [(one.file, one.line) for one in caught.value.faults] == [("mail.golog", 3)]


@pytest.mark.slow
@pytest.mark.parametrize(("name", "text"), [("mail.golog", "proc p { a; }"), ("old.lp", "#hide.")])
def test_missing_lark_is_reported_with_install_command(name, text):
    code = "import sys; sys.modules['lark'] = None\nfrom rosoclingo.oclingo import ReactiveProgram\n"
    code += f"from rosoclingo.oclingo.program.sources import Source\nReactiveProgram([Source({name!r}, {text!r})])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False, timeout=120)
    assert "ProgramError: lark: not installed" in done.stderr
    assert done.stderr.rstrip().endswith("(python3 -m pip install 'lark>=1.1.5')")


# ---- the command -----------------------------------------------------------------------------------------------------


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "good.golog").write_text("proc p { a; }\n")
    return tmp_path


def test_command_prints_the_translation(folder, capsys):
    assert main([str(folder / "good.golog")]) == 0
    assert "golog_body(p,do(a),_step) :- golog_call(p,_step).\n" in capsys.readouterr().out


def test_command_with_check_prints_no_translation(folder, capsys):
    assert main(["--check", str(folder / "good.golog"), str(ENCODINGS / "golog" / "elevator.golog")]) == 0
    assert capsys.readouterr().out == ""


def test_command_reports_a_missing_file(folder, capsys):
    assert main([str(folder / "none.golog"), str(folder / "good.golog")]) == 2
    assert "can't be read" in capsys.readouterr().err
