import pytest

from rosoclingo.oclingo import parse_atom
from rosoclingo.reasoning.keywords import TIMEOUT, action_of, return_of
from rosoclingo.reasoning.returns import Dispatch, ReturnError


def dispatch(*actions):
    return Dispatch(1, tuple(action_of(parse_atom(text)) for text in actions), 0.0)


def take(under_way, text):
    under_way.take(return_of(parse_atom(text)))


def missing(under_way):
    return [str(action.atom) for action in under_way.missing]


def test_cycle_ends_when_each_action_has_returned():
    under_way = dispatch("_action_lib(drive,a,1)", "_action_lib(arm,b,1)")
    take(under_way, "_return(arm,b,1)")
    assert missing(under_way) == ["_action_lib(drive,a,1)"]
    assert under_way.missing
    take(under_way, "_return(drive,failed,1)")
    assert not under_way.missing


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("_return(drive,a,2)", "cycle 1 now"),
        ("_return(drive,a,7)", "cycle 1 now"),
        ("_return(arm,a,1)", "no action of 'arm'"),
    ],
)
def test_stray_returns(text, reason):
    under_way = dispatch("_action_lib(drive,a,1)")
    with pytest.raises(ReturnError, match=reason):
        take(under_way, text)
    assert under_way.missing


def test_duplicate_return_does_not_count_for_another_action():
    under_way = dispatch("_action_lib(drive,a,1)", "_action_lib(drive,b,1)")
    take(under_way, "_return(drive,a,1)")
    with pytest.raises(ReturnError, match="returned already"):
        take(under_way, "_return(drive,a,1)")
    assert missing(under_way) == ["_action_lib(drive,b,1)"]


def test_second_answer_of_a_single_action_is_stray():
    under_way = dispatch("_action_lib(drive,a,1)")
    take(under_way, "_return(drive,failed,1)")
    with pytest.raises(ReturnError, match="returned already"):
        take(under_way, "_return(drive,a,1)")


@pytest.mark.parametrize("value", ["7", '"a"', "f(c)", "f", "(f,c)"])
def test_a_failure_that_names_no_action_under_way(value):
    under_way = dispatch("_action_lib(drive,a,1)", "_action_lib(drive,b,1)")
    take(under_way, f"_return(drive,{value},1)")
    assert failures(under_way) == [(f"_return(drive,{value},1)", ["a", "b"])]
    assert len(missing(under_way)) == 1


@pytest.mark.parametrize("order", [("failed", "a"), ("a", "failed"), ("failed", "b"), ("failed", "failed"), ("b", "a")])
def test_two_actions_of_one_interface(order):
    under_way = dispatch("_action_lib(drive,a,1)", "_action_lib(drive,b,1)")
    for value in order:
        assert under_way.missing
        take(under_way, f"_return(drive,{value},1)")
    assert not under_way.missing


def failures(under_way):
    return [(str(answer.atom), [str(one.parameter) for one in actions]) for answer, actions in under_way.failures]


def test_a_failure_may_name_its_action():
    under_way = dispatch("_action_lib(drive,a,1)", "_action_lib(drive,b,1)", "_action_lib(arm,c,1)")
    take(under_way, "_return(drive,blocked(hard,b),1)")
    assert missing(under_way) == ["_action_lib(drive,a,1)", "_action_lib(arm,c,1)"]
    with pytest.raises(ReturnError, match="returned already"):
        take(under_way, "_return(drive,b,1)")
    take(under_way, "_return(drive,a,1)")
    take(under_way, "_return(arm,failed(hard,c),1)")
    assert missing(under_way) == []
    assert failures(under_way) == [
        ("_return(drive,blocked(hard,b),1)", ["b"]),
        ("_return(arm,failed(hard,c),1)", ["c"]),
    ]


def test_a_failure_that_names_none_is_about_any_that_no_other_return_names():
    under_way = dispatch(*(f"_action_lib(drive,{what},1)" for what in "abc"))
    take(under_way, "_return(drive,failed,1)")
    assert failures(under_way) == [("_return(drive,failed,1)", ["a", "b", "c"])]
    take(under_way, "_return(drive,b,1)")
    take(under_way, "_return(drive,failed(c),1)")
    assert missing(under_way) == []
    assert failures(under_way) == [("_return(drive,failed(c),1)", ["c"]), ("_return(drive,failed,1)", ["a"])]


def test_success_is_no_failure():
    under_way = dispatch("_action_lib(drive,f(a),1)", "_action_lib(drive,a,1)")
    take(under_way, "_return(drive,f(a),1)")
    assert missing(under_way) == ["_action_lib(drive,a,1)"]
    assert failures(under_way) == []


def test_time_outs_of_a_place_named_timeout_are_failures():
    under_way = dispatch(*(f"_action_lib(drive,{what},1)" for what in ("timeout", "a", "b")), "_action_lib(arm,c,1)")
    take(under_way, "_return(drive,a,1)")
    expired = [(str(action.parameter), str(answer.value)) for action, answer in under_way.expire(TIMEOUT)]
    assert expired == [("timeout", "failed(timeout)"), ("b", "failed(timeout,b)"), ("c", "timeout")]
    assert missing(under_way) == []
    assert failures(under_way) == [
        ("_return(drive,failed(timeout),1)", ["timeout"]),
        ("_return(drive,failed(timeout,b),1)", ["b"]),
        ("_return(arm,timeout,1)", ["c"]),
    ]


def test_time_outs_of_several_actions_name_none_of_them():
    under_way = dispatch("_action_lib(drive,a,1)", "_action_lib(drive,b,1)")
    assert [str(answer.value) for _, answer in under_way.expire(TIMEOUT)] == ["timeout", "timeout"]
    assert failures(under_way) == [("_return(drive,timeout,1)", ["a", "b"])] * 2
