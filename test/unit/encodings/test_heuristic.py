"""The heuristic and the plan-length bound of delivery: fast plans, unchanged answers, few ground rules."""

from dataclasses import replace
from itertools import chain

import clingo
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mailbot_world import fewest_steps, neighbours, program
from shipped import shipped

from rosoclingo.oclingo import ReactiveProgram, StreamUpdate, fact, parse_atom
from rosoclingo.planning.grounding import Grounding
from rosoclingo.planning.question import Question
from rosoclingo.planning.snapshot import Snapshot

LIMIT = 50  # conflicts within which a plan has to be found
ANSWERS = settings(max_examples=max(1, settings.default.max_examples // 12))

ROW = tuple((number, number + 1) for number in range(1, 20))
STAR = tuple((1, number) for number in range(2, 21))
THETA = (*((number, number + 1) for number in range(1, 12)), (1, 12), (4, 10))
MESH = tuple((a, a + step) for a in range(1, 17) for step in (1, 4) if (a < 13 if step == 4 else a % 4))


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


def errands(number, offices):
    """Return a number of requests between offices, always the same."""
    pairs = ((7 * one % offices + 1, (3 * one + one // 5 + 2) % offices + 1) for one in range(number))
    return [(a, b if b != a else b % offices + 1) for a, b in pairs]


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


def plan(control, conflicts=LIMIT):
    """Return the ordered actions of the first plan, None without a plan within the limit of conflicts."""
    control.configuration.solve.solve_limit = f"{conflicts},umax"
    with control.solve(yield_=True) as handle:
        model = handle.model()
        return model and actions(model)


def actions(model):
    found = [one for one in model.symbols(shown=True) if one.name == "_action_lib"]
    return tuple(sorted(found, key=lambda one: one.arguments[2]))


def nearest_first(corridors, requests, capacity=3):
    """Return the length of the plan that always drives to the nearest useful place."""
    graph, office, steps, load, waits = neighbours(corridors), 1, 0, [], list(requests)
    while load or waits:
        if any(end == office for _, end in load):
            load.remove(next(one for one in load if one[1] == office))
        elif len(load) < capacity and any(start == office for start, _ in waits):
            load.append(waits.pop([start for start, _ in waits].index(office)))
        else:
            targets = {end for _, end in load} | ({start for start, _ in waits} if len(load) < capacity else set())
            office = first_step(graph, office, targets)
        steps += 1
    return steps


def first_step(graph, office, targets):
    """Return the first move from an office to the nearest of some others."""
    queue = [(one, one) for one in sorted(graph[office])]
    for first, here in queue:
        if here in targets:
            return first
        queue += [(first, one) for one in sorted(graph[here])]
    raise AssertionError("no way")


@pytest.mark.sampled(2)
@pytest.mark.slow
@pytest.mark.parametrize(("corridors", "number"), [(ROW[:3], 20), (STAR, 8), (THETA, 10), (MESH, 8)])
def test_heuristic_finds_plan_for_many_requests_without_conflicts(corridors, number):
    offices = max(max(pair) for pair in corridors)
    requests = errands(number, offices)
    longest = 3 * nearest_first(corridors, requests) // 2
    control = ground(mailbot(corridors), requests, longest)
    found = plan(control)
    assert found is not None
    assert sum(one.arguments[0].name == "deliver" for one in found) == number


@pytest.mark.slow
@pytest.mark.parametrize("file", ["heuristic.lp", "search.lp"])
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


def test_heuristic_of_a_domain_applies_to_the_house():
    house = shipped("house.lp", "home.lp")
    kinds = {str(one.ast_type) for part in house.parts for one in part.statements}
    assert any("Heuristic" in kind for kind in kinds)


# -- the bound on the steps of a plan


@pytest.mark.slow
def test_plan_bound_reaches_the_solver():
    """The bound grows by a quarter at first, and by a sixteenth beyond the look-back."""
    requests = [(1, 2)] * 7 + [(2, 1)] * 7
    assert 30 <= claimed(mailbot([(1, 2)], 3, _window="1"), requests) <= 28 + 6
    assert 27 <= claimed(mailbot([(1, 2)], 3), requests) <= 28 + 6
    assert claimed(mailbot([(1, 2)], 3), [(1, 2), (2, 1)]) == 0
    far = [(1, 6)] * 24
    row = [(1, 2), (2, 3), (3, 4), (4, 5), (5, 6)]
    assert 48 + 75 - 10 <= claimed(mailbot(row, 3), far) <= 48 + 75


def claimed(program, requests):
    """Return the program's lower bound for a plan, from a grounding of one step after a search."""
    reported = [parse_atom(f"_request(goal(o{a},o{b},{number}),2)") for number, (a, b) in enumerate(requests, 1)]
    update = StreamUpdate(1, None, tuple(map(fact, reported)))
    snapshot = Snapshot.initial(program).with_update(update, program)
    found = []
    for one in (snapshot, replace(snapshot, step=2)):
        grounding = Grounding(program, one, 1)
        assert grounding.ask(Question(1, 1, believes=False), lambda: False).satisfiable is False
        found.append(grounding.claimed_steps())
    assert found[1] == 0
    return found[0]


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
