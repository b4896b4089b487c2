"""The bound of delivery on how long a plan takes at least: it changes no answer, and rules out what is hopeless."""

from dataclasses import replace

import clingo
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mailbot_world import ENCODINGS, fewest_steps, neighbours

from rosoclingo.oclingo import ReactiveProgram, StreamUpdate, fact, parse_atom
from rosoclingo.oclingo.program.sources import Source
from rosoclingo.planning.grounding import Grounding
from rosoclingo.planning.question import Question
from rosoclingo.planning.snapshot import Snapshot

EXAMPLES = settings(max_examples=max(1, settings.default.max_examples // 12))


def mailbot(corridors, capacity, bounded=True, **constants):
    """The mailbot on a floor, the robot in office 1; with the bound or without."""
    offices = {number for pair in corridors for number in pair}
    facts = [f"office(o{number})." for number in offices] + [f"corridor(o{a},o{b})." for a, b in corridors]
    floor = Source("floor", "#program base. start(o1). " + " ".join(facts))
    sources = [Source.from_file(ENCODINGS / "mailbot.lp"), floor]
    program = ReactiveProgram(sources, {"capacity": str(capacity), **constants})
    for part in program.parts:
        part.statements = [one for one in part.statements if bounded or not is_of_bound(one)]
    return program


def is_of_bound(statement):
    return statement.location.begin.filename.endswith("search.lp")


def solve(program, requests, horizon, conflicts="umax", models=0, facts=()):
    """Search for plans that end at the horizon, with so many conflicts at most; return the result and the plans.

    Beside the requests the ``facts`` are told.
    """
    control = ground(program, requests, horizon, facts)
    control.assign_external(clingo.parse_term(f"__oclingo_volatile(1,{horizon})"), True)
    control.configuration.solve.models = str(models)
    control.configuration.solve.solve_limit = f"{conflicts},umax"
    plans = set()
    result = control.solve(on_model=lambda model: plans.add(frozenset(map(str, model.symbols(shown=True)))))
    return result, plans


def ground(program, requests, horizon, facts=()):
    """Ground all steps up to the horizon, the requests told for cycle 2."""
    control = clingo.Control(program.arguments(), logger=lambda code, text: None)
    program.load_into(control)
    told = [f"_request(goal(o{a},o{b},{number}),2)." for number, (a, b) in enumerate(requests, 1)]
    told += [f"{fact}." for fact in facts]
    control.add("told", [], " ".join(told))
    control.ground([("base", []), ("told", [])])
    steps = [clingo.Number(step) for step in range(1, horizon + 1)]
    control.ground([(part, [step]) for step in steps for part in ("cumulative", "volatile")])
    return control


@pytest.mark.slow
@pytest.mark.once
@EXAMPLES
@given(st.data())
def test_it_changes_no_answer(data):
    """All the shortest plans of small floors, with it and without it, looking back at as little as is drawn."""
    count = data.draw(st.integers(2, 3))
    corridors = {(data.draw(st.integers(1, number - 1)), number) for number in range(2, count + 1)}
    corridors |= {(1, count)} if count > 2 and data.draw(st.booleans()) else set()
    office = st.integers(1, count)
    number, capacity = data.draw(st.sampled_from([(1, 1), (2, 1), (3, 1), (3, 2)]))
    requests = data.draw(st.lists(st.tuples(office, office), min_size=number, max_size=number))
    packages = tuple(("waits", f"o{a}", f"o{b}") for a, b in requests)
    fewest = fewest_steps(neighbours([(f"o{a}", f"o{b}") for a, b in corridors]), capacity, "o1", packages)
    window = str(data.draw(st.sampled_from([1, 3, 60])))
    ours, plans = solve(mailbot(corridors, capacity, _window=window), requests, fewest)
    assert ours.satisfiable
    assert plans == solve(mailbot(corridors, capacity, bounded=False), requests, fewest)[1]


@pytest.mark.slow
@pytest.mark.once
@pytest.mark.parametrize(("window", "hopeless"), [(1, 3), (60, 1)])
def test_what_has_to_go_in_several_loads_takes_as_long_as_it_takes(window, hopeless):
    """Seven packages, three at a time, over one corridor: there in three loads, or back."""
    there, back = [(1, 2)] * 7, [(2, 1)] * 7
    program = mailbot([(1, 2)], 3, _window=str(window))
    for requests, fewest in ((there, 14 + 5), (back, 14 + 6), (there + back, 28 + 6)):
        assert solve(program, requests, fewest - hopeless, conflicts=1)[0].unsatisfiable
        assert solve(program, requests, fewest, models=1)[0].satisfiable


@pytest.mark.slow
@pytest.mark.once
def test_what_is_far_too_short_is_refuted_at_once_however_long_it_is():
    """Twenty-four packages go from one end of a row to the other in eight loads: at least 48 + 15 * 5 actions."""
    program = mailbot([(1, 2), (2, 3), (3, 4), (4, 5), (5, 6)], 3)
    assert solve(program, [(1, 6)] * 24, 48 + 75 - 10, conflicts=1)[0].unsatisfiable


@pytest.mark.slow
def test_the_solver_is_told_how_long_it_takes_at_least():
    """Nearly: what is told grows by a quarter at first, beyond the look back by a sixteenth."""
    requests = [(1, 2)] * 7 + [(2, 1)] * 7
    assert 30 <= claimed(mailbot([(1, 2)], 3, _window="1"), requests) <= 28 + 6
    assert 27 <= claimed(mailbot([(1, 2)], 3), requests) <= 28 + 6
    assert claimed(mailbot([(1, 2)], 3), [(1, 2), (2, 1)]) == 0
    far = [(1, 6)] * 24
    row = [(1, 2), (2, 3), (3, 4), (4, 5), (5, 6)]
    assert 48 + 75 - 10 <= claimed(mailbot(row, 3), far) <= 48 + 75


def claimed(program, requests):
    """How many steps the program says that a plan takes at least, with a grounding of one step that was searched."""
    told = [parse_atom(f"_request(goal(o{a},o{b},{number}),2)") for number, (a, b) in enumerate(requests, 1)]
    update = StreamUpdate(1, None, tuple(map(fact, told)))
    snapshot = Snapshot.initial(program).with_update(update, program)
    found = []
    for one in (snapshot, replace(snapshot, step=2)):
        grounding = Grounding(program, one, 1)
        assert grounding.ask(Question(1, 1, believes=False), lambda: False).satisfiable is False
        found.append(grounding.claimed_steps())
    assert found[1] == 0
    return found[0]


@pytest.mark.slow
@pytest.mark.once
def test_goals_behind_a_shut_way_are_refuted_at_once_however_many_there_are():
    """Whatever else there is to do, and however many steps there are."""
    program = mailbot([(1, 2), (2, 3), (3, 4), (4, 5), (5, 6), (1, 3)], 3)
    near, far = [(1, 2), (2, 3), (3, 1), (2, 1)], [(1, 6), (5, 2), (6, 5), (3, 5)]
    shut = ["_blocked(o3,o4,1)"]
    for request in far:
        assert solve(program, [*near, request, *near], 60, conflicts=1, facts=shut)[0].unsatisfiable
    assert solve(program, near, 30, models=1, facts=shut)[0].satisfiable
    assert solve(program, near + far, 60, conflicts=1, models=1)[0].unsatisfiable is not True


def test_a_bound_is_made_anew_for_few_alone():
    """Nothing is ground for it where many come at once, and no more loads than few make where many have come before."""
    program = mailbot([(1, 2)], 3)
    assert steps_of("_check", ground(program, [(1, 2)] * 16, 20)) == {1, 9, 17}
    assert steps_of("_check", ground(program, [(1, 2)] * 17, 20)) == {1}
    more = [f"_request(goal(o1,o2,{number}),3)" for number in range(20, 36)]
    told, loads = ground(program, [(1, 2)] * 16, 20, more), {}
    for atom in told.symbolic_atoms.by_signature("_loads", 3):
        number, step = (one.number for one in atom.symbol.arguments[1:])
        loads[step] = max(loads.get(step, 0), number)
    assert loads == {1: 6, 2: 11, 10: 6, 18: 6}


def steps_of(name, control):
    return {atom.symbol.arguments[0].number for atom in control.symbolic_atoms.by_signature(name, 1)}


@pytest.mark.slow
@pytest.mark.parametrize("capacity", [0, -1])
def test_a_robot_that_can_carry_nothing_has_a_bound_that_ends(capacity):
    assert solve(mailbot([(1, 2)], capacity), [(1, 2), (2, 1)], 9)[0].unsatisfiable
