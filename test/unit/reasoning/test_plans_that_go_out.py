"""Each plan that goes out is one, by rules written apart from the program: on any floor, with failures, and improved.

With ``~plan: shortest`` each has as few steps as a search from scratch finds. Improving changes nothing that is done or
under way.
"""

from functools import partial

import pytest
from core_driver import Driver, shortest, soon
from hypothesis import given, settings
from hypothesis import strategies as st
from mailbot_world import fewest_steps, neighbours, program

from rosoclingo.reasoning.events import GoalChanged
from rosoclingo.reasoning.goals import Outcome
from rosoclingo.reasoning.settings import CoreSettings

LOOKS = 300  # of an improvement at whether it is to stop

SOLVERS = {"shortest": shortest, "first": partial(soon, plan_time=0.0), "soon": partial(soon, plan_time=0.05)}


@st.composite
def floors(draw):
    """Number of offices, corridors of a connected floor, start, capacity."""
    count = draw(st.integers(3, 5))
    corridors = {(draw(st.integers(1, number - 1)), number) for number in range(2, count + 1)}
    if draw(st.booleans()):
        corridors.add((1, count))
    return count, tuple(sorted(corridors)), draw(st.integers(1, count)), draw(st.integers(1, 3))


class Office:
    """Where robot and packages are: packages wait, ``("waits", from, to)``, ride, ``("rides", to)``, or are done."""

    def __init__(self, graph, capacity, robot, packages=None):
        self.graph, self.capacity, self.robot, self.packages = graph, capacity, robot, dict(packages or {})

    def copy(self):
        """The same office, to try things in."""
        return Office(self.graph, self.capacity, self.robot, self.packages)

    def do(self, action):
        """An action is done; AssertionError where it cannot be."""
        name, what = action.interface_name, str(action.parameter)
        if name == "move_base":
            assert what in self.graph[self.robot]
            self.robot = what
            return
        place = self.packages[int(what)]
        if name == "pickup":
            assert place[:2] == ("waits", self.robot)
            assert sum(bool(one) and one[0] == "rides" for one in self.packages.values()) < self.capacity
            self.packages[int(what)] = ("rides", place[2])
        else:
            assert (name, place) == ("deliver", ("rides", self.robot))
            self.packages[int(what)] = None

    def judge(self, plan, cycle):
        """The rest of a plan brings everything where it belongs; the number of its steps."""
        office, rest = self.copy(), sorted((one for one in plan if one.cycle >= cycle), key=lambda one: one.cycle)
        assert [one.cycle for one in rest] == sorted({one.cycle for one in rest}), "the robot does one thing at a time"
        for action in rest:
            office.do(action)
        assert set(office.packages.values()) <= {None}
        return rest[-1].cycle - cycle + 1 if rest else 0

    def fewest(self):
        """As few steps as there may be."""
        return fewest_steps(self.graph, self.capacity, self.robot, tuple(self.packages.values()))


class Run:
    """A core on a floor, told of goals, and of failures that are not so many in a row that it gives up."""

    def __init__(self, kind, count, corridors, start, capacity):
        self.office = Office(neighbours([(f"o{a}", f"o{b}") for a, b in corridors]), capacity, f"o{start}")
        self.shortest, self.failed = kind == "shortest", {}
        text = program(count, corridors, start, capacity)
        self.driver = Driver(settings=CoreSettings(), program=text, solver=SOLVERS[kind])

    def ask(self, origin, destination):
        """Another goal."""
        number = len(self.office.packages) + 1
        self.office.packages[number] = ("waits", f"o{origin}", f"o{destination}")
        self.driver.core.add_goal(str(number), f"goal(o{origin},o{destination},{number})")

    def step(self, fails):
        """The core goes on, and what it does is judged; it is done, or fails."""
        core = self.driver.run().core
        (action,) = core.awaited
        steps = self.office.judge(core.plan.actions, core.cycle)
        if self.shortest:
            assert steps == self.office.fewest()
        else:
            self.improve(steps)
        times = self.failed.get((action.interface, action.parameter), 0)
        fails = fails and times < 2
        self.failed[action.interface, action.parameter] = times + 1 if fails else 0
        if not fails:
            self.office.do(action)
        value = "failed" if fails else action.parameter
        core.receive("world", [f"_return({action.interface},{value},{action.cycle})"])

    def improve(self, steps):
        """Plans only get shorter, and are plans; what is done or under way is left alone."""
        core, looks = self.driver.core, iter(range(LOOKS))
        fixed = [one for one in core.plan.actions if one.cycle <= core.cycle], core.awaited, core.cycle
        more = True
        while more:
            more = core.improve(lambda: next(looks, None) is None) and next(looks, None) is not None
            found = self.office.judge(core.plan.actions, core.cycle)
            assert found <= steps
            steps = found
            assert fixed == ([one for one in core.plan.actions if one.cycle <= core.cycle], core.awaited, core.cycle)


@pytest.mark.slow
@settings(max_examples=max(1, settings.default.max_examples // 8))
@given(st.sampled_from(sorted(SOLVERS)), st.data())
def test_what_goes_out_is_a_plan(kind, data):
    count, corridors, start, capacity = data.draw(floors())
    run, ways = Run(kind, count, corridors, start, capacity), st.permutations(range(1, count + 1))
    for _ in range(data.draw(st.integers(1, 4), label="batches")):
        for _ in range(data.draw(st.integers(1, 2), label="goals")):
            run.ask(*data.draw(ways)[:2])
        for fails in data.draw(st.lists(st.sampled_from([False, False, True]), max_size=8), label="failures"):
            if any(run.office.packages.values()):
                run.step(fails)
    while any(run.office.packages.values()):
        run.step(fails=False)
    run.driver.run()
    ended = {one.outcome for one in run.driver.journal.of(GoalChanged) if one.outcome is not None}
    assert ended == {Outcome.SUCCEEDED}
    assert run.driver.core.live_goals == []
