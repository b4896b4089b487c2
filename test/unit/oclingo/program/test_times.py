"""The argument of an atom that is its time."""

import pytest

from rosoclingo.oclingo import ReactiveProgram

RULES = """
#program base.
room(a). at(a,0). shift(early,7). later(1).
#program cumulative(k).
#external seen/2.
#external _return(go,X,k) : room(X).
at(X,k) :- at(X,k-1), not gone(k,X).
gone(k,X) :- _return(go,X,k), shift(_,S), later(k).
{ plan(X,k+1) : room(X) }.
mixed(k,1) :- at(a,k).
mixed(1,k) :- at(a,k).
known(X) :- gone(k,X).
now(X,k) :- seen(X,k).
since(T,k) :- plan(_,T), T <= k.
#show (X,k) : at(X,k).
#show near(X;Y,k) : at(X,k), room(Y).
#program volatile(last).
"""


@pytest.fixture(scope="module")
def program():
    return ReactiveProgram.from_text(RULES)


@pytest.mark.parametrize(
    ("name", "arity", "position"),
    [
        ("at", 2, 1),
        ("gone", 2, 0),
        ("mixed", 2, 1),  # heads disagree: the last argument, if rules use it as a time
        ("known", 1, None),
        ("_return", 3, 2),
        ("seen", 2, 1),
        ("later", 1, 0),
        ("shift", 2, None),
        ("", 2, 1),
        ("near", 2, 1),
    ],
)
def test_time_position_is_the_argument_with_the_step(program, name, arity, position):
    assert program.time_position(name, arity) == position
