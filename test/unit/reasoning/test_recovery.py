"""Goals without a plan: the fewest are aborted, with minimal conflicts as reasons, checked against every subset."""

from itertools import combinations, groupby

import pytest
from core_driver import ERRANDS, Driver, halting
from core_programs import BATTERY, DARK, rooms
from core_scripts import play, scripts
from hypothesis import given, settings
from hypothesis import strategies as st

from rosoclingo.oclingo import SolveOutcome, StreamUpdate, fact, parse_atom
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.reasoning.settings import CoreSettings
from rosoclingo.reasoning.stream_planner import RECENT

#: Goals ``do(Id)`` of six steps each, one step a cycle.
IN_TURN = """
#external _request/2. #external _return/3.
#program cumulative(t).
left(I,6,t) :- _request(do(I),t+1).
left(I,N,t) :- left(I,N,t-1), not _action_lib(go,I,t-1), not _request(cancel(I),t).
left(I,N-1,t) :- left(I,N,t-1), _action_lib(go,I,t-1), N > 1, not _request(cancel(I),t).
{ _action_lib(go,I,t) : left(I,_,t) } 1.
done(I,t) :- left(I,1,t), _action_lib(go,I,t).
#program volatile(t).
:- left(I,_,t), not done(I,t).
#program base.
#show _action_lib/3.
"""

WORDS = """
_explain(I,(R," is unreachable"),t) :- asked(R,I,t).
_explain(I,"an earlier reason",t-1) :- asked(R,I,t).
_explain(_return(enter,V,t),("the way to ",R," was ",V," in cycle ",t),t) :- failed(R,t), _return(enter,V,t).
"""


#: The program, the bounds of the search for reasons, and the script.
RECOVERIES = {
    "goal that cannot be met is aborted": (ERRANDS, None, """
        goal a do(never,1); all a active aborted; sends _request(cancel(1),2).
        says a do(never,1) cannot be met: there is no plan of at most 8 steps
        goal b do(walk,2); finish; is b succeeded"""),
    "program without any answer ends every goal": (DARK, None, """
        goal a do(walk,1); is a aborted; problem ...has no answer, even without goals and facts...; does
        goal b do(walk,2); is b aborted; facts _seen(sun); goal c do(walk,3); finish; is c succeeded"""),
    "words of the program": (rooms(words=WORDS), None, """
        goal a reach(hall,1); facts _return(enter,blocked,1)
        says a reach(hall,1) cannot be met: hall is unreachable since the way to hall was blocked in cycle 1"""),
    "malformed explanation": (rooms(words="_explain(I,R,soon(t)) :- asked(R,I,t)."), None, """
        goal a reach(hall,1); facts _return(enter,blocked,1)
        problem ...'_explain(1,hall,soon(1))' is not an explanation: write _explain(What,Text,C)...
        says a reach(hall,1) cannot be met since enter(hall) returned blocked in cycle 1"""),
    "goals at fault that are not found in time wait": (rooms(clashes=[("hall", "den")]), halting(0), """
        add a reach(hall,1); add b reach(den,2); goal c reach(loft,3); does enter,hall,2; queued b c
        problem there is no plan of at most 10 steps, and the goals that cannot be met were not found in time: 2 of 3...
        finish; is a succeeded; is b aborted; is c succeeded"""),
    "goals that can be met in turn are not aborted": (IN_TURN, None, """
        add a do(1); goal b do(2); queued b; finish; is a succeeded; is b succeeded"""),
    "reason that is not proven in time is uncertain": (rooms(doors=[("hall", "d"), ("hall", "e")]), halting(1), """
        facts _shut(d) _shut(e); goal a reach(hall,1)
        says a ... perhaps since _shut(d) was reported in cycle 1 and _shut(e) was reported in cycle 1"""),
    "observation that a goal needs is no reason": (
        rooms(doors=[("hall", "d"), ("den", "key")], words=":- open(hall,I,t), not _shut(key)."), None, """
        facts _shut(key) _shut(d) _shut(e); goal a reach(hall,1)
        says a reach(hall,1) cannot be met since _shut(d) was reported in cycle 1"""),
    "request that contradicts the past is withdrawn": (
        BATTERY + ":- _request(do(jump,I),t+1), _action_lib(walk,J,t-2).\n", None, """
        goal a do(walk,1); finish; goal b do(jump,2); is b aborted; sends #withdraw _request(do(jump,2),4).
        goal c do(run,3); finish; is c succeeded"""),
}  # fmt: skip


@scripts(RECOVERIES)
def test_recovery_follows_the_script(row):
    text, watch, script = row
    driver = play(Driver(text, **({} if watch is None else {"watch_recovery": watch})), script)
    assert driver.core.live_goals == []
    assert not any("forgets its history" in problem for problem in driver.problems)


@pytest.mark.slow
def test_recovery_decides_about_goals_with_all_other_facts_certain():
    """Observations of long ago become uncertain only for the reasons, after the plan: all later steps do as well."""
    asked = []

    class AskedSolver(PlanSolver):
        def search(self, *arguments, **options):
            asked.append(None)
            return super().search(*arguments, **options)

        def inquire(self, update, assumable, *arguments, **options):
            asked.append({str(one) for one in assumable})
            return super().inquire(update, assumable, *arguments, **options)

    program, later = rooms(clashes=[("hall", "hall")]), RECENT + 1
    driver = Driver(program, settings=CoreSettings(horizon_limit=20), solver=AskedSolver).facts("_shut(a)")
    for number in range(later + 1):
        driver.core.add_goal(str(number), f"reach(room{number},{number})")
    driver.run()
    for _ in range(later):
        driver.succeed()
    asked.clear()
    driver.core.add_goal("hall", "reach(hall,99)")
    driver.succeed()
    assert driver.states("hall")[-1] == "aborted"
    parts = [list(part) for searches, part in groupby(asked, lambda one: one is None) if not searches]
    assert ["_shut(a)" in set.union(*part) for part in parts] == [False, True]


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
    """Return whether there is a plan for goals (Id to room) with some doors closed."""
    solver = PlanSolver(program, horizon_limit=8)
    items = [fact(parse_atom(f"_request(reach({room},{one}),2)")) for one, room in goals]
    items += [fact(parse_atom(f"_shut({door})")) for door in shut]
    return solver.update(StreamUpdate(1, None, tuple(items))).outcome is SolveOutcome.SATISFIABLE


def parts_of(things):
    return [some for size in range(len(things)) for some in combinations(things, size)]


@pytest.mark.slow
@settings(max_examples=settings.default.max_examples // 8)
@given(INSTANCES)
def test_recovery_agrees_with_search_over_all_subsets(instance):
    driver = Driver(rooms(instance["doors"], instance["clashes"]))
    program = driver.program
    goals = [(number, room) for number, room in enumerate(instance["goals"], 1)]
    if instance["shut"]:
        driver.facts(*(f"_shut({door})" for door in instance["shut"]))
    for number, room in goals:
        driver.core.add_goal(str(number), f"reach({room},{number})")
    driver.run()
    ended = {number for number, _ in goals if driver.states(str(number))[-1:] == ["aborted"]}
    choices = (set(some) for size in range(len(goals) + 1) for some in combinations(goals[::-1], size))
    fewest = next(some for some in choices if can_be_met(program, set(goals) - some, instance["shut"]))
    assert ended == {number for number, _ in fewest}, "as few as possible, the newest first"
    for number in ended:
        text = driver.message(str(number))
        together = [one for one in goals if one[0] == number or f"reach({one[1]},{one[0]})" in text]
        seen = [door for door in "de" if f"_shut({door})" in text]
        assert not can_be_met(program, together, seen)
        assert all(can_be_met(program, some, seen) for some in parts_of(together))
        assert all(can_be_met(program, together, some) for some in parts_of(seen))
    driver.finish()
    assert all(driver.states(str(number))[-1] == "succeeded" for number, _ in goals if number not in ended)


# -- statuses that the shipped programs report in cycles without a plan


@pytest.mark.slow
def test_statuses_of_cycles_without_plan_are_read():
    play(
        Driver.of_shipped("mailbot.lp", "office.lp"),
        """goal a goal(office2,office2,3); facts _blocked(office1,office2,now); add bad goal(office1,7,6)
        goal far goal(office1,office2,7); fail failed; is far aborted
        says bad the program rejects goal(office1,7,6): there is no place 7""",
    )
