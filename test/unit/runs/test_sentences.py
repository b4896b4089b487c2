"""Actions, goals and reasons in the words of a program."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from published_runs import program_of
from shipped import shipped

from rosoclingo.oclingo import parse_atom
from rosoclingo.reasoning.keywords import action_of
from rosoclingo.runs.recorded_run import RunProgram
from rosoclingo.runs.sentences import Sentences, sentences_of

WORDS = """
#program base.
_says(drive,"drives to {}"). _says(wait,"waits {} minutes, {} at the most"). _says("tidy up","tidies up").
_says(X,"does {}") :- odd(X).
_says(plain,no_text). _says(one). _says(X,Y) :- known(X,Y). known(1,2).
#program cumulative(t).
#external _request/2.
"""
GOALS = """
_says("run(P,_)","Run {P}"). _says("run(go(L),_)","Go to {L}"). _says("run(day)","Serve all day").
_says("goal(From,To,Id)","Bring package {Id} from {From} to {To}"). _says("same(X,X)","{X} twice, {Y}").
_says("_shut(Room,_)","{Room} is shut"). _says("say(\\"X _ goal(Y)\\",_)","Say X _ goal(Y)").
_says("odd(X)) :- p(X","odd"). _says("odd(X). #include <file>","odd"). _says("odd(","odd"). _says("odd(X)",no_text).
_says("odd(1;2)","odd"). _says("odd(é)","odd"). _says("É(1)","odd"). _says(move_base,"drives to {}").
"""
TITLES = {"office3": "Anna's office", "room(1,2)": "<b>", "7": "\u202eseven\n"}


def words(text, *actions):
    return [sentences_of(program_of(text)).of(action_of(parse_atom(one))) for one in actions]


def test_sentences_of_actions_come_from_program_facts():
    assert words(WORDS, *(f"_action_lib({one},tap,1)" for one in ("plain", "odd"))) == ["plain tap", "odd tap"]
    assert words('_says(go,"goes to {}"). ((', "_action_lib(go,x,1)") == ["go x"], "it cannot be read"
    assert words(WORDS, "_action_lib(drive,tap,1)", '_action_lib(wait,"3",1)', '_action_lib("tidy up",f(x),1)') == [
        "drives to tap",
        "waits 3 minutes, 3 at the most",
        "tidies up",
    ]


@pytest.mark.mostly_slow
@pytest.mark.parametrize(
    ("files", "actions", "goal", "sentence"),
    [
        (("mailbot.lp", "office.lp"), "picks up", "goal(a,b,1)", "Bring package 1 from a to b"),
        (("household.lp", "home.lp"), "takes hold of", "bring(study,cup)", "Bring the cup to the study"),
        (("mailbot.lp", "office.lp", "golog/mailbot_day.golog"), "picks up", "run(go(office3))", "Go to office3"),
    ],
)
def test_sentences_of_the_shipped_programs(files, actions, goal, sentence):
    sentences = sentences_of(RunProgram.of("run", shipped(*files), {}))
    said = [sentences.of(action_of(parse_atom(f"_action_lib({one},1)"))) for one in ("move_base,tap", "pickup,cup")]
    assert [*said, sentences.goal(goal)] == ["drives to tap", f"{actions} cup", sentence]


@pytest.mark.parametrize(
    ("goal", "sentence"),
    [
        ("goal( office3 ,office2,1)", "Bring package 1 from Anna's office to office2"),
        ('goal("x y",room(1,2),7)', "Bring package \u202eseven\n from x y to <b>"),
        ("goal(office3,1)", "goal(office3,1)"),
        ("run(go(a),3)", "Go to a"),
        ("run(day)", "Serve all day"),
        ("run(night)", "run(night)"),
        ("same(a,a)", "a twice, {Y}"),
        ("same(a,b)", "same(a,b)"),
        ('say("X _ goal(Y)",1)', "Say X _ goal(Y)"),
        ("no goal ((", "no goal (("),
    ],
)
def test_sentence_of_goal_has_the_most_fixed_pattern(goal, sentence):
    assert sentences_of(program_of(GOALS, titles=TITLES)).goal(goal) == sentence


@pytest.mark.parametrize(
    ("fact", "words"),
    [
        ("_shut(a,now)", "a is shut"),
        ("_shut(office3,7).", "Anna's office is shut"),
        ("_shut(a)", "_shut(a)"),
        ("((", "(("),
    ],
)
def test_sentences_describe_facts(fact, words):
    assert sentences_of(program_of(GOALS, titles=TITLES)).fact(fact) == words


def test_sentences_of_actions_name_titled_labels():
    sentences = sentences_of(program_of(GOALS, titles=TITLES))
    assert sentences.of(action_of(parse_atom("_action_lib(move_base(r1),office3,4)"))) == "r1 drives to Anna's office"
    damaged = sentences_of(program_of(GOALS, titles={"office3": 5}))
    assert damaged.goal("run(go(office3),1)") == "Go to office3"
    assert sentences_of(program_of(GOALS, titles=["office3"])).goal("run(go(office3),1)") == "Go to office3"


@pytest.mark.parametrize(
    ("message", "reason"),
    [
        ("goal(a,b,1) is met", "is met"),
        ("the program rejects goal(a,b,1): there is no a", "there is no a"),
        (
            "goal(a,b,1) cannot be met together with goal(b,c,2)",
            "cannot be met together with 'Bring package 2 from b to c'",
        ),
        ("since '_return(move_base,blocked,3)' from 'robot'", "since 'move_base returned blocked' from 'robot'"),
        (
            "_action_lib(move_base(r1),a,3) and _request(goal(a,b,2),5)",
            "'r1 drives to a' and 'Bring package 2 from a to b'",
        ),
        ("_seen(cup,3), goal(a), regoal(a,b,1)", "_seen(cup,3), goal(a), regoal(a,b,1)"),
        ("goal(a,b,1) is aborted: the core shuts down", "the core shuts down"),
        ("since '_shut(room(1,2),3)' from 'door'", "since 'room(1,2) is shut' from 'door'"),
    ],
)
def test_sentences_replace_terms_in_reasons(message, reason):
    assert sentences_of(program_of(GOALS)).reason("goal(a,b,1)", message) == reason


@pytest.mark.parametrize(
    ("message", "reason"),
    [
        ("waits for office3, then for office4", "waits for Anna's office, then for office4"),
        ("the door of 'office3' is closed", "the door of 'Anna's office' is closed"),
        ("since '_return(move_base,blocked,3)' at office3", "since 'move_base returned blocked' at Anna's office"),
        ("at(robot,office3,2), near(office3), office33 and office3(2)",) * 2,
    ],
)
def test_sentences_replace_labels_in_reasons_by_their_titles(message, reason):
    assert sentences_of(program_of(GOALS, titles=TITLES)).reason("goal(a,b,1)", message) == reason


@given(st.text(alphabet="goal(a,b1)\"\\' _returnX\n\u202e", max_size=60))
def test_sentences_accept_any_message_and_pattern(text):
    sentences = sentences_of(program_of(GOALS))
    assert isinstance(sentences.reason(text, text), str)
    quoted = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    assert sentences_of(program_of(f'_says("{quoted}","text").')).goal("b(1)") in ("b(1)", "text")


@pytest.mark.parametrize(
    ("state", "expected"),
    [
        ("active", "goes to x, wave y"),
        ("preempting", "is cancelled: goes to x, wave y"),
        ("active: has a lift", "goes to x, wave y (has a lift)"),
        ("waiting: at most 8 goals are planned for at a time",) * 2,
    ],
)
def test_sentences_describe_actions_under_way(state, expected):
    sentences = Sentences({"go": "goes to {}"})
    plan = ["_action_lib(go,x,3)", "_action_lib(wave,y,3)", "_action_lib(go,z,4)", "((", "_seen(3)"]
    assert sentences.now(3, state, plan) == expected
    assert sentences.now(5, "active", plan) == "nothing to do now"
    assert sentences.now(5, "active: waits for the lift", plan) == "waits for the lift"
