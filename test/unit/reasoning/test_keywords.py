import pytest

from rosoclingo.oclingo import parse_atom, parse_term
from rosoclingo.reasoning.keywords import (
    KeywordError,
    action_of,
    identifier_of,
    is_keyword,
    name_of,
    return_of,
    run_of,
)


@pytest.mark.parametrize(
    "text",
    [
        "_action_lib(a,b)",
        "_return(a,b,1)",
        "_action_lib(a,b,c)",
        "_action_lib(a,b,0)",
        "_action_lib(a,b,-1)",
        "-_action_lib(a,b,1)",
        "a",
    ],
)
def test_keyword_in_other_form_is_an_error(text):
    with pytest.raises(KeywordError):
        action_of(parse_atom(text))


def test_keyword_return_that_is_malformed_is_an_error():
    with pytest.raises(KeywordError, match="positive integer"):
        return_of(parse_atom("_return(a,b,now)"))


def test_keyword_run_is_a_fact_that_reads_back():
    assert str(run_of("2013-09-15T10:00:00-0a1b2c3d")) == '_run("2013-09-15T10:00:00-0a1b2c3d")'
    assert parse_atom(str(run_of('it\'s \\ "mine"'))) == run_of('it\'s \\ "mine"')


@pytest.mark.parametrize("text", ["7", '"_action_lib"', "#sup"])
def test_keyword_must_be_a_function(text):
    assert not is_keyword(parse_term(text), "_action_lib")


@pytest.mark.parametrize(
    ("goal", "identifier"), [("goal(a,b,1)", "1"), ("g(f(x))", "f(x)"), ("g", None), ("7", None), ("(g,1)", None)]
)
def test_keyword_identity_is_the_last_argument(goal, identifier):
    found = identifier_of(parse_term(goal))
    assert (None if found is None else str(found)) == identifier


def test_keyword_names_from_strings_lose_quotes():
    assert name_of(parse_term('"arm/left"')) == "arm/left"
    assert name_of(parse_term("robot(1)")) == "robot(1)"
