"""Streams of the planner with their answers (see also oclingo/solving/test_stream_updates.py)."""

import pytest
from stream_play import check_stream

RETURNS = "{ _action_lib(a,x,1) }. #cumulative t. #external _return(a,x,t). c(t) :- _return(a,x,t)."

#: A program and its updates with their answers, see check_answers.
STREAMS = [
    # returns can arrive for the last closed cycle, and for the last one with actions
    (RETURNS, "#step 2. #closed 1. => -", "#step 5. #closed 2..4. => -",
     "_return(a,x,1). _return(a,x,3). _return(a,x,4). => _return(a,x,4) c(4) ! _return(a,x,1) _return(a,x,3)",
     "#step 6. #closed 5. _return(a,x,3). _return(a,x,4). => _return(a,x,4) c(4) ! _return(a,x,3)"),
    (RETURNS, "#step 2. #closed 1. :- not _action_lib(a,x,1). => _action_lib(a,x,1)",
     "#step 4. #closed 2..3. _return(a,x,2). => _action_lib(a,x,1) ! _return(a,x,2)",
     "_return(a,x,1). => _action_lib(a,x,1) _return(a,x,1) c(1)"),
    # ... and for each cycle with actions that the update closes
    (RETURNS + "{ _action_lib(a,x,2) } :- t = 2.",
     "#step 4. #closed 1..3. :- not _action_lib(a,x,1). :- not _action_lib(a,x,2). _return(a,x,1). _return(a,x,2). => "
     "_action_lib(a,x,1) _action_lib(a,x,2) _return(a,x,1) _return(a,x,2) c(1) c(2)",
     "#step 5. #closed 4. _return(a,x,3). => "
     "_action_lib(a,x,1) _action_lib(a,x,2) _return(a,x,1) _return(a,x,2) c(1) c(2) ! _return(a,x,3)"),
    # the horizon
    ("#cumulative t. #volatile t. end(t). :- t < 4.", "#step 1 : 1. => ", "#step 1. => end(4)",
     "#step 1 : 9. => end(4)", "#step 5. => end(5)"),
    *(
        (f"#cumulative t. p(t). #volatile t : {window}. :- p(t). #volatile t.",
         "#step 1. => p(1)", "#step 2. => p(1) p(2)")
        for window in (0, -3)
    ),
    *(
        ("#cumulative t. #external e(t). #forget t : t-2. c(t) :- e(t). #volatile t. :- t < 6.",
         f"#step 1 : 9. {loop} => -", "e(3). e(4). e(5). => c(5) e(5) ! e(3) e(4)")
        for loop in ("", "e(9) :- c(9).")
    ),
    ("#cumulative t. { _action_lib(go,x,t+3) }. #forget t : t-1. #volatile t. #show. #show C : _action_lib(go,x,C).",
     "#step 1 : 0. => -", "#step 3 : 0. => -", "#step 4 : 0. => - | 4", "#step 5 : 0. => - | 4 | 4 5 | 5"),
    ("#cumulative t. { _action_lib(go,x,t-1) }. _action_lib(go,y,t-1).", "#step 1. => _action_lib(go,y,0)"),
    # steps that are over
    ("#cumulative t. #external e(t). p(t) :- e(t). p(t) :- p(t-1). #volatile t. :- p(t).", "#step 1. => -",
     "#step 2 : 0. e(2). => ", "#step 3 : 0. #over 3. => ", "#step 4 : 0. #over 4. => ", "#step 5 : 0. #over 5. => ",
     "#step 6 : 0. #withdraw e(2). => -"),
]  # fmt: skip


@pytest.mark.parametrize("way", ["planner", "planner with a new solver for each update", "planner with compaction"])
@pytest.mark.parametrize("stream", STREAMS)
def test_planner_gives_the_expected_answers(stream, way, request):
    if way == "planner with compaction":
        request.getfixturevalue("compacts_at_once")
    check_stream(way, *stream)
