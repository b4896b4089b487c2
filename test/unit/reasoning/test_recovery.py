"""Why goals are given up: smallest conflicts of goals and observations, checked against every subset; the words."""

from itertools import combinations

import pytest
from core_driver import ERRANDS, Driver
from hypothesis import given, settings
from hypothesis import strategies as st

from rosoclingo.oclingo import (
    ReactiveProgram,
    SolveOutcome,
    StreamUpdate,
    commitment,
    fact,
    parse_atom,
    parse_term,
)
from rosoclingo.oclingo.progression.updates import Closed, Withdraw
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.planning.workers.pool import WorkerPool
from rosoclingo.planning.workers.process_solver import ProcessSolver
from rosoclingo.reasoning import Halt

#: Goals ``reach(Room,Id)``: doors, which ``_shut(D)`` shuts for good, lead to rooms. A room is entered once at most
#: where that failed, and not at all after one that it clashes with.
ROOMS = """
#external _request/2. #external _return/3. #external _shut/1.
#program base.
{doors}
{clashes}
#program cumulative(t).
asked(R,I,t) :- _request(reach(R,I),t+1).
open(R,I,t) :- asked(R,I,t), not gone(I,t).
open(R,I,t) :- open(R,I,t-1), not entered(R,t-1), not gone(I,t).
gone(I,t) :- _request(cancel(I),t).
failed(R,t) :- _return(enter,V,t), V != R, _action_lib(enter,R,t).
entered(R,t) :- _action_lib(enter,R,t), not failed(R,t).
lost(R,t) :- failed(R,t).
lost(R,t) :- lost(R,t-1).
barred(R) :- door(R,D), _shut(D).
{{ _action_lib(enter,R,t) : open(R,I,t), not lost(R,t-1), not barred(R) }} 1.
been(R,t) :- entered(R,t).
been(R,t) :- been(R,t-1).
:- been(R,t), been(S,t), clash(R,S).
{words}
#program volatile(t).
:- open(R,I,t), not entered(R,t).
#program base.
#show _action_lib/3. #show _explain/3.
#defined door/2. #defined clash/2. #defined _explain/3.
"""

WORDS = """
_explain(I,(R," is unreachable"),t) :- asked(R,I,t).
_explain(_return(enter,V,t),("the way to ",R," was ",V," in cycle ",t),t) :- failed(R,t), _return(enter,V,t).
"""


def rooms(doors=(), clashes=(), words=""):
    return ROOMS.format(
        doors=" ".join(f"door({room},{door})." for room, door in doors),
        clashes=" ".join(f"clash({one},{other})." for one, other in clashes),
        words=words,
    )


def test_generic_words():
    driver = Driver(rooms()).goal("a", "reach(hall,1)").facts("_return(enter,blocked,1)")
    assert driver.message("a") == "reach(hall,1) cannot be met since enter(hall) returned blocked in cycle 1"
    assert driver.states("a")[-1] == "aborted"


def test_the_programs_words():
    driver = Driver(rooms(words=WORDS)).goal("a", "reach(hall,1)").facts("_return(enter,blocked,1)")
    expected = "reach(hall,1) cannot be met: hall is unreachable since the way to hall was blocked in cycle 1"
    assert driver.message("a") == expected


def test_what_was_told_long_before():
    driver = Driver(rooms(doors=[("hall", "d"), ("den", "e")])).facts("_shut(d)").facts("_shut(e)")
    driver.goal("a", "reach(attic,1)").finish().goal("b", "reach(hall,2)")
    assert driver.message("b") == "reach(hall,2) cannot be met since _shut(d) was told in cycle 1"
    assert driver.states("a")[-1] == "succeeded"


def test_a_malformed_explanation_is_told():
    driver = Driver(rooms(words="_explain(I,R,soon(t)) :- asked(R,I,t)."))
    driver.goal("a", "reach(hall,1)").facts("_return(enter,blocked,1)")
    assert any(
        "'_explain(1,hall,soon(1))' is no explanation: write _explain(What,Text,C)" in one
        for one in driver.journal.problems
    )
    assert driver.message("a") == "reach(hall,1) cannot be met since enter(hall) returned blocked in cycle 1"


def test_time_is_over():
    driver = Driver(rooms(clashes=[("hall", "den")]), watch_recovery=lambda: lambda: Halt("the test"))
    driver.goal("a", "reach(hall,1)")
    driver.core.add_goal("b", "reach(den,2)")
    driver.core.add_goal("c", "reach(hall,3)")
    driver.facts("_return(enter,failed,1)").finish()
    for key in "abc":
        assert driver.states(key)[-1] in ("aborted", "succeeded")
    assert driver.message("a") == "reach(hall,1) cannot be met: there is no plan of at most 8 steps"


def test_what_was_withheld_is_no_reason_either_where_time_is_over():
    """The time is enough to see that something that was told is the reason, not to see what of it."""

    def watch():
        looks = iter([None])
        return lambda: next(looks, Halt("the test"))

    text = rooms(doors=[("hall", "d")]) + "#external _odd/1.\n:- _odd(X)."
    driver = Driver(text, watch_recovery=watch).facts("_odd(1)", "_odd(2)").facts("_shut(d)").goal("a", "reach(hall,1)")
    assert [problem.split()[-1] for problem in driver.problems] == ["withheld"] * 2
    assert driver.message("a") == "reach(hall,1) cannot be met since _shut(d) was told in cycle 1"


ROOM_NAMES = ("hall", "den", "attic", "loft")
INSTANCES = st.fixed_dictionaries(
    {
        "goals": st.lists(st.sampled_from(ROOM_NAMES), min_size=1, max_size=4, unique=True),
        "clashes": st.lists(st.tuples(st.sampled_from(ROOM_NAMES), st.sampled_from(ROOM_NAMES)), max_size=3),
        "doors": st.lists(st.tuples(st.sampled_from(ROOM_NAMES), st.sampled_from("de")), max_size=3),
        "shut": st.lists(st.sampled_from("de"), max_size=2, unique=True),
    }
)


def can_be_met(program, goals, shut):
    """Whether there is a plan for goals (Id to room) with some doors shut."""
    solver = PlanSolver(program, horizon_limit=8)
    items = [fact(parse_atom(f"_request(reach({room},{one}),2)")) for one, room in goals]
    items += [fact(parse_atom(f"_shut({door})")) for door in shut]
    return solver.update(StreamUpdate(1, None, tuple(items))).outcome is SolveOutcome.SATISFIABLE


def parts_of(things):
    return [some for size in range(len(things)) for some in combinations(things, size)]


@pytest.mark.slow
@settings(max_examples=settings.default.max_examples // 8)
@given(INSTANCES)
def test_against_every_subset(instance):
    driver = Driver(rooms(instance["doors"], instance["clashes"]))
    program = driver.program
    goals = [(number, room) for number, room in enumerate(instance["goals"], 1)]
    if instance["shut"]:
        driver.facts(*(f"_shut({door})" for door in instance["shut"]))
    for number, room in goals:
        driver.core.add_goal(str(number), f"reach({room},{number})")
    driver.run()
    ended = {number for number, _ in goals if driver.states(str(number))[-1:] == ["aborted"]}
    fewest = min(
        len(goals) - len(kept)
        for kept in [tuple(goals), *parts_of(goals)]
        if can_be_met(program, kept, instance["shut"])
    )
    assert len(ended) == fewest
    for number in ended:
        text = driver.message(str(number))
        together = [one for one in goals if one[0] == number or f"reach({one[1]},{one[0]})" in text]
        seen = [door for door in "de" if f"_shut({door})" in text]
        assert not can_be_met(program, together, seen)
        assert all(can_be_met(program, some, seen) for some in parts_of(together))
        assert all(can_be_met(program, together, some) for some in parts_of(seen))
    driver.finish()
    assert all(driver.states(str(number))[-1] == "succeeded" for number, _ in goals if number not in ended)


@pytest.mark.parametrize("make", ["own", "process"])
def test_a_state_without_a_failed_action(make):
    """Without its return and itself a failed action was not tried: the plan is as if nothing had happened."""
    program = ReactiveProgram.from_text(ERRANDS)
    with WorkerPool(program, shortest=True) as process:
        solver = ProcessSolver(process) if make == "process" else PlanSolver(program)
        solver.update(StreamUpdate(1, 5, (fact(parse_atom("_request(do(walk,1),2)")),)))
        action, answer = parse_term("_action_lib(walk,1,1)"), parse_term("_return(walk,failed,1)")
        solver.update(StreamUpdate(2, 5, (Closed(1, 1), commitment(action), fact(answer))))
        past = (Withdraw(action), Withdraw(answer), Closed(2, 2))
        actions = solver.update(StreamUpdate(3, 5, past)).answers[0]
    assert [str(one) for one in actions if one.name == "_action_lib"] == ["_action_lib(walk,1,3)"]
