"""A core over a journal, its clients and its interfaces, for tests that kill core and interfaces at any instant.

The interfaces remember their actions as the real ones do.
"""

import contextlib
import copy
import tempfile
from collections import Counter
from pathlib import Path

import pytest
from core_driver import ERRANDS
from hypothesis import strategies as st
from kept_node import KeptCore
from workloads import sized

from rosoclingo.common import database
from rosoclingo.interfaces.memory import ActionMemory
from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.reasoning.events import ActionsDispatched, GoalChanged
from rosoclingo.reasoning.goals import GoalState
from rosoclingo.reasoning.journal import folder
from rosoclingo.reasoning.journal.database import NAME, Header
from rosoclingo.reasoning.journal.folder import Journal
from rosoclingo.reasoning.settings import CoreSettings

PROGRAM = ReactiveProgram.from_text(ERRANDS)
KINDS = ("walk", "run", "quick", "never", "nonsense")


class KilledError(BaseException):
    """Stands in for SIGKILL: nobody catches it."""


def files_of(path):
    """Return the bytes of a journal in a folder, by file name: the database and its log."""
    files = (path / NAME, path / f"{NAME}-wal")
    return {one.name: one.read_bytes() for one in files if one.exists()}


def put_files(path, files):
    """Replace the contents of a folder with a journal's files."""
    path.mkdir(exist_ok=True)
    for one in path.glob(f"{NAME}*"):
        one.unlink()
    for name, data in files.items():
        (path / name).write_bytes(data)


class Fate:
    """Chooses the instants at which the core is killed: after a number of instants, or within a write.

    ``kills`` are triples: the number of further instants, the thousandths of the missing data that are written by
    then, and whether a goal is cancelled before the next core acts. Of all ``instants`` those in ``writes`` are
    within a write.
    """

    def __init__(self, kills=()):
        self._kills, self.instants, self.writes = list(kills), 0, set()
        self._left = self._kills[0][0] if self._kills else 0
        self.upset = False
        self._on_disk = 0  # bytes of the log that survive a crash of the machine

    def kills_at_every_instant(self):
        """Return a kill at each instant, within a write at three shares of it; every 29th if examples are few."""
        shares = {False: (0,), True: (0, 500, 1000)}
        kills = [(at, share) for at in range(1, self.instants + 1) for share in shares[at in self.writes]]
        return kills[:: sized(standing=29, full=1)]

    @contextlib.contextmanager
    def rules(self):
        """Give fate control of the journal's disk, so that no real disk is awaited."""
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(database.Database, "run", self._commits(database.Database.run))
            patch.setattr(folder, "RECORDS", 20)
            patch.setattr(database, "LOG_PAGES", 10**6)  # the log only grows, so that it can be truncated
            patch.setattr(database, "SYNCED", "OFF")
            yield

    def pass_instant(self):
        """Pass an instant at which the core can be killed."""
        if self._is_now():
            raise KilledError

    def _is_now(self):
        self.instants += 1
        self._left -= 1
        return self._left == 0

    def _commits(self, run):
        def commit(file, *work):
            if file.path.name != NAME:  # of an interface
                return run(file, *work)
            self.writes.add(self.instants + 1)
            now = self._is_now()
            result = run(file, *work)
            if now:
                raise KilledError
            self._on_disk = file.path.with_name(f"{NAME}-wal").stat().st_size
            return result

        return commit

    def let_go(self, journal=None):
        """Handle the files of a process, as a core's ``journal``, like the system after a kill or a power cut."""
        _, share, self.upset = self._kills[0]
        self._kills = self._kills[1:]
        self._left = self._kills[0][0] if self._kills else 0
        if journal is not None:
            files = files_of(journal.path.parent)
            journal.close()
            log = files.get(f"{NAME}-wal", b"")
            self._on_disk = min(self._on_disk, len(log))
            self._on_disk += (len(log) - self._on_disk) * share // 1000
            put_files(journal.path.parent, {**files, f"{NAME}-wal": log[: self._on_disk]})


class World:
    """Clients, a process with all interfaces, and action servers, which outlive the core.

    The servers survive every kill. They know each goal by its id: the action, and its end, None while it runs. The
    messages of the interfaces wait in ``said`` until the core takes them. This world has errands; ``program`` and
    ``horizon_limit`` belong to the core; with ``any_plan`` each core finds others.
    """

    program, horizon_limit, any_plan = PROGRAM, 8, True

    def __init__(self, folder, fate):
        self.goals, self.cancelled, self.done, self.ends = {}, set(), Counter(), {}
        self._folder, self._fate = folder, fate
        self._servers, self._memory, self.said = {}, None, []
        self.kills = 0

    def hear(self, event):
        """Receive a message of the core."""
        if isinstance(event, ActionsDispatched):
            for action in event.actions:
                self.command(action)
        elif isinstance(event, GoalChanged) and event.outcome is not None:
            self.end(event.key, event.state)

    def end(self, key, state):
        """End a goal; a repeated end must have the same words."""
        assert self.ends.setdefault(key, state) == state

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

    def execute(self, action, good):
        """Execute an action; return its value."""
        good = good or str(action.interface) == "quick"
        self.done[str(action.parameter)] += good
        return action.parameter if good else "failed"

    @staticmethod
    def text(key, kind):
        """Return the text of a goal."""
        return "do(" if kind == "nonsense" else f"do({kind},{key})"

    def check(self):
        """Check that each goal has the end that the world requires."""
        for key, kind in self.goals.items():
            state, done = self.ends[key], self.done[key]
            assert done <= 1
            if kind == "nonsense":
                assert state is GoalState.REJECTED
            elif key in self.cancelled:
                assert state not in (GoalState.REJECTED, *[GoalState.ABORTED] * (kind != "never"))
            else:
                assert state is (GoalState.ABORTED if kind == "never" else GoalState.SUCCEEDED)
            assert done or state is not GoalState.SUCCEEDED
            assert not done or state is not GoalState.RECALLED


def other_minded(program, seed):
    """Return the program with another seed, for which a solver finds other plans of equal quality."""
    other = copy.copy(program)
    other.arguments = lambda: [*program.arguments(), "--rand-freq=1", f"--seed={seed}"]
    return other


class Node(KeptCore):
    """Drives a core over a journal as its node does; it is killed where ``fate`` says so."""

    def __init__(self, journal, world, fate, preempt):
        self._world, self._fate = world, fate
        settings = CoreSettings(world.horizon_limit, 0.0, preempt, goals_at_once=3, search_timeout=0.0)
        program = other_minded(world.program, fate.instants) if world.any_plan else world.program
        super().__init__(self._tell, journal, program, settings)
        for action in self.core.awaited:
            world.command(action)
        self.core.start()
        for key, client in self.keeper.clients.items():
            if client.ending is not None:
                world.end(key, client.ending.state)
            elif self.core.goal(key) is None:
                self.core.add_goal(key, client.text)
            if client.ending is None and client.cancelled:
                self.core.cancel_goal(key)

    def _tell(self, event):
        self._fate.pass_instant()
        self._world.hear(event)

    def run(self):
        """Advance as far as possible."""
        self.core.poll(1.0)
        self.keeper.send()
        for _ in range(100):
            self._fate.pass_instant()
            if not self.core.advance(1.0):
                break
            self.keeper.send()
        else:
            raise AssertionError("the core does not come to rest")
        self.keeper.send()


class Play:
    """A core and interfaces, each of which is rebuilt after a kill, and their input."""

    def __init__(self, path, fate, kind, preempt):
        self._path, self._fate, self._preempt = path / "core", fate, preempt
        self.world, self._folder, self._node = kind(path / "interfaces", fate), None, None
        self.kills = 0
        self._begin_again()

    def _begin_again(self):
        """Start another core; clients that know nothing of their goal send it again."""
        while True:
            try:
                self._folder = Journal(self._path, Header("run", "program"))
                self._node = Node(self._folder, self.world, self._fate, self._preempt)
                if self._fate.upset:
                    self._cancel_one()
                for key, kind in self.world.goals.items():
                    if key not in self.world.ends and key not in self._node.keeper.clients:
                        self._node.goal(key, self.world.text(key, kind))
                self._greet()
                self._node.run()
            except KilledError:
                self._kill()
            else:
                return

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

    def _cancel_one(self):
        live = [key for key in self.world.goals if self._node.core.goal(key) is not None]
        if live:
            self.cancel(live[0])

    def _kill(self):
        self.kills += 1
        self._fate.let_go(self._folder)
        if self._fate.upset:
            self.world.kill()

    def play(self, script):
        """Play a script, then let all actions succeed and end; the result must be true."""
        for name, *values in script:
            self._happen(getattr(self, name), *values)
        for _ in range(100):
            if not self._node.core.awaited:
                break
            self._happen(self.answer, 0, True)
        self._folder.close()
        self.world.check()
        return self

    def _happen(self, what, *values):
        self._attempt(what, *values)
        for _ in range(100):
            if self.world.is_up and not self.world.said:
                return
            self._attempt(self._hear if self.world.is_up else self._greet)
        raise AssertionError("core and interfaces do not come to rest")

    def _attempt(self, what, *values):
        try:
            what(*values)
            self._node.run()
        except KilledError:
            self._kill()
            self._begin_again()

    def goal(self, kind):
        """Send a goal from a client."""
        key = str(len(self.world.goals) + 1)
        self.world.goals[key] = kind
        self._node.goal(key, self.world.text(key, kind))

    def cancel(self, number):
        """Cancel a goal from a client."""
        key = str(number)
        if key in self.world.goals and key not in self.world.ends:
            self.world.cancelled.add(key)
            self._node.cancel(key)

    def answer(self, which, good):
        """End the actions under way."""
        awaited = self._node.core.awaited
        if awaited:
            self.world.do(awaited[which % len(awaited)], good)

    def fact(self, fact):
        """Send another fact."""
        self._node.core.receive("sensor", [fact])


def played(script, kills=(), kind=World, preempt=False):
    """Play a script with kills and return the result."""
    fate = Fate(kills)
    with tempfile.TemporaryDirectory() as name, fate.rules():
        return Play(Path(name), fate, kind, preempt).play(script), fate


#: The events of a play, and the kills of a fate.
KEYS = st.integers(1, 8)
HAPPENED = st.one_of(
    st.tuples(st.just("goal"), st.sampled_from(KINDS)),
    st.tuples(st.just("goal"), st.sampled_from(KINDS[:3])),
    st.tuples(st.just("cancel"), KEYS),
    st.tuples(st.just("answer"), KEYS, st.booleans()),
    st.tuples(st.just("answer"), KEYS, st.booleans()),
    st.tuples(st.just("fact"), st.sampled_from(["_seen(ball)", "_seen(cup)", "_unheard(1)"])),
)
KILLS = st.lists(st.tuples(st.integers(1, 40), st.integers(0, 1000), st.booleans()), min_size=1, max_size=8)
