"""Findings about keywords of the core and values of constants, and the comments that silence findings."""

import lint_programs
import pytest

from rosoclingo.checking.lint.linting import lint_program
from rosoclingo.oclingo import ReactiveProgram, parse_term
from rosoclingo.oclingo.program.constants import check_given_values
from rosoclingo.oclingo.program.sources import Source

EXTERNALS = "#external _request/2. #external _return/3."
HEEDED = ":- _request(X,1). :- _return(X,Y,1)."
ODD = "#cumulative t.\n#volatile t.\n"
CONSTANTS = """#const n = 3.
#const twice = 2*n.
#const start = office1.
#const low = -4.
#const zero = 0.
#const pair = (1,2).
#const odd = "x"+1.
#const back = 2*odd.
a(n,twice,start,low,free,f(g)) :- b(1..n)."""


IDLE = EXTERNALS + HEEDED + "#program cumulative(t). #program volatile(t). #program cumulative(t). "
STATUS = "_status(I,succeeded,t) :- _request(do(I),t)."


@pytest.mark.parametrize(
    "rules",
    [
        "1 { _action_lib(go,(a;b),t) } 1.",
        "{ _action_lib(go,(a;b),t) }. acts(t) :- _action_lib(A,P,t). :- not acts(t).",
        "{ _action_lib(go,a,t) }. _action_lib(rest,a,t) :- not _action_lib(go,a,t).",
    ],
)
def test_lint_reports_restless_programs_without_statuses(rules):
    assert [one.kind for one in lint_program(ReactiveProgram.from_text(IDLE + rules, "home.lp"))] == ["restless"]
    assert lint_program(ReactiveProgram.from_text(IDLE + rules + STATUS, "home.lp")) == []


STEPS = "#program cumulative(t). {{ x(t) }}. {} #program volatile(t). :- not p(t)."


@pytest.mark.parametrize(
    ("kind", "text"),
    [
        # actions only for goals
        ("restless", IDLE + "want(I,t) :- _request(do(I),t+1). 1 { _action_lib(go,(a;b),t) } 1 :- want(I,t)."),
        (
            "restless",
            IDLE + "w(t) :- _request(do(I),t+1). { _action_lib(go,a,t) }. :- w(t), not _action_lib(go,a,t).",
        ),
        # facts of initial steps
        ("first-step", "p(0). " + STEPS.format("p(t) :- p(S), S = t-1.")),
        ("first-step", "p(2). " + STEPS.format("p(t) :- p(t-1), t > 2. p(t) :- t < 2.")),
        # looks back at persistent atoms
        ("past-volatile", STEPS.format("p(t). #program volatile(t). end(t) :- p(t). :- not end(t).")),
        (
            "past-volatile",
            STEPS.format("p(t). end(t) :- p(t). #program volatile(t). end(t) :- x(t). :- not end(t-1), p(t)."),
        ),
        ("past-volatile", STEPS.format("p(t). #external end/1. #program volatile(t). end(t) :- p(t). :- end(t-1).")),
    ],
)
def test_lint_accepts_programs_that_only_look_wrong(kind, text):
    found = lint_program(ReactiveProgram.from_text(text, "home.lp"))
    assert [one for one in found if one.kind == kind] == []


@pytest.mark.parametrize(
    ("given", "found"),
    [
        ({"n": "7", "start": "office2", "low": "5", "free": "x"}, []),
        (
            {"n": "three"},
            [("constant-value", "n is three, but the program's own value is 3 (home.lp:1) (give a number)")],
        ),
        (
            {"n": "-1"},
            [("negative-constant", "own value is 3 (home.lp:1) (did you mean a negative number?)")],
        ),
        ({"pair": "7", "odd": "7", "back": "7"}, []),  # their values are not numbers
        ({"f": "1"}, [("unknown-constant", "the program has no #const f (its constants are")]),
        (
            {"twic": "1", "n": "f(x)"},
            [("unknown-constant", "#const twic (did you mean twice?)"), ("constant-value", "give a number")],
        ),
    ],
)
def test_lint_checks_the_values_of_constants(given, found):
    survey = ReactiveProgram.from_text(CONSTANTS, "home.lp").survey
    reported = check_given_values(survey, {name: parse_term(value) for name, value in given.items()})
    assert [one.kind for one in reported] == [kind for kind, _ in found]
    assert all(words in str(one) for one, (_, words) in zip(reported, found))


def test_lint_reports_a_constant_without_definition():
    found = lint_programs.lint([Source("home.lp", "a(1).\n#cumulative t.\n#volatile t.\n")], {"n": "1"})
    assert list(map(str, found)) == ["constant n: the program has no #const n (it has none) [unknown-constant]"]
    assert found[0].severity == "error"


def test_lint_places_translation_warnings():
    text = "p(1).\nq(F) :- p(F).\n#domain p(F).\n#show q/1.\n#cumulative t.\n#volatile t.\n"
    (one,) = lint_programs.lint([Source("old.lp", text)])
    assert (one.fault.kind, one.fault.line) == ("translation", 3)


@pytest.mark.parametrize(("running", "kinds"), [("#external _running/3.", []), ("", ["unused"])])
def test_lint_knows_that_the_planner_reads_durations(running, kinds):
    """A program whose actions go on can declare them without a rule that uses them."""
    rules = "_action_lib(go,a,t) :- not busy(t).\nbusy(t) :- _return(go,a,t).\n#show _action_lib/3.\n"
    text = f"{running}\n#external _takes/3.\n#external _return/3.\n#program cumulative(t).\n{rules}"
    found = lint_programs.lint([Source("p.lp", text)])
    assert [one.fault.kind for one in found if "_takes" in one.fault.message] == kinds


# ---- silenced findings -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "left"),
    [
        ("a :- b.", ["undefined"]),
        ("a :- b. % check: ok undefined", []),
        ("% check: ok undefined\na :- b.", []),
        ("a :- b. % check: ok unused", ["undefined"]),
        ("a :- b. % check: ok", ["silence", "undefined"]),
        ("a :- b. % check: ok undefind", ["silence", "undefined"]),
    ],
)
def test_comments_silence_findings_by_line(text, left):
    sources = [Source("p.lp", text + "\n" + ODD)]
    assert sorted(one.fault.kind for one in lint_programs.lint(sources)) == left


def test_comments_silence_no_errors():
    sources = [Source("p.lp", "#cumulative t.\n{ a(t) }.\nb :- a(t). % check: ok redefinition no-step\n#volatile t.\n")]
    assert [one.fault.kind for one in lint_programs.lint(sources)] == ["redefinition"]
