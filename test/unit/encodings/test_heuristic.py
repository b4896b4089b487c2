"""The heuristic and the plan-length bound of delivery: unchanged answers, and proofs at once."""

from itertools import chain

import clingo
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mailbot_world import fewest_steps, neighbours, program

from rosoclingo.oclingo import ReactiveProgram

ANSWERS = settings(max_examples=max(1, settings.default.max_examples // 4))


def mailbot(corridors, capacity=3, **constants):
    """Return the mailbot on a floor, the robot in office 1."""
    whole = program(max(max(pair) for pair in corridors), tuple(corridors), 1, capacity)
    return ReactiveProgram(whole.sources, {"capacity": str(capacity), **constants}) if constants else whole


def without(file, whole):
    """Return the same program without the rules of a file."""
    bare = ReactiveProgram(whole.sources, {name: str(value) for name, value in whole.constants.items()})
    for part in bare.parts:
        part.statements = [one for one in part.statements if not one.location.begin.filename.endswith(file)]
    return bare


def ground(program, requests, horizon, facts=()):
    """Return a control grounded up to the horizon, where a plan has to end."""
    control = clingo.Control(program.arguments(), logger=lambda code, text: None)
    control.configuration.solver.heuristic = "Domain"
    program.load_into(control)
    items = [f"_request(goal(o{a},o{b},{number}),2)." for number, (a, b) in enumerate(requests, 1)]
    control.add("stream", [], " ".join([*items, *(f"{fact}." for fact in facts)]))
    control.ground([("base", []), ("stream", [])])
    steps = [[("cumulative", [number]), ("volatile", [number])] for number in map(clingo.Number, range(1, horizon + 1))]
    control.ground(list(chain(*steps)))
    control.assign_external(clingo.parse_term(f"__oclingo_volatile(1,{horizon})"), True)
    return control


@pytest.mark.slow
@pytest.mark.parametrize("file", ["heuristic.lp", "search.lp", "faults.lp"])
@ANSWERS
@given(st.data())
def test_heuristic_changes_no_answer(file, data):
    """Compare all shortest plans of small floors, with and without a file's rules, for short and long look-backs."""
    count = data.draw(st.integers(2, 4 if file == "heuristic.lp" else 3))
    corridors = {(data.draw(st.integers(1, number - 1)), number) for number in range(2, count + 1)}
    corridors |= {(1, count)} if count > 2 and data.draw(st.booleans()) else set()
    office = st.integers(1, count)
    number, capacity = data.draw(st.sampled_from([(1, 1), (2, 1), (2, 2), *([(3, 1), (3, 2)] if count < 4 else [])]))
    requests = data.draw(st.lists(st.tuples(office, office), min_size=number, max_size=number))
    packages = tuple(("waits", f"o{a}", f"o{b}") for a, b in requests)
    fewest = fewest_steps(neighbours([(f"o{a}", f"o{b}") for a, b in corridors]), capacity, "o1", packages)
    window = str(data.draw(st.sampled_from([1, 3, 60])))
    whole = mailbot(tuple(sorted(corridors)), capacity, _window=window)
    if fewest:
        assert solve(whole, requests, fewest - 1)[0].unsatisfiable
    ours, plans = solve(whole, requests, fewest)
    assert ours.satisfiable
    assert plans == solve(without(file, whole), requests, fewest)[1]


def solve(program, requests, horizon, conflicts="umax", models=0, facts=()):
    """Search for plans that end at the horizon, with a limit of conflicts; return the result and the plans."""
    control = ground(program, requests, horizon, facts)
    control.configuration.solve.models = str(models)
    control.configuration.solve.solve_limit = f"{conflicts},umax"
    plans = set()
    result = control.solve(on_model=lambda model: plans.add(frozenset(map(str, model.symbols(shown=True)))))
    return result, plans


# -- the bound on the steps of a plan


@pytest.mark.slow
def test_plan_bound_refutes_goals_behind_blocked_way_at_once():
    """This holds for any number of other goals and of steps."""
    program = mailbot([(1, 2), (2, 3), (3, 4), (4, 5), (5, 6), (1, 3)], 3)
    near, far = [(1, 2), (2, 3), (3, 1), (2, 1)], [(1, 6), (5, 2), (6, 5), (3, 5)]
    shut = ["_blocked(o3,o4,1)"]
    for request in far:
        assert solve(program, [*near, request, *near], 60, conflicts=1, facts=shut)[0].unsatisfiable
    assert solve(program, near, 30, models=1, facts=shut)[0].satisfiable
    assert solve(program, near + far, 60, conflicts=1, models=1)[0].unsatisfiable is not True
