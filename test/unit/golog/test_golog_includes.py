"""Control programs that call procedures of included files."""

import pytest
from core_driver import Driver
from shipped import ENCODINGS

from rosoclingo.golog.golog_command import main
from rosoclingo.oclingo import ProgramError, ReactiveProgram
from rosoclingo.reasoning.settings import CoreSettings

DOMAIN = f"""
#include "{ENCODINGS}/golog.lp".
#program base.
act(a;b;c).
#program cumulative(t).
golog_action(A,act,A,t) :- act(A).
golog_holds(act(A),t) :- act(A).
:- 2 {{ _action_lib(A,X,t) }}.
"""


def files(folder, **texts):
    """Write files NAME.golog and their domain into a folder; return the path of the first file."""
    (folder / "domain.lp").write_text(DOMAIN)
    paths = [folder / f"{name}.golog" for name in texts]
    for path, text in zip(paths, texts.values()):
        path.write_text(text)
    return paths[0]


def done(program, goal):
    """Return the actions that a program executes for a goal."""
    driver, found = Driver(settings=CoreSettings(), program=program).goal("g", goal), []
    while driver.core.awaited:
        found.append(str(driver.core.awaited[0].parameter))
        driver.succeed()
    assert driver.states("g")[-1] == "succeeded"
    return " ".join(found)


def faults(path):
    """Return the errors of a program: file, line, column, message and fix."""
    with pytest.raises(ProgramError) as caught:
        ReactiveProgram.from_files([path])
    return [
        (one.file.rsplit("/", 1)[-1], one.line, one.column, f"{one.message} ({one.remedy})")
        for one in caught.value.faults
    ]


DAY = {
    "day": 'include "domain.lp"; include "round.golog"; proc day { if act(c) { round(2); } b; }',
    "round": 'include "more.golog"; proc round(N) { if N > 1 { a; round(N - 1); } else { more; } }',
    "more": "proc more { c; }",
}


@pytest.mark.slow
def test_procedures_of_included_files_are_called(tmp_path):
    program = ReactiveProgram.from_files([files(tmp_path, **DAY)])
    assert done(program, "run(day)") == "a c b"
    assert done(program, "run(round(3),1)") == "a a c"


@pytest.mark.parametrize(
    ("texts", "place", "message"),
    [
        (
            {"x": 'include "y.golog"; proc p { q(1); }', "y": "proc q { }"},
            ("x.golog", 1, 29),
            "y.golog has 0 arguments, not 1 (correct the number of arguments)",
        ),
        (
            {"x": 'include "y.golog";\nproc q { }', "y": "\nproc q { }"},
            ("x.golog", 2, 6),
            "y.golog, line 2 (rename one of them)",
        ),
        (
            {"x": 'include "y.golog"; proc p { }', "y": 'proc q { }\n\ninclude "x.golog";'},
            ("y.golog", 3, 9),
            "this file includes itself: x.golog, y.golog, x.golog (move shared procedures into a third file)",
        ),
        ({"x": 'include "x.golog";'}, ("x.golog", 1, 9), "this file includes itself (remove the include)"),
        (
            {"x": 'include "y.golog"; proc p { q; p; }', "y": "proc q { star { a; } }"},
            ("x.golog", 1, 32),
            "p can call itself endlessly without an action in between",
        ),
        (
            {"x": 'include "y.golog"; proc p { }', "y": "proc q { a b; }"},
            ("y.golog", 1, 12),
            "expected ';' after 'a', found 'b'",
        ),
        ({"x": 'proc p { }\n  include "y.golog";'}, ("x.golog", 2, 11), "included file 'y.golog' does not exist"),
    ],
)
def test_errors_have_file_line_and_column(tmp_path, texts, place, message):
    (found,) = faults(files(tmp_path, **texts))
    assert found[:3] == place
    assert message in found[3]


@pytest.mark.slow
def test_procedures_of_unrelated_files_are_not_called(tmp_path):
    """Names without an included procedure are actions; duplicate procedures are errors in any file."""
    path = files(tmp_path, x='include "domain.lp"; proc p { q; }', y="proc q { }", z="proc p { }")
    with pytest.raises(ProgramError, match=r"already defined in .*x\.golog, line 1"):
        ReactiveProgram.from_files([path, path.with_name("z.golog")])
    program = ReactiveProgram.from_files([path, path.with_name("y.golog")])
    driver = Driver(settings=CoreSettings(horizon_limit=3), program=program).goal("g", "run(p)")
    assert driver.states("g")[-1] == "aborted"


def test_command_follows_includes(tmp_path, capsys):
    path = files(tmp_path, x='include "y.golog"; proc p { q; }', y="proc q { a; }")
    assert main([str(path)]) == 0
    assert "golog_body(p,call(q),_step)" in capsys.readouterr().out
    path.with_name("y.golog").write_text("proc q {\n a b; }")
    assert main(["--check", str(path)]) == 1
    shown = capsys.readouterr().err.splitlines()
    assert shown[0].endswith("y.golog:2:4: expected ';' after 'a', found 'b' (write ;)")
    assert shown[1:] == ["     2 |  a b; }", "       |    ^"]


def test_command_rejects_files_of_other_languages(tmp_path, capsys):
    assert main([str(tmp_path / "x.lp")]) == 2
    assert "not the name of a control program (end the file name with .golog)" in capsys.readouterr().err
