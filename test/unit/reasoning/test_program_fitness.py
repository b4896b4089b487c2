"""Whether programs and constants are fit for the core, and what is said where they are not."""

import pytest
from shipped import ENCODINGS, shipped

from rosoclingo.oclingo import ReactiveProgram, parse_term
from rosoclingo.reasoning.program_fitness import constant_remarks, program_warnings

RULES = (ENCODINGS / "delivery" / "rules.lp").read_text().splitlines()
ACTION = "#program cumulative(t). { _action_lib(go,1,t) }. #program volatile(t). :- not _action_lib(go,1,t), t < n."
EXTERNALS = "#external _request/2. #external _return/3."
CONSTANTS = """#const n = 3.
#const twice = 2*n.
#const start = office1.
#const low = -4.
#const zero = 0.
#const pair = (1,2).
#const odd = "x"+1.
#const back = 2*odd.
a(n,twice,start,low,free,f(g)) :- b(1..n)."""


def remarks(**given):
    program = ReactiveProgram.from_text(CONSTANTS, "home.lp")
    return constant_remarks(program, {name: parse_term(value) for name, value in given.items()})


@pytest.mark.parametrize("files", [["mailbot.lp", "office.lp"], ["house.lp", "home.lp"]])
def test_the_shipped_programs_are_fit(files):
    program = shipped(*files)
    assert program_warnings(program) == []
    assert constant_remarks(program, {"capacity": parse_term("1"), "tries": parse_term("5")}) == ([], [])
    (fault,), _ = constant_remarks(program, {"capacity": parse_term("three")})
    assert fault.startswith("capacity is three, but the program's own value is 3 (")
    line = next(line for line, text in enumerate(RULES, 1) if text.startswith("#const capacity"))
    assert fault.endswith(f"delivery/rules.lp:{line}): give a number")


@pytest.mark.parametrize(
    ("text", "warnings"),
    [
        (EXTERNALS + ACTION, []),
        ("#external _return(go,V,1) : V = 1. #external _request(do(1),2)." + ACTION, []),
        (
            ACTION,
            ["takes no goals: it declares no external _request/2 (write #external _request/2.)", "never learns how"],
        ),
        ("#external _request/2." + ACTION, ["no external _return/3 (write #external _return/3. and rules for values"]),
        (
            EXTERNALS + "#program cumulative(t). #program volatile(t).",
            ["plans no actions: no rule defines _action_lib/3"],
        ),
        ("#external _request/2. #program cumulative(t). #program volatile(t).", ["plans no actions"]),
        (EXTERNALS + ACTION.partition("#program volatile")[0], ["no volatile part"]),
    ],
)
def test_what_a_program_lacks(text, warnings):
    program = ReactiveProgram.from_text(text, "home.lp")
    assert len(program_warnings(program)) == len(warnings)
    found = program_warnings(program)
    assert len(found) == len(warnings), "however often one asks"
    for one, words in zip(found, warnings):
        assert words in one


@pytest.mark.parametrize(
    ("given", "faults", "warnings"),
    [
        ({"n": "7", "start": "office2", "low": "5", "free": "x"}, [], []),
        ({"start": "7"}, [], []),
        ({"n": "three"}, ["n is three, but the program's own value is 3 (home.lp:1): give a number"], []),
        ({"twice": '"9"'}, ['twice is "9", but the program\'s own value is 6 (home.lp:2): give a number'], []),
        ({"n": "-1"}, [], ["n is -1, but the program's own value is 3 (home.lp:1): is a negative number meant?"]),
        ({"low": "-1"}, [], []),
        ({"n": "0"}, [], []),
        ({"zero": "-1"}, [], []),
        ({"pair": "7", "odd": "7", "back": "7"}, [], []),  # what they are is not a number
        ({"f": "1"}, ["the program has no #const f; its constants are"], []),
        ({"n": "1", "twice": "1", "start": "1", "low": "1", "zero": "1", "pair": "1", "odd": "1", "back": "1"}, [], []),
        ({"strat": "office2"}, ["the program has no #const strat; is start meant?"], []),
        (
            {"zzz": "1"},
            ["the program has no #const zzz; its constants are back, low, n, odd, pair, start, twice, zero"],
            [],
        ),
        ({"zzz": "1", "n": "f(x)"}, ["no #const zzz", "give a number"], []),
    ],
)
def test_constants(given, faults, warnings):
    found = remarks(**given)
    assert len(found.faults) == len(faults)
    assert all(any(words in one for one in found.faults) for words in faults)
    assert found.warnings == warnings


def test_a_program_without_constants():
    found = constant_remarks(ReactiveProgram.from_text("a(1).", "home.lp"), {"n": parse_term("1")})
    assert found == (["the program has no #const n; it has none"], [])
