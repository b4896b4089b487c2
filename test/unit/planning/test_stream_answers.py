"""Streams with their answers: each is played as it is, with a new solver before each update, and with compaction.

A line is an update and its reading: the horizon, the answers separated by ``|`` (``-`` is empty), and the heads of
ignored statements after ``!``.
"""

import pytest
from stream_logs import cut
from stream_play import planner_of, play

STEPS = "#cumulative t. #external e(t). c(t) :- e(t). #volatile t."
RETURNS = (
    "#cumulative t. #external _return(a,x,t). c(t) :- _return(a,x,t). { _action_lib(a,x,1) } :- t = 1. #volatile t."
)
STREAMS = {
    "forgotten externals stay false": (
        STEPS,
        "#step 5. -> 5: -",
        "#forget 3..3. -> 5: -",
        "e(2). e(3). e(4). -> 5: c(2) c(4) e(2) e(4) ! e(3)",
        "#step 6. #closed 5. e(2). e(3). e(4). -> 6: c(2) c(4) e(2) e(4) ! e(3)",
    ),
    "externals belong to the steps that declare them": (
        "#external door. #cumulative t. #external e(t). #external g : t = 1. #volatile t. #show e/1.",
        "#step 5. -> 5: -",
        "#forget 1..3. -> 5: -",
        "e(1). e(2). e(3). e(4). door. g. -> 5: e(4) ! e(1) e(2) e(3) door g",
    ),
    **{
        f"steps are forgotten when the horizon passes them, {how}": (
            "#cumulative t. #external e(t). #forget t : t-2. c(t) :- e(t). #volatile t. :- t < 6.",
            f"#step 1 : 9. {loop} -> 6: -",
            "e(3). e(4). e(5). -> 6: c(5) e(5) ! e(3) e(4)",
        )
        for how, loop in (("growing", ""), ("regrounding for a loop", "e(9) :- c(9)."))
    },
    "open predicates have no step": (
        "#external sees/1. a(X) :- sees(X). #cumulative t. #volatile t.",
        "#step 1. #volatile. sees(x). -> 1: a(x) sees(x)",
        "#step 2. #forget 0..9. -> 2: -",
        "sees(x). -> 2: a(x) sees(x)",
        "#step 6. #closed 5. sees(x). -> 6: a(x) sees(x)",
    ),
    "rules and facts of open predicates": (
        "{ a }. #external sees/1. #cumulative t. b(X,t) :- sees(X). #volatile t.",
        "sees(x) :- a. sees(y). sees(y) :- a. :- sees(w). -> 1: a b(x,1) b(y,1) sees(x) sees(y) | b(y,1) sees(y)",
        "#step 2. :- not a. -> 2: a b(x,1) b(x,2) b(y,1) b(y,2) sees(x) sees(y)",
    ),
    "returns of the last cycle": (
        RETURNS,
        "#step 2. #closed 1. -> 2: -",
        "#step 5. #closed 2..4. -> 5: -",
        "_return(a,x,1). _return(a,x,3). _return(a,x,4). -> 5: _return(a,x,4) c(4) ! _return(a,x,1) _return(a,x,3)",
        "#step 6. #closed 5. _return(a,x,3). _return(a,x,4). -> 6: _return(a,x,4) c(4) ! _return(a,x,3)",
    ),
    "returns of the last cycle with actions": (
        RETURNS,
        "#step 2. #closed 1. :- not _action_lib(a,x,1). -> 2: _action_lib(a,x,1)",
        "#step 4. #closed 2..3. _return(a,x,2). -> 4: _action_lib(a,x,1) ! _return(a,x,2)",
        "_return(a,x,1). -> 4: _action_lib(a,x,1) _return(a,x,1) c(1)",
    ),
    **{
        f"volatile rules for {window} steps": (
            f"#cumulative t. p(t). #volatile t : {window}. :- p(t). #volatile t.",
            "#step 1. -> 1: p(1)",
            "#step 2. -> 2: p(1) p(2)",
        )
        for window in (0, -3)
    },
    "a step without a bound": (
        "#cumulative t. #volatile t. end(t). :- t < 4.",
        "#step 1 : 1. -> 2: none",
        "#step 1. -> 4: end(4)",
        "#step 1 : 9. -> 4: end(4)",
        "#step 5. -> 5: end(5)",
    ),
    "forgetting spares later actions": (
        "#cumulative t. { _action_lib(go,x,t+3) }. #forget t : t-1. #volatile t. #show. #show C : _action_lib(go,x,C).",
        "#step 1 : 0. -> 1: -",
        "#step 3 : 0. -> 3: -",
        "#step 4 : 0. -> 4: - | 4",
        "#step 5 : 0. -> 5: - | 4 | 4 5 | 5",
    ),
    "only facts are actions before cycle one": (
        "#cumulative t. { _action_lib(go,x,t-1) }. _action_lib(go,y,t-1). #volatile t.",
        "#step 1. -> 1: _action_lib(go,y,0)",
    ),
    "a withdrawal resolves a contradiction": (
        "#cumulative t. #external e(t). p(t) :- e(t). p(t) :- p(t-1). #volatile t. :- p(t).",
        "#step 1. -> 1: -",
        "#step 2 : 0. e(2). -> 2: none",
        "#step 3 : 0. #over 3. -> 3: none",
        "#step 4 : 0. #over 4. -> 4: none",
        "#step 5 : 0. #over 5. -> 5: none",
        "#step 6 : 0. #withdraw e(2). -> 6: -",
    ),
    "externals that later steps declare again": (
        "#cumulative t. #external e(9) : t \\ 4 = 1. c(t) :- e(9). #volatile t.",
        "#step 1 : 0. -> 1: -",
        "#step 2 : 0. #over 1. -> 2: -",
        "#step 3 : 0. #over 2. -> 3: -",
        "#step 5 : 0. #over 4. -> 5: -",
    ),
}


def reading(result):
    """Return horizon, answers and ignored heads as text."""
    answers = sorted(" ".join(sorted(map(str, answer))) or "-" for answer in result.answers)
    ignored = ["! " + " ".join(one.split()[1] for one in result.warnings)] if result.warnings else []
    return " ".join([f"{result.horizon}:", " | ".join(answers) or "none", *ignored])


@pytest.mark.parametrize("variant", ["as it is", "restored", "compacted"])
@pytest.mark.parametrize("name", STREAMS)
def test_stream_has_these_answers(name, variant, request):
    if variant == "compacted":
        request.getfixturevalue("compacts_at_once")
    text, *lines = STREAMS[name]
    solver = planner_of(text, models=0)
    for line in lines:
        update, expected = line.split(" -> ")
        if variant == "restored":
            log, solver = cut(solver), planner_of(text, models=0)
            solver.restore(log)
        assert reading(play(solver, update)) == expected, line
