"""Short drives: among the shortest plans, one with the least driving."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shipped import ENCODINGS

from rosoclingo.oclingo import ReactiveProgram, SolveOutcome, parse_update
from rosoclingo.oclingo.program.sources import Source
from rosoclingo.planning.solver import PlanSolver

#: Two routes of two moves lead from a to d, and a third of one move from d to e.
WAYS = ("ab", "ac", "bd", "cd", "de")
PLACES = sorted({*"".join(WAYS)})
PREFERS = Source.from_file(ENCODINGS / "delivery" / "short_drives.lp")


def floor(distances):
    facts = [f"office({one})." for one in PLACES] + [f"corridor({a},{b})." for a, b in WAYS]
    facts += [f"distance({a},{b},{d}). distance({b},{a},{d})." for (a, b), d in distances.items()]
    return Source("floor.lp", "#program base.\nstart(a).\n" + "\n".join(facts))


def plans(distances, requests, prefers, **options):
    sources = [Source.from_file(ENCODINGS / "mailbot.lp"), floor(distances), *([PREFERS] if prefers else [])]
    solver = PlanSolver(ReactiveProgram(sources), **options)
    facts = " ".join(f"_request(goal({a},{b},{number}),2)." for number, (a, b) in enumerate(requests, 1))
    result = solver.update(parse_update(f"#step 1. {facts} #endstep."))
    assert result.outcome is SolveOutcome.SATISFIABLE
    return [moves(answer) for answer in result.answers]


def moves(answer):
    """Return the places to which an answer drives, in order, and its number of actions."""
    actions = sorted((one.arguments for one in answer if one.name == "_action_lib"), key=lambda one: one[2].number)
    return [one[1].name for one in actions if one[0].name == "move_base"], len(actions)


def driven(places, distances):
    way = ["a", *places]
    return sum(distances.get((a, b), distances.get((b, a), 0)) for a, b in zip(way, way[1:]))


@pytest.mark.slow
@settings(max_examples=max(3, settings.default.max_examples // 20))
@given(
    st.fixed_dictionaries({(a, b): st.integers(1, 9) for a, b in WAYS}),
    st.lists(st.tuples(st.sampled_from(PLACES), st.sampled_from(PLACES)), min_size=1, max_size=2),
)
def test_short_drives_no_shortest_plan_drives_less(distances, requests):
    ((chosen, length),) = plans(distances, requests, prefers=True)
    every = plans(distances, requests, prefers=False, models=0)
    assert {number for _, number in every} == {length}
    assert driven(chosen, distances) == min(driven(places, distances) for places, _ in every)
