"""Kill the core and the interfaces at any instant, alone or together: no action runs twice, each goal ends once.

The interfaces remember their actions as the real ones do; the action servers survive every kill.
"""

import contextlib
import tempfile
from collections import Counter
from pathlib import Path

import office_world
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from killed_core import HAPPENED, KEYS, KILLS, Fate, KilledError, Play, World
from shipped import shipped

from rosoclingo.interfaces.memory import ActionMemory
from rosoclingo.reasoning.goals import GoalState


class Interfaces(World):
    """A process with all interfaces; its messages wait in ``said`` until the core takes them.

    The action servers know each goal by its id: the action, and its end, None while it runs.
    """

    def __init__(self, folder, fate):
        super().__init__()
        self._folder, self._fate = folder, fate
        self._servers, self._memory, self.said = {}, None, []
        self.kills = 0

    @contextlib.contextmanager
    def living(self):
        """Run a method only while the interfaces' process lives."""
        try:
            yield
        except KilledError:
            self.kill()
            self._fate.let_go()

    def kill(self):
        """Kill the process and close its file."""
        self.kills += 1
        if self._memory is not None:
            self._memory.close()
        self._memory = None

    @property
    def is_up(self):
        """Return whether the process lives."""
        return self._memory is not None

    def begin_again(self):
        """Restart the process, which then receives the core's run."""
        with self.living():
            memory = ActionMemory(self._folder, "hand")
            try:
                memory.begin_run("run")
            except KilledError:
                memory.close()
                raise
            self._memory = memory

    def command(self, action):
        """Deliver an action of the core, perhaps again; a dead process does not receive it."""
        if self.is_up:
            with self.living():
                self._take(action)

    def _take(self, action):
        known = self._memory.recall(str(action.atom))
        if known is not None and known.facts is not None:
            self.said.append(list(known.facts))
        elif known is None or known.goal not in self._servers:  # killed before the server heard of it
            goal = f"goal {len(self._servers) + 1}"
            self._fate.pass_instant()
            self._memory.note_begun(str(action.atom), goal)
            self._fate.pass_instant()
            self._send(goal, action)
            self._fate.pass_instant()
        self._look(action)

    def _send(self, goal, action):
        """Hand a goal to a server; no action must reach the world twice."""
        assert action not in [one for one, _ in self._servers.values()], f"{action} is begun twice"
        assert not self.done[str(action.parameter)], f"{action} is done already"
        self._servers[goal] = (action, None)
        if str(action.interface) == "quick":
            self._end(goal, True)

    def _end(self, goal, good):
        action, _ = self._servers[goal]
        self._servers[goal] = (action, self.execute(action, good))

    def do(self, action, good):
        """End the action of a server with success or failure, even if nobody receives the result."""
        for goal, (one, value) in list(self._servers.items()):
            if one == action and value is None:
                self._end(goal, good)
        if self.is_up:
            with self.living():
                self._look(action)

    def _look(self, action):
        """Answer an action that has ended, unless it was answered before."""
        known = self._memory.recall(str(action.atom))
        if known is None or known.facts is not None:
            return
        _, value = self._servers[known.goal]
        if value is not None:
            facts = (f"_return({action.interface},{value},{action.cycle})",)
            self._fate.pass_instant()
            self._memory.note_answered(str(action.atom), facts)
            self._fate.pass_instant()
            self.said.append(list(facts))


class Mailbot(Interfaces):
    """The interfaces of the mailbot: kinds of goals are pairs of offices, and the key is the package.

    The world is modelled independently of the program. Failures are too rare to abort a goal.
    """

    horizon_limit = 30

    def __init__(self, folder, fate):
        super().__init__(folder, fate)
        self._office, self._failures = office_world.World(), Counter()

    @property
    def program(self):
        """Return the program of the core."""
        return shipped("mailbot.lp", "office.lp")

    @staticmethod
    def text(key, kind):
        """Return the text of a goal."""
        return "goal({},{},{})".format(*kind, key)

    def execute(self, action, good):
        """Execute a possible action of the robot, or fail."""
        for key, (origin, _) in self.goals.items():
            self._office.places.setdefault(key, origin)
        self._failures[str(action.parameter)] += not good
        if not good and self._failures[str(action.parameter)] < 3:
            return "failed"
        self._office.do(action)
        return action.parameter

    def check(self):
        """Check that each goal has ended and that its package is where the end says."""
        for key, (origin, target) in self.goals.items():
            place = self._office.places.get(key, origin)
            if self.ends[key] is GoalState.SUCCEEDED:
                assert place == target
            else:
                assert self.ends[key] in (GoalState.RECALLED, GoalState.PREEMPTED)
                assert key in self.cancelled
                assert place in (origin, target)  # present if the goal was cancelled during the delivery


class BothPlay(Play):
    """A core and interfaces, each of which is rebuilt after a kill."""

    def _greet(self):
        """Exchange the core's greeting after either side has restarted."""
        self.world.said.clear()
        while not self.world.is_up:
            self.world.begin_again()
        for action in self._node.core.awaited:
            self.world.command(action)
        self._hear()

    def _hear(self):
        said, self.world.said[:] = list(self.world.said), []
        for facts in said:
            self._node.core.receive("hand", facts)

    def _kill(self):
        super()._kill()
        if self._fate.upset:
            self.world.kill()

    def _happen(self, what, *values):
        super()._happen(what, *values)
        for _ in range(100):
            if self.world.is_up and not self.world.said:
                return
            super()._happen(self._hear if self.world.is_up else self._greet)
        raise AssertionError("core and interfaces do not come to rest")

    def answer(self, which, good):
        """End the actions under way."""
        awaited = self._node.core.awaited
        if awaited:
            self.world.do(awaited[which % len(awaited)], good)


def played(script, kills=(), kind=Interfaces):
    """Play a script with kills and return the result."""
    fate = Fate(kills)
    with tempfile.TemporaryDirectory() as name, fate.rules():
        world = kind(Path(name) / "interfaces", fate)
        return BothPlay(Path(name) / "core", fate, preempt=False, world=world).play(script), fate


#: Goals that are met, rejected, cancelled and aborted, and failures.
SCRIPT = [
    ("goal", "walk"),
    ("goal", "quick"),
    ("answer", 0, False),
    ("goal", "run"),
    ("cancel", 3),
    ("answer", 1, True),
    ("goal", "never"),
    ("answer", 0, True),
    ("goal", "walk"),
    ("answer", 0, True),
    ("goal", "quick"),
]


@pytest.mark.slow
@pytest.mark.once
def test_interfaces_or_core_survive_kill_at_every_instant():
    _, fate = played(SCRIPT)
    interfaces = 0
    for instant, share in fate.kills_at_every_instant():
        play, _ = played(SCRIPT, [(instant, share, False)])
        assert play.kills + play.world.kills == 1
        interfaces += play.world.kills
    assert 0 < interfaces < fate.instants


@pytest.mark.slow
@given(script=st.lists(HAPPENED, min_size=3, max_size=14), kills=KILLS)
def test_interfaces_and_core_survive_repeated_kills(script, kills):
    played(script, kills)


PAIRS = st.permutations(office_world.OFFICES).map(lambda offices: tuple(offices[:2]))
ORDERED = st.one_of(
    st.tuples(st.just("goal"), PAIRS),
    st.tuples(st.just("cancel"), KEYS),
    *[st.tuples(st.just("answer"), KEYS, st.booleans())] * 3,
)


@pytest.mark.slow
@pytest.mark.once
@settings(max_examples=max(3, settings.default.max_examples // 8))
@given(script=st.lists(ORDERED, min_size=5, max_size=20), kills=KILLS)
def test_mailbot_packages_end_in_right_place_after_kills(script, kills):
    played(script, kills, Mailbot)
