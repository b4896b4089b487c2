import pytest

from rosoclingo.oclingo import parse_atom, parse_term
from rosoclingo.reasoning.keywords import KeywordError, action_of, identifier_of, is_keyword, name_of, run_of


@pytest.mark.parametrize("text", ["_action_lib(a,b)", "_return(a,b,1)", "_action_lib(a,b,0)", "-_action_lib(a,b,1)"])
def test_keyword_in_other_form_is_an_error(text):
    with pytest.raises(KeywordError):
        action_of(parse_atom(text))


def test_keyword_terms_are_read_whatever_their_type():
    assert str(run_of("2013-09-15T10:00:00-0a1b2c3d")) == '_run("2013-09-15T10:00:00-0a1b2c3d")'
    assert not is_keyword(parse_term('"_action_lib"'), "_action_lib")
    found = [identifier_of(parse_term(text)) for text in ("goal(a,b,1)", "g(f(x))", "g", "7", "(g,1)")]
    assert found == [parse_term("1"), parse_term("f(x)"), None, None, None]
    assert [name_of(parse_term(text)) for text in ('"arm/left"', "robot(1)")] == ["arm/left", "robot(1)"]
