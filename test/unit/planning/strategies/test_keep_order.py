"""The rest of a plan when actions take longer: each robot acts as early as the order of the plan allows."""

from collections import Counter
from itertools import groupby

import clingo
from hypothesis import given
from hypothesis import strategies as st

from rosoclingo.planning.history import Plan, cycle_of
from rosoclingo.planning.strategies.keep_order import rescheduled

CORRIDORS = {"a": "b", "b": "acx", "c": "bd", "d": "c", "x": "b"}
"""A row of four places, and one at its side."""


def act(cycle, name, what):
    return clingo.parse_term(f"_action_lib({name},{what},{cycle})")


def plan_of(*acts):
    """Return a plan for texts such as "1 go(r1) b"."""
    return Plan(frozenset(act(*one.split()) for one in acts), max(int(one.split()[0]) for one in acts))


def after(plan, step, *running):
    """Return the acts from ``step`` on, as texts sorted by cycle; those of the cycle before are still ``running``."""
    going = [clingo.Function("_running", act(step - 1, *one.split()).arguments) for one in running]
    acts = sorted(rescheduled(plan, going, step).actions, key=lambda one: (cycle_of(one), one))
    return [f"{cycle_of(one)} {one.arguments[0]} {one.arguments[1]}" for one in acts]


def test_a_robot_drives_on_until_another_one_is_in_its_way():
    """Robot r2 goes on to b, and waits there until r1 has left c."""
    plan = plan_of(
        *("1 go(r1) c", "2 take(r1) 1", "3 go(r1) d", "1 go(r2) a", "2 go(r2) b", "4 go(r2) c", "5 go(r2) b"),
    )
    found = after(plan, 2, "go(r1) c")
    assert found[:4] == ["2 go(r1) c", "2 go(r2) b", "3 take(r1) 1", "4 go(r1) d"]
    assert found[4:] == ["5 go(r2) c", "6 go(r2) b"]
    assert after(plan, 3, "take(r1) 1") == ["3 take(r1) 1", "4 go(r1) d", "5 go(r2) c", "6 go(r2) b"]


def test_a_wait_without_a_reason_ends():
    plan = plan_of("1 go(r1) b", "2 go(r1) a", "5 go(r2) d", "6 go(r2) c", "7 go(r2) d")
    assert after(plan, 2, "go(r1) b") == ["2 go(r1) b", "2 go(r2) d", "3 go(r1) a", "3 go(r2) c", "4 go(r2) d"]


def test_tasks_with_the_same_parameter_keep_their_order():
    plan = plan_of("1 go(r1) b", "2 put(r1) 1", "3 take(r2) 1", "4 go(r1) a", "5 go(r1) b")
    assert "4 take(r2) 1" in after(plan, 2, "go(r1) b")


def test_both_robots_of_a_joint_action_wait_for_it():
    plan = plan_of("1 lift(r1,r2) box", "2 go(r1) b", "2 go(r2) b", "1 go(r3) c", "3 go(r3) d", "4 go(r1) c")
    found = after(plan, 2, "lift(r1,r2) box")
    assert found == ["2 go(r3) d", "2 lift(r1,r2) box", "3 go(r1) b", "3 go(r2) b", "4 go(r1) c"]


def test_interfaces_without_robots_keep_their_steps():
    plan = plan_of("1 go b", "2 take 1", "2 look 1", "3 go a")
    assert after(plan, 2, "go b") == ["2 go b", "3 look 1", "3 take 1", "4 go a"]


def test_further_steps_at_the_end_stay():
    plan = plan_of("1 go(r1) b", "2 go(r1) a", "3 go(r1) b")._replace(horizon=5)
    going = [clingo.parse_term("_running(go(r1),b,1)")]
    assert rescheduled(plan, going, 2).horizon == 6
    assert rescheduled(plan_of("1 go(r1) b"), going, 2).horizon == 2


@given(st.integers(1, 3), st.integers(2, 4), st.integers(2, 12), st.randoms(use_true_random=False))
def test_robots_do_not_collide_and_act_at_most_a_step_later(room, robots, steps, draw):
    """In random plans of robots that drive and do tasks, for any of them whose actions go on."""
    names = [f"r{number}" for number in range(1, robots + 1)]
    at = dict(zip(names, draw.sample([place for place in CORRIDORS for _ in range(room)], robots)))
    acts = [act(0, f"go({robot})", place) for robot, place in at.items()]
    for cycle in range(1, steps + 1):
        moves = {}
        for robot in draw.sample(names, robots):
            place = draw.choice(CORRIDORS[at[robot]])
            if draw.random() < 0.6 and fits({**moves, robot: place}, at, room):
                moves[robot] = place
                acts.append(act(cycle, f"go({robot})", place))
            elif draw.random() < 0.3:
                acts.append(act(cycle, f"take({robot})", len(acts)))
        at.update(moves)
    plan, step = Plan(frozenset(acts), steps), draw.randint(2, steps)
    going = {one.arguments[0]: one for one in acts if cycle_of(one) == step - 1 and draw.random() < 0.5}
    found = rescheduled(plan, [clingo.Function("_running", one.arguments) for one in going.values()], step)
    for robot in names:
        own = [one for one in sorted(acts, key=cycle_of) if str(one.arguments[0].arguments[0]) == robot]
        done = [one for one in own if cycle_of(one) < step and one is not going.get(one.arguments[0])]
        at[robot] = [str(one.arguments[1]) for one in done if one.arguments[0].name == "go"][-1]
        new = [one for one in sorted(found.actions, key=cycle_of) if str(one.arguments[0].arguments[0]) == robot]
        assert [one.arguments[:2] for one in new] == [one.arguments[:2] for one in own[len(done) :]]
        assert all(cycle_of(b) <= cycle_of(a) + 1 for a, b in zip(own[len(done) :], new))
    for _, group in groupby(sorted(found.actions, key=cycle_of), key=cycle_of):
        goes = [one.arguments for one in group if one.arguments[0].name == "go"]
        moves = {str(name.arguments[0]): str(place) for name, place, _ in goes}
        assert fits(moves, at, room)
        at.update(moves)


def fits(moves, at, room):
    """Return whether robots ``at`` places can move at once: a moving robot holds both places."""
    held = Counter([*at.values(), *moves.values()])
    swaps = any(at[other] == place and moves[other] == at[one] for one, place in moves.items() for other in moves)
    return all(held[place] <= room for place in moves.values()) and not swaps
