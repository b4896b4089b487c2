"""A core without ROS for benches: its solver runs in worker processes, as in the node, and a bench plays the world."""

import time
from pathlib import Path

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.oclingo.program.sources import Source
from rosoclingo.planning.workers.pool import WorkerPool
from rosoclingo.planning.workers.process_solver import ProcessSolver
from rosoclingo.reasoning.core import Core
from rosoclingo.reasoning.events import ActionsDispatched, GoalChanged
from rosoclingo.reasoning.goals import Outcome
from rosoclingo.reasoning.settings import JOINING, CoreSettings
from rosoclingo.reasoning.stream_planner import Halt, unwatched

ENCODINGS = Path(__file__).resolve().parents[1] / "encodings"

MOST_IDLE = 600
"""Limit of seconds without an action: the core defers updates that its solver could not accept."""


def mailbot_program(floor):
    """Return the mailbot's program with a floor from deliveries.py."""
    return ReactiveProgram([Source.from_file(ENCODINGS / "mailbot.lp"), Source(floor.name, floor.instance)])


def processor_clock(pid):
    """Return the clock of the processor time of a process, like clock_getcpuclockid(3) on Linux."""
    return (~pid << 3) | 2


def returned(action, value=None):
    """Return the text of an action's return, by default its success."""
    return f"_return({action.interface},{value or action.parameter},{action.cycle})"


class PooledCore:
    """A core whose solver runs in worker processes."""

    def __init__(self, program, plan_time=0.0, settings=None, standby=True):
        self.process = WorkerPool(program, shortest=True, plan_time=plan_time, standby=standby)
        watches = {"watch": self.watch, "watch_joining": self.watch_joining}
        self.core = Core(program, lambda: ProcessSolver(self.process), self.note, settings or CoreSettings(), **watches)

    def __enter__(self):
        self.process.start()
        try:
            self.core.start()
        except BaseException:
            self.process.close()
            raise
        return self

    def __exit__(self, *error):
        self.process.close()

    def advance(self, now=0.0):
        """Advance the core until it has sent actions or has nothing to do."""
        while self.core.advance(now):
            pass

    def note(self, event):
        """Receive an event of the core."""

    def watch_joining(self):
        """Stop planning for new goals after a moment, as in the node; they are admitted later."""
        begin = time.monotonic()
        return lambda: Halt("the goals are admitted later") if time.monotonic() - begin >= JOINING else None

    def watch(self):
        """Return the stop function of a search without a time limit."""
        return unwatched()


class TooLongError(Exception):
    """There is no plan for all goals in the time limit."""


class ActingCore(PooledCore):
    """A core whose actions a world executes; all of them succeed.

    Attributes:
        longest: the longest processor time, in seconds, until the next action is sent.
        still: the longest wall time, in seconds, between a return and the next action of a plan in force.
        waited: the largest number of queued goals while an action was running.

    """

    def __init__(self, program, plan_time, search_timeout=0.0, all_seconds=0.0):
        super().__init__(program, plan_time, CoreSettings(search_timeout=search_timeout))
        self._limit, self._all_seconds, self._idle, self._returned = search_timeout, all_seconds, 0, None
        self.improving, self.longest, self.still, self.waited, self.now = 0.0, 0.0, 0.0, 0, 0.0

    def execute(self, actions):
        """Execute the actions of a cycle in the world; raises RuleError."""
        raise NotImplementedError

    def steps(self):
        """Check the plan with a copy of the world, and return the number of its steps; raises RuleError."""
        raise NotImplementedError

    @property
    def used(self):
        """Seconds of processor time that the solver has used."""
        return self.process.cpu_time

    @property
    def unknown(self):
        """The number of queued goals, which are not admitted yet."""
        return sum(not goal.fed for goal in self.core.live_goals)

    def plan(self):
        """Advance the core until it has sent actions or has nothing to do; return the remaining steps of the plan."""
        begin = self.used
        self.advance(self.now)
        self.longest = max(self.longest, self.used - begin)
        self.waited = max(self.waited, self.unknown)
        return self.steps()

    def plan_until_action(self):
        """Plan until the core sends actions or all goals have ended; return whether actions were sent.

        If the solver could not accept an update, the core retries it after some idle seconds.
        """
        self.plan()
        while self.core.live_goals and not self.core.awaited:
            self._idle += 1
            if self._idle > MOST_IDLE:
                raise SystemExit(f"no action in {MOST_IDLE} s, although {len(self.core.live_goals)} goals are open")
            self.now += 1.0
            if self._returned is not None:
                self._returned -= 1.0
            self.core.poll(self.now)
            self.plan()
        return bool(self.core.awaited)

    def improve(self, seconds):
        """Improve the plan while an action runs; yield the used seconds with each better plan."""
        begin = self.used

        def over():
            return self.used - begin >= seconds

        while self.core.improve(over) and not over():  # a stopped search does not show whether it is exhausted
            yield self.used - begin
        self.improving += self.used - begin

    def prepare(self, seconds):
        """Let the standby worker plan for queued goals while an action of ``seconds`` runs."""
        if self.unknown:
            self.core.prepare()
        if not self.process.is_prefetching:
            return
        clock = processor_clock(self.process.standby_pid)
        begin = time.clock_gettime(clock)
        while self.process.is_prefetching and time.clock_gettime(clock) - begin < seconds:
            time.sleep(0.01)

    def act(self, seconds):
        """Execute the awaited actions and return them after ``seconds``; raises RuleError."""
        self.now += seconds
        actions, in_force = self.core.awaited, self.core.plan.after(self.core.cycle)
        self.execute(actions)
        self._returned = time.perf_counter() if in_force else None
        for action in actions:
            self.core.receive("bench", [returned(action)])

    def watch(self):
        """Return the stop function of a search: as in the node, but with a limit of processor time."""
        begin, queue = self.used, self.core.queue
        limit = self._limit * queue.patience

        def look():
            if 0 < self._all_seconds <= self.used - begin:
                raise TooLongError
            too_long = 0 < limit <= self.used - begin and not queue.unhurried
            return Halt(f"it took longer than {limit:g} s") if too_long else None

        return look

    def note(self, event):
        """Measure how long the robot stands still, and check that no feasible goal fails."""
        if isinstance(event, ActionsDispatched) and self._returned is not None:
            self.still, self._returned = max(self.still, time.perf_counter() - self._returned), None
        if isinstance(event, GoalChanged) and event.outcome not in (None, Outcome.SUCCEEDED):
            raise SystemExit(f"goal {event.key} is feasible, but ended as {event.outcome.name}: {event.message}")
