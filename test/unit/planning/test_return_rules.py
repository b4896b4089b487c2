"""Return rules: auxiliary rules that show which returns affect an answer."""

import pytest

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.planning.return_rules import return_rules

ACTS = "#program cumulative(t). #external _return/3. { _action_lib(go,1..3,t) }. "


def texts(rules):
    """Return the return rules of a program with these rules, without the final dots."""
    found = return_rules(ReactiveProgram.from_text(ACTS + rules + " #program volatile(t)."))
    return (
        None
        if found is None
        else "".join(text for _, _, text in found.texts).replace("__oclingo_", "").split(".\n")[:-1]
    )


@pytest.mark.parametrize(
    ("rule", "expected"),
    [
        ("", []),
        ("p(t) :- q(t).", []),
        ("p(t) :- _return(A,V,t), q(V,t).", ["asks(0,A,V,t) :- _action_lib(A,V,t); q(V,t)"]),
        ("p(t) :- not _return(go,X,t-1), q(X,t).", ["asks(0,go,X,(t-1)) :- _action_lib(go,X,(t-1)); q(X,t)"]),
        (":- q(X), not not _return(go,X,t).", ["asks(0,go,X,t) :- _action_lib(go,X,t); q(X)"]),
        ("p(t) :- not _return(go,_,t).", ["asks(0,go,Any1__,t) :- _action_lib(go,Any1__,t)"]),
        (
            "f(t) :- _action_lib(A,P,t), _return(A,V,t), V != P, q(P).",
            [
                "asks(0,A,V,t) :- _action_lib(A,V,t); _action_lib(A,P,t); V != P; q(P)",
                "acts(0,A,V,t) :- _action_lib(A,V,t); _action_lib(A,P,t); V != P",
            ],
        ),
        (
            "f(t) :- _action_lib(A,V,t-1), _return(A,V,t).",
            ["asks(0,A,V,t) :- _action_lib(A,V,t); _action_lib(A,V,(t-1))"],
        ),
        (
            "f(t) :- _return(A,V,t), not _action_lib(A,P,t), q(P), P < V.",
            [
                "asks(0,A,V,t) :- _action_lib(A,V,t); not _action_lib(A,P,t); q(P); P < V",
                "acts(0,A,V,t) :- _action_lib(A,V,t)",
            ],
        ),
        (
            "f(t) :- _action_lib(A,P,t), _return(A,V,t), q(X) : r(X).",
            [
                "asks(0,A,V,t) :- _action_lib(A,V,t); _action_lib(A,P,t); q(X): r(X)",
                "acts(0,A,V,t) :- _action_lib(A,V,t); _action_lib(A,P,t)",
            ],
        ),
        ("p(t+1) :- _return(go,X,t).", ["asks(0,go,X,t) :- _action_lib(go,X,t)"]),
        ("#external _return(go,X,t) : q(X).", []),
        ("#heuristic p(t) : _return(A,V,t). [1,true] { p(t) }.", []),
    ],
)
def test_return_rules_cover_each_return_in_rules(rule, expected):
    assert texts(rule) == expected


@pytest.mark.parametrize(
    "rule",
    [
        "p(t) :- _return(A,V,t), _return(B,V,t-1).",
        "p(t) :- 1 { _return(A,V,t) : q(A,V) }.",
        "p(t) :- _return(A,V,t) : q(A,V).",
        "p(t) :- _return(A,V,t+1).",
        "p(t) :- _return(A,V,T), T < t, now(T).",
        "p(t) :- _return((go;come),V,t).",
        "p(t) :- not _return(go,f(_),t).",
        "#show p(V) : _return(go,V,t).",
        "_return(go,1,t) :- q(t).",
        "#external e(t) : _return(go,V,t).",
        "#external _return(go,V,t) : _return(go,V,t-1).",
        "#edge (t,t+1) : p(t).",
        "#theory marks { term { - : 1, unary }; &mark/0 : term, any }. p(t) :- &mark.",
        "{ _action_lib(come,1,t+1) }.",
        "#program base. p :- _return(go,1,1).",
    ],
)
def test_return_rules_reject_programs_they_cannot_cover(rule):
    assert texts(rule) is None
