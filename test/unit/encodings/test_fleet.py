"""The fleet encoding, driven by the core: a world in plain Python executes the actions and refuses collisions."""

import copy
import re
from functools import partial
from random import Random

import pytest
from core_driver import Driver, shortest, soon
from deliveries import Floor, Request, row
from fleet_world import FleetWorld, fleet_program
from hypothesis import given, settings
from hypothesis import strategies as st
from planning_domains import RuleError
from shipped import ENCODINGS

from rosoclingo.oclingo import ReactiveProgram, parse_update
from rosoclingo.oclingo.program.sources import Source
from rosoclingo.planning.grounding import FOLLOWING
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.reasoning.events import ActionsDispatched
from rosoclingo.reasoning.settings import CoreSettings

RUNS = settings(max_examples=max(1, settings.default.max_examples // 5))
RING = ((1, 2), (2, 3), (3, 4), (4, 5), (5, 6), (6, 1))


def floor_of(corridors):
    """Return the floor with these corridors."""
    return Floor("test", max(max(pair) for pair in corridors), frozenset(corridors))


class Fleet(Driver):
    """A core whose actions the world begins; the test ends each of them, in any order.

    Attributes:
        under_way: robot -> action.

    """

    def __init__(self, corridors, starts, solver=soon, **constants):
        floor = floor_of(corridors)
        used = dict(sorted(starts.items())[: constants.get("robots")])
        self.world, self.under_way, self._seen = FleetWorld(floor, used, 1), {}, 0
        program = fleet_program(floor, starts, **constants)
        super().__init__(program=program, solver=solver, settings=CoreSettings())

    def run(self):
        """Advance, and begin the actions that the core has sent."""
        super().run()
        events = self.journal.of(ActionsDispatched)
        for action in [one for event in events[self._seen :] for one in event.actions]:
            robot, verb, what = _words(action)
            self.world.begin(robot, verb, what)
            self.under_way[robot] = action
        self._seen = len(events)
        return self

    def ask(self, number, start, end):
        """Send a goal."""
        self.world.ask([Request(number, start, end)])
        return self.goal(str(number), f"goal(office{start},office{end},{number})")

    def take_back(self, number):
        """Cancel a goal."""
        self.world.cancel(number)
        return self.cancel(str(number))

    def end(self, robot):
        """Let the action of a robot succeed."""
        action = self.under_way.pop(robot)
        self.world.end(robot)
        return self.facts(f"_return({action.interface},{action.parameter},{action.cycle})")

    def break_off(self, robot, reason="failed"):
        """Let the action of a robot fail."""
        action = self.under_way.pop(robot)
        self.world.fail(robot)
        return self.facts(f"_return({action.interface},{reason},{action.cycle})")

    def end_all(self):
        """Let all actions succeed until none is under way; robots end in turns."""
        for _ in range(500):
            if not self.under_way:
                return self
            self.end(next(iter(self.under_way)))
        raise AssertionError("the fleet does not come to rest")

    def last(self, number):
        """Return the last state of a goal."""
        return self.states(str(number))[-1]

    def ungiven(self):
        """Return the waiting packages that no robot is to pick up in the plan, nor picks up."""
        planned = [_words(one) for one in self.core.plan.remaining(self.core.cycle)]
        return set(self.world.waiting) - {what for _, verb, what in planned if verb == "pickup"}

    def superfluous(self):
        """Return the planned actions without which the rest of the plan still serves all packages."""
        planned = self.core.plan.remaining(self.core.cycle + 1)
        return [one for one in planned if self._serves([other for other in planned if other != one])]

    def _serves(self, actions):
        """Return whether these actions, cycle by cycle, serve all packages."""
        world = copy.deepcopy(self.world)
        try:
            for cycle in [None, *sorted({one.cycle for one in actions})]:
                for robot, verb, what in (_words(one) for one in actions if one.cycle == cycle):
                    world.begin(robot, verb, what)
                for robot in list(world.acts):
                    world.end(robot)
        except RuleError:
            return False
        return not world.open


def _words(action):
    """Return robot, verb and object of an action, for the world."""
    return str(action.interface.arguments[0]), action.interface.name, int(re.sub(r"\D", "", str(action.parameter)))


@pytest.mark.sampled(1)
@pytest.mark.slow
@pytest.mark.parametrize("robots", [3, 2, 4])
def test_fleet_rests_only_if_each_request_has_a_robot(robots):
    """In each cycle with a robot that does nothing, the plan gives each waiting package to some robot."""
    random, resting = Random(robots), 0
    fleet = Fleet((*RING, (1, 4)), dict(zip(("r1", "r2", "r3", "r4"), (1, 3, 5, 6))), robots=robots)
    for number in [*range(1, 9), *[None] * 200]:
        if number is not None:
            fleet.ask(number, *random.sample(range(1, 7), 2))
        for _ in range(random.randint(1, 4)):
            if len(fleet.under_way) < robots and fleet.world.waiting:
                resting += 1
                assert not fleet.ungiven()
            if fleet.under_way:
                fleet.end(random.choice(sorted(fleet.under_way)))
    assert {fleet.last(number) for number in range(1, 9)} == {"succeeded"}
    assert resting, "no robot ever rests while a package waits"


@pytest.mark.slow
def test_fleet_robots_do_not_wait_for_a_lost_robot():
    """While the action of r1 neither returns nor fails, r2 drives around both ends of its connection."""
    fleet = Fleet(RING, {"r1": 1, "r2": 4})
    fleet.ask(1, 2, 4)
    assert _words(fleet.under_way.pop("r1")) == ("r1", "move_base", 2)
    fleet.facts("_lost(r1,now)").ask(2, 6, 3).end_all()
    assert fleet.last(2) == "succeeded"


def test_fleet_uses_the_first_robots():
    fleet = Fleet(RING, {"r1": 1, "r2": 4, "r3": 5}, robots=1)
    fleet.ask(1, 4, 5).end_all()
    assert (fleet.last(1), fleet.world.at["r1"]) == ("succeeded", 5)


@pytest.mark.slow
def test_fleet_hands_the_goals_of_a_lost_robot_to_others():
    fleet = Fleet(RING, {"r1": 1, "r2": 4})
    fleet.ask(1, 1, 2).end("r1")  # on board of r1
    fleet.ask(2, 6, 5)
    fleet.facts("_lost(r1,now)")
    assert fleet.last(1) == "aborted"
    assert "package 1 is on robot r1, which is out of service" in fleet.message("1")
    fleet.under_way.pop("r1", None)
    fleet.end_all()
    assert (fleet.last(2), fleet.world.delivered) == ("succeeded", [2])


def _atoms_after_request(*facts):
    """Return the most ground atoms of a plan after these facts about robots on a grid, and after a further request."""
    sizes = []

    class SizedSolver(PlanSolver):
        def search(self, update, stopped):
            if update is not None:
                self.inquire(update, frozenset(), frozenset())
                sizes.append(len(self.probed_atoms()))
            return super().search(update, stopped)

    grid = [(one, one + 1) for one in range(1, 12) if one % 4] + [(one, one + 4) for one in range(1, 9)]
    fleet = Fleet(grid, {"r1": 1, "r2": 4, "r3": 10}, solver=partial(SizedSolver, plan_time=1.0))
    fleet.ask(1, 5, 12).ask(2, 2, 7).end("r2")
    fleet.facts(*facts).ask(3, 3, 9)
    return max(sizes)


@pytest.mark.slow
def test_fleet_plans_with_lost_robots_are_not_much_larger():
    """The paths around a lost robot are computed once, from the known state, not for each possible one."""
    assert _atoms_after_request("_lost(r3,now)") < 2 * _atoms_after_request()


def _steps(atoms, name):
    """Return the steps of the atoms with this name."""
    return [one.arguments[-1].number for one in atoms if one.name == name]


@pytest.mark.slow
def test_fleet_expects_drives_to_end_after_the_next_steps():
    """Robots can be between two places only in the steps in which actions can go on, so later steps are smaller."""
    solver = soon(fleet_program(row(9), {"r1": 1, "r2": 4}))
    update = parse_update("#step 1 : 40. _request(goal(office9,office1,1),2). #endstep.")
    solver.inquire(update, frozenset(), frozenset())
    driving, placed = (max(_steps(solver.probed_atoms(), name)) for name in ("_toward", "at"))
    assert driving == 1 + FOLLOWING < placed


@pytest.mark.slow
def test_fleet_continues_with_a_robot_that_is_back():
    fleet = Fleet(RING, {"r1": 1})
    fleet.ask(1, 1, 2).end("r1")
    fleet.facts("_lost(r1,now)")
    assert fleet.last(1) == "aborted"
    fleet.break_off("r1").facts("_back(r1,now)")
    fleet.goal("again", "goal(office1,office3,1)")
    fleet.world.load["r1"][1] = 3
    assert fleet.end_all().states("again")[-1] == "succeeded"


@pytest.mark.slow
def test_fleet_robot_that_fails_is_out_of_service():
    fleet = Fleet(RING, {"r1": 1, "r2": 4}, tries=2)
    fleet.ask(1, 1, 2)
    for _ in range(10):
        if "r1" in fleet.under_way:
            fleet.break_off("r1")
        elif fleet.under_way:
            fleet.end("r2")
    assert fleet.last(1) == "aborted"  # r1 holds the place of the package
    assert "office1" in fleet.message("1")


@pytest.mark.slow
def test_fleet_decommissioned_robot_delivers_its_load_only():
    fleet = Fleet(RING, {"r1": 1, "r2": 4})
    fleet.ask(1, 1, 2).end("r1")
    fleet.facts("_decommission(r1,now)").ask(2, 2, 3).end_all()
    assert (fleet.last(1), fleet.last(2)) == ("succeeded", "succeeded")
    assert [str(one) for one in fleet.journal.actions if "pickup(r1)" in str(one)] == ["_action_lib(pickup(r1),1,1)"]


@pytest.mark.parametrize(
    ("fact", "last", "text"),
    [
        ("_decommission(r1,now)", "succeeded", ""),
        ("_blocked(office1,office2,now)", "aborted", "no robot in service can fetch it"),
    ],
)
def test_fleet_facts_during_a_pickup_are_accepted(fact, last, text):
    fleet = Fleet(((1, 2),), {"r1": 1})
    fleet.ask(1, 1, 2).facts(fact)
    fleet.world.allow_return(1)  # the package of an aborted goal
    fleet.end_all()
    assert fleet.problems == []
    assert fleet.last(1) == last
    assert text in fleet.message("1")


EVENTS = ("end", "end", "end", "ask", "fail", "cancel", "lost", "back", "decommission", "recommission")


@pytest.mark.slow
@RUNS
@given(st.data())
def test_fleet_never_collides_and_ends_each_goal(data):
    corridors = data.draw(st.sampled_from([RING, (*RING, (1, 4)), (*RING, (2, 7), (5, 8))]))
    robots = data.draw(st.integers(1, 3))
    fleet = Fleet(corridors, dict(zip(("r1", "r2", "r3"), (1, 3, 5)[:robots])), capacity=3)
    offices, names = st.integers(1, max(max(corridors))), st.sampled_from(sorted(fleet.world.at))
    asked = 0
    for _ in range(data.draw(st.integers(4, 16), label="events")):
        event, robot = data.draw(st.sampled_from(EVENTS)), data.draw(names)
        if event == "ask":
            asked += 1
            fleet.ask(asked, data.draw(offices), data.draw(offices))
        elif event == "cancel" and asked:
            number = data.draw(st.integers(1, asked))
            if fleet.last(number) == "active":
                fleet.take_back(number)
        elif event in ("end", "fail") and fleet.under_way:
            robot = data.draw(st.sampled_from(sorted(fleet.under_way)))
            fleet.end(robot) if event == "end" else fleet.break_off(
                robot, data.draw(st.sampled_from(["failed", "blocked"]))
            )
        elif event in ("lost", "back", "decommission", "recommission"):
            fleet.facts(f"_{event}({robot},now)")
        assert not fleet.superfluous()
    for robot in fleet.world.at:
        fleet.facts(f"_back({robot},now)", f"_recommission({robot},now)")
    fleet.end_all()
    ends = {number: fleet.last(number) for number in range(1, asked + 1)}
    assert set(ends.values()) <= {"succeeded", "preempted", "aborted"}, ends
    assert {number for number, end in ends.items() if end == "succeeded"} <= set(fleet.world.delivered), ends


@pytest.mark.slow
def test_fleet_robot_charges_in_time():
    texts = [Source.from_file(ENCODINGS / name) for name in ("fleet.lp", "fleet/battery.lp")]
    row = "".join(f"office(office{one}). " for one in range(1, 5)) + "".join(
        f"corridor(office{one},office{one + 1}). " for one in range(1, 4)
    )
    floor = Source("floor", f"#program base. {row} start(r1,office1). charger(office1).\n")
    driver = Driver(program=ReactiveProgram([*texts, floor], {"charge": "6"}), solver=shortest, settings=CoreSettings())
    driver.goal("1", "goal(office1,office4,1)").goal("2", "goal(office1,office4,2)").facts(
        "_battery(r1,2,now)"
    ).finish()
    assert [driver.states(key)[-1] for key in "12"] == ["succeeded", "succeeded"]
    drives, least = 0, 0
    for action in map(str, driver.journal.actions):
        drives = 0 if "charge" in action else drives + ("move_base" in action)
        least = max(least, drives)
    assert any("charge(r1)" in str(one) for one in driver.journal.actions)
    assert least <= 6
