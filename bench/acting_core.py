"""Cores without ROS for benches: their solver runs in worker processes, as in the node, and a bench plays the robot."""

import time
from collections import deque
from contextlib import suppress
from typing import Dict, List, NamedTuple, Optional

from figures import Option, processor_time
from planning_domains import Task, check

from rosoclingo.nodes.core.loading import CoreParameters
from rosoclingo.planning.workers.pool import WorkerPool
from rosoclingo.planning.workers.process_solver import ProcessSolver
from rosoclingo.reasoning.core import Core
from rosoclingo.reasoning.events import ActionsDispatched, GoalChanged
from rosoclingo.reasoning.goals import Outcome
from rosoclingo.reasoning.settings import JOINING, CoreSettings
from rosoclingo.reasoning.stream_planner import Halt, unwatched

MOST_IDLE = 600
"""Limit of seconds without an action: the core defers updates that its solver could not accept."""

OPTIONS = {
    "seed": Option(1, "seed of the tasks"),
    "action_time": Option(0.5, "seconds to improve the plan during an action; real actions take longer", 0.05),
    "limit": Option(60.0, "time limit of a plan for all goals", 10.0),
}
"""Options of the benches that execute tasks."""


class PooledCore:
    """A core whose solver runs in worker processes.

    Attributes:
        outcomes: goal -> outcome, of the goals that have ended.

    """

    def __init__(self, program, plan_time, settings=None):
        self.process = WorkerPool(program, shortest=True, plan_time=plan_time, standby=True)
        watches = {"watch": self.watch, "watch_joining": self.watch_joining}
        self.core = Core(program, lambda: ProcessSolver(self.process), self.note, settings or CoreSettings(), **watches)
        self.outcomes = {}

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

    @property
    def used(self):
        """Seconds of processor time that this process and the solver have used."""
        return time.process_time() + self.process.cpu_time

    def advance(self, now=0.0):
        """Advance the core until it has sent actions or has nothing to do."""
        while self.core.advance(now):
            pass

    def answer(self, *facts, actions=None):
        """Report facts and the success of actions, by default of all awaited ones."""
        ended = self.core.awaited if actions is None else actions
        returns = (f"_return({one.interface},{one.parameter},{one.cycle})" for one in ended)
        self.core.receive("bench", [*facts, *returns])

    def better_plans(self, seconds):
        """Improve the plan while actions run, in some seconds of processor time; yield after each better plan."""
        end = self.process.cpu_time + seconds

        def is_over():
            return self.process.cpu_time >= end

        self.core.compact(is_over)
        while not is_over() and self.core.improve(is_over) and not is_over():  # a stopped search is not exhausted
            yield

    def await_standby(self, seconds):
        """Wait until the standby worker has its answer or has used some ``seconds`` of processor time."""
        if self.process.is_prefetching:
            pid = self.process.standby_pid
            begin = processor_time(pid)
            while self.process.is_prefetching and processor_time(pid) - begin < seconds:
                time.sleep(0.01)

    def note(self, event):
        """Receive an event of the core."""
        if isinstance(event, GoalChanged) and event.outcome is not None:
            self.outcomes[event.key] = event.outcome

    def check_success(self):
        """Exit if a goal has ended without success, although all goals are feasible."""
        failed = {key: outcome.name for key, outcome in self.outcomes.items() if outcome is not Outcome.SUCCEEDED}
        if failed:
            raise SystemExit(f"goals are feasible, but ended without success: {failed}")

    def watch_joining(self):
        """Stop planning for new goals as in the node, but after a moment of processor time; they are admitted later."""
        begin = self.process.cpu_time
        return lambda: Halt("the goals are admitted later") if self.process.cpu_time - begin >= JOINING else None

    def watch(self):
        """Return the stop function of a search without a time limit."""
        return unwatched()


class TooLongError(Exception):
    """There is no plan for all goals in the time limit."""


class Robot(PooledCore):
    """A core with the program of a planning task, and the world that executes its actions and checks its plans.

    Attributes:
        executed: the number of executed steps.
        still: the longest wall time, in seconds, between a return and the next action of a plan in force.

    """

    def __init__(self, task, plan_time=0.0, search_timeout=0.0, limit=0.0):
        """``limit`` is the processor time of a search in seconds, after which it raises TooLongError."""
        super().__init__(task.program, plan_time, CoreSettings(search_timeout=search_timeout))
        self.task, self.world = task, task.world_type(task)
        self._timeout, self._limit, self._admitted, self._now, self._returned = search_timeout, limit, set(), 0.0, None
        self.executed, self.still = 0, 0.0

    def ask(self, numbers):
        """Send goals of the task."""
        for number in numbers:
            self.core.add_goal(str(number), self.task.goals[number - 1].term)

    @property
    def waiting(self):
        """The number of queued goals, which are not admitted yet."""
        return sum(not goal.fed for goal in self.core.live_goals)

    def plan(self):
        """Advance the core until it has sent actions or has nothing to do; return the remaining steps of the plan."""
        self.advance(self._now)
        return self.steps()

    @property
    def busy(self):
        """Whether goals are queued or not met in the world."""
        return self.waiting or not self.world.at_rest

    def plan_until_action(self):
        """Plan until the core sends actions; it retries an update that its solver could not accept after a second."""
        self.plan()
        for _ in range(MOST_IDLE):
            if self.core.awaited:
                return
            self._now += 1.0
            self._returned = self._returned and self._returned - 1.0
            self.core.poll(self._now)
            self.plan()
        raise SystemExit(f"no action in {MOST_IDLE} s, although {len(self.core.live_goals)} goals are open")

    def steps(self):
        """Check the plan in the world, and return the number of its steps; raises RuleError."""
        for number, goal in ((int(goal.key), goal) for goal in self.core.live_goals):
            if goal.fed != (number in self._admitted):  # a plan does not serve queued goals
                (self.world.ask if goal.fed else self.world.cancel)(number)
                self._admitted ^= {number}
        plan = {}
        for action in sorted(self.core.plan.remaining(self.core.cycle), key=lambda action: action.cycle):
            plan.setdefault(action.cycle, []).append((action.interface_name, str(action.parameter)))
        if self.core.awaited:
            check(self.world, list(plan.values()))
        return len(plan)

    def act(self, seconds):
        """Execute the awaited actions in ``seconds``, and plan for queued goals meanwhile; raises RuleError."""
        for _ in self.better_plans(seconds):
            self.steps()
        if self.waiting:
            self.core.prepare()
        self.await_standby(seconds)
        self.world.do([(one.interface_name, str(one.parameter)) for one in self.core.awaited])
        self.executed, self._now = self.executed + 1, self._now + seconds
        self._returned = time.perf_counter() if self.core.plan.remaining(self.core.cycle + 1) else None
        self.answer()

    def watch(self):
        """Return the stop function of a search: as in the node, but with limits of processor time."""
        begin, queue = self.process.cpu_time, self.core.queue
        limit = self._timeout * queue.patience

        def look():
            spent = self.process.cpu_time - begin
            if 0 < self._limit <= spent:
                raise TooLongError
            return Halt(f"it took longer than {limit:g} s") if 0 < limit <= spent and not queue.unhurried else None

        return look

    def note(self, event):
        """Measure how long the robot stands still, and check that no feasible goal fails."""
        super().note(event)
        if isinstance(event, ActionsDispatched) and self._returned is not None:
            self.still, self._returned = max(self.still, time.perf_counter() - self._returned), None
        self.check_success()


class Arrivals:
    """Goals 1 to ``count`` in the order of their arrival: one every ``gap`` actions, all at once if it is 0."""

    def __init__(self, count: int, gap: int = 0) -> None:
        self._left, self._gap, self._count = deque(range(1, count + 1)), gap, 0

    def __bool__(self) -> bool:
        return bool(self._left)

    def due(self, actions: int, busy: bool) -> List[int]:
        """Return the numbers that arrive after some actions; at least one if no goal is open (not ``busy``)."""
        found: List[int] = []
        while self._left and (self._gap * self._count <= actions or not (found or busy)):
            found.append(self._left.popleft())
            self._count += 1
        return found


class FirstPlan(NamedTuple):
    """The first plan of a task: the processor time (s) until it, its steps, its queued goals, and its steps later."""

    seconds: float
    steps: int
    queued: int
    improved: int


def first_plan(
    task: Task, plan_time: float = 0.0, timeout: float = 0.0, limit: float = 0.0, improvement: float = 0.0
) -> Optional[FirstPlan]:
    """Plan for all goals; return the plan that the core would execute, and its steps after some ``improvement`` (s).

    Without a ``timeout`` of searches, the plan is for all goals; None if a search takes longer than ``limit``.
    """
    with suppress(TooLongError), Robot(task, plan_time, timeout, limit) as robot:
        begin = robot.process.cpu_time
        robot.ask(range(1, len(task.goals) + 1))
        steps, seconds = robot.plan(), robot.process.cpu_time - begin
        first = FirstPlan(seconds, steps, robot.waiting, steps)
        for _ in robot.better_plans(improvement):
            first = first._replace(improved=robot.steps())
        return first
    return None


def execute(task: Task, action_time: float, limit: float = 0.0, gap: int = 0) -> Dict[str, float]:
    """Execute all goals, which arrive with a ``gap``; return the figures, none if a search takes longer than ``limit``.

    The figures are the number of executed steps, the processor time (s) until the first action, and ``still``.
    """
    with suppress(TooLongError), Robot(task, CoreParameters.plan_time, CoreSettings.search_timeout, limit) as robot:
        begin, out, arrivals = robot.process.cpu_time, 0.0, Arrivals(len(task.goals), gap)
        robot.ask(arrivals.due(0, False))
        while robot.busy:
            robot.plan_until_action()
            out = out or robot.process.cpu_time - begin
            robot.act(action_time)
            robot.ask(arrivals.due(robot.executed, robot.busy))
        return {"executed": robot.executed, "out [s]": out, "still [s]": robot.still}
    return {}
