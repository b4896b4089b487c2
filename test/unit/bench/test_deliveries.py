"""The deliveries that benches measure: instances, rules, and routes as actions, checked by the mailbot's world."""

import sys

import deliveries
import peers
import pytest
from deliveries import Request, office_of, task_of
from mailbot_world import fewest_steps, neighbours
from planning_domains import RuleError, check

from rosoclingo.oclingo import StreamUpdate, fact, parse_term
from rosoclingo.planning.history import Plan
from rosoclingo.planning.solver import PlanSolver

FLOORS = [deliveries.row(4), deliveries.row(7), deliveries.loops()]


def world(*requests, floor=FLOORS[0]):
    return task_of(floor, requests).world()


@pytest.mark.parametrize("floor", FLOORS, ids=lambda floor: floor.name)
def test_deliveries_distance_equals_length_of_shortest_way(floor):
    graph = neighbours(floor.corridors)
    offices = range(1, floor.offices + 1)
    distances = {(here, there): moves for here in offices for there, moves in floor.distances_from(here).items()}
    assert len(distances) == floor.offices**2, "some office can't be reached"
    for (start, end), moves in distances.items():
        way = floor.way(start, end)
        assert len(way) == moves
        assert all(there in graph[here] for here, there in zip([start, *way], way))
        assert [start, *way][-1] == end
    assert all(abs(distances[a, c] - distances[b, c]) <= 1 for a, b in floor.corridors for c in graph)


def test_deliveries_floor_with_loops_has_two():
    floor = deliveries.loops()
    assert len(floor.corridors) - floor.offices + 1 == 2


def test_deliveries_requests_follow_from_their_seed():
    requests = deliveries.random_requests(FLOORS[0], 50, seed=1)
    assert [request.number for request in requests] == list(range(1, 51))
    assert all(request.start != request.end for request in requests)
    assert {one for request in requests for one in request[1:]} == {1, 2, 3, 4}
    assert requests == deliveries.random_requests(FLOORS[0], 50, seed=1)
    assert requests != deliveries.random_requests(FLOORS[0], 50, seed=2)


@pytest.mark.parametrize("name", ["1", "0", "-3", "ring", ""])
def test_deliveries_report_a_malformed_floor(name):
    with pytest.raises(ValueError, match="a floor is"):
        deliveries.floor_named(name)


def test_deliveries_floors_have_names():
    assert deliveries.floor_named("7") == deliveries.row(7)
    assert deliveries.floor_named("loops") == deliveries.loops()


@pytest.mark.parametrize(
    ("before", "action"),
    [
        ([], ("move_base", "office3")),
        ([], ("move_base", "office9")),
        ([], ("pickup", "2")),
        ([], ("pickup", "9")),
        ([("pickup", "1")], ("pickup", "1")),
        ([("pickup", "1"), ("pickup", "3"), ("pickup", "4")], ("pickup", "5")),
        ([("pickup", "1")], ("deliver", "1")),
        ([("move_base", "office2")], ("deliver", "1")),
        ([("pickup", "1"), ("move_base", "office2"), ("deliver", "1")], ("deliver", "1")),
        ([], ("fly", "office2")),
    ],
)
def test_deliveries_refused_action_changes_nothing(before, action):
    here = world(Request(1, 1, 2), Request(2, 2, 1), Request(3, 1, 4), Request(4, 1, 4), Request(5, 1, 4))
    for one in before:
        here.do([one])
    left = here.copy()
    with pytest.raises(RuleError, match=action[1]):
        here.do([action])
    assert (here.state, here.open) == (left.state, left.open)


def test_deliveries_copy_is_independent():
    here = world(Request(1, 1, 2))
    there, before = here.copy(), set(here.state)
    for action in (("pickup", "1"), ("move_base", "office2"), ("deliver", "1")):
        there.do([action])
    assert (here.state, [*here.open]) == (before, [1])
    assert (there.at_rest, there.open, office_of(there)) == (True, {}, 2)


@pytest.mark.parametrize(
    "floor",
    [FLOORS[0], *(pytest.param(one, marks=pytest.mark.slow) for one in FLOORS[1:])],
    ids=lambda floor: floor.name,
)
def test_deliveries_shortest_plan_is_valid_and_minimal(floor):
    requests = deliveries.random_requests(floor, 2 if floor.offices > 10 else 3, seed=1)
    message = tuple(fact(parse_term(f"_request({request.goal},2)")) for request in requests)
    result = PlanSolver(floor.program, horizon_limit=200).update(StreamUpdate(1, None, message))
    actions = sorted((one.arguments for one in Plan.from_result(result).actions), key=lambda action: action[2].number)
    check(world(*requests, floor=floor), [[(str(interface), str(parameter))] for interface, parameter, _ in actions])
    waiting = [("waits", request.start, request.end) for request in requests]
    assert len(actions) == fewest_steps(neighbours(floor.corridors), deliveries.CAPACITY, 1, waiting)


def test_deliveries_route_is_executed_as_actions():
    floor, first, second = deliveries.row(4), Request(1, 3, 1), Request(2, 2, 4)
    here = world(first, second, floor=floor)
    here.do([("move_base", "office2")])
    here.do([("pickup", "2")])
    visits = [("pickup", first), ("deliver", second), ("deliver", first)]
    actions = deliveries.actions_of_route(floor, office_of(here), visits)
    check(here, [[action] for action in actions])
    assert len(actions) == 1 + 1 + 1 + 1 + 3 + 1


STAND_IN = """#!{python}
import json, os, signal, sys
problem = json.load(sys.stdin)
assert [problem[one] for one in ("robots", "waiting", "carried", "capacity", "seconds")] == [1, 1, 1, 3, 5]
assert problem["times"] == [[0, 1, 1, 2], [2, 1, 3, 2], [2, 3, 1, 4], [3, 2, 4, 1]]
for route in {routes}:
    print(json.dumps([route]), flush=True)
os.kill(os.getpid(), signal.SIG{end})
"""


@pytest.fixture
def stand_in(tmp_path, monkeypatch):
    """Stands in for a Python with OR-Tools: a program that writes routes and ends by a signal."""

    def make(routes, end="PROF"):
        path = tmp_path / "python"
        path.write_text(STAND_IN.format(python=sys.executable, routes=routes, end=end))
        path.chmod(0o755)
        monkeypatch.setenv(peers.PYTHON, str(path))

    return make


def test_deliveries_last_route_counts(stand_in):
    stand_in([[2, 0, 1], [0, 2, 1]])
    carried, waiting = Request(1, 1, 4), Request(2, 3, 1)
    visits = [("pickup", waiting), ("deliver", carried), ("deliver", waiting)]
    assert peers.routes(deliveries.row(4), [2], [waiting], [carried]) == [visits]


@pytest.mark.parametrize(("routes", "end"), [([], "PROF"), ([[2, 0, 1]], "KILL")])
def test_deliveries_report_a_failed_search(stand_in, routes, end):
    stand_in(routes, end)
    with pytest.raises(peers.RoutingError, match="no route"):
        peers.routes(deliveries.row(4), [2], [Request(2, 3, 1)], [Request(1, 1, 4)])


def test_deliveries_reject_a_python_without_or_tools(stand_in, monkeypatch, capsys):
    monkeypatch.setenv(peers.PYTHON, "/no/such/python")
    peers.folder_of.cache_clear()
    assert peers.folder_of(peers.OR_TOOLS) is None
    assert "./dev bench" in capsys.readouterr().out
    peers.folder_of.cache_clear()
