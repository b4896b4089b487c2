"""Actions in the words of a program."""

import pytest
from shipped import shipped

from rosoclingo.oclingo import parse_atom
from rosoclingo.reasoning.keywords import action_of
from rosoclingo.runs.recorded_run import ProgramFile, RunProgram
from rosoclingo.runs.sentences import Sentences, sentences_of

WORDS = """
#program base.
_says(drive,"drives to {}"). _says(wait,"waits {} minutes, {} at the most"). _says("tidy up","tidies up").
_says(X,"does {}") :- odd(X).
_says(plain,no_text). _says(one). _says(X,Y) :- known(X,Y). known(1,2).
#program cumulative(t).
#external _request/2.
"""


def words(text, *actions):
    program = RunProgram("run", (ProgramFile("words.lp", text, False),), {}, "")
    return [sentences_of(program).of(action_of(parse_atom(one))) for one in actions]


def test_sentences_of_actions_come_from_program_facts():
    assert words(WORDS, "_action_lib(drive,tap,1)", '_action_lib(wait,"3",1)', '_action_lib("tidy up",f(x),1)') == [
        "drives to tap",
        "waits 3 minutes, 3 at the most",
        "tidies up",
    ]


@pytest.mark.parametrize("interface", ["plain", "one", "odd", "unheard"])
def test_sentences_of_other_actions_are_plain(interface):
    assert words(WORDS, f"_action_lib({interface},tap,1)") == [f"{interface} tap"]


def test_sentences_ignore_unreadable_facts():
    program = RunProgram("run", (ProgramFile("broken.lp", '_says(go,"goes to {}"). ((', False),), {}, "")
    assert sentences_of(program).of(action_of(parse_atom("_action_lib(go,x,1)"))) == "go x"


@pytest.mark.parametrize("files", [("mailbot.lp", "office.lp"), ("house.lp", "home.lp")])
def test_sentences_of_the_shipped_delivery_rules(files):
    sentences = sentences_of(RunProgram.of("run", shipped(*files), {}))
    said = [sentences.of(action_of(parse_atom(f"_action_lib({one},1)"))) for one in ("move_base,tap", "pickup,cup")]
    assert said == ["drives to tap", "picks up cup"]


@pytest.mark.parametrize(
    ("state", "expected"),
    [
        ("active", "goes to x, wave y"),
        ("preempting", "is cancelled: goes to x, wave y"),
        ("active: has a lift", "goes to x, wave y (has a lift)"),
        ("preempting: has a lift", "is cancelled: goes to x, wave y (has a lift)"),
        ("waiting: at most 8 goals are planned for at a time", "waiting: at most 8 goals are planned for at a time"),
    ],
)
def test_sentences_describe_actions_under_way(state, expected):
    sentences = Sentences({"go": "goes to {}"})
    plan = ["_action_lib(go,x,3)", "_action_lib(wave,y,3)", "_action_lib(go,z,4)", "((", "_seen(3)"]
    assert sentences.now(3, state, plan) == expected
    assert sentences.now(5, "active", plan) == "nothing to do now"
    assert sentences.now(5, "active: waits for the lift", plan) == "waits for the lift"
