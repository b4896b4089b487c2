"""The node ``rosoclingo``: the pure core on topics, parameters and an action server."""

import time
from functools import partial
from typing import Any, Callable, Dict, List, Optional, Set, Type

import rospy
from actionlib import ServerGoalHandle

from rosoclingo.common.action_servers import forget_cancels, start_server
from rosoclingo.common.diagnostics import Diagnostics
from rosoclingo.common.paced_clock import PacedClock
from rosoclingo.common.worker import Worker
from rosoclingo.msg import ROSoClingoResult
from rosoclingo.nodes.core.fact_intake import FactIntake
from rosoclingo.nodes.core.gathering import TOGETHER
from rosoclingo.nodes.core.goal_handles import GoalHandles, Results, stamp_of, status_of
from rosoclingo.nodes.core.goal_server import GoalServer
from rosoclingo.nodes.core.keeping import find_journal
from rosoclingo.nodes.core.loading import core_parameters, load_program
from rosoclingo.nodes.core.topics import CoreTopics
from rosoclingo.nodes.core.unmet_goals import UnmetGoals
from rosoclingo.oclingo import DroppedError
from rosoclingo.planning.workers.pool import WorkerPool
from rosoclingo.planning.workers.process_solver import ProcessSolver
from rosoclingo.reasoning.core_state import Health, Level, Report
from rosoclingo.reasoning.events import (
    ActionsDispatched,
    ActionsPreempted,
    Event,
    GoalChanged,
    GoalProgress,
    GoalRefused,
    PlanMade,
    Problem,
    ReturnTaken,
    StateChanged,
    UpdateSent,
)
from rosoclingo.reasoning.goals import GoalState, Outcome
from rosoclingo.reasoning.interface_register import InterfaceRegister
from rosoclingo.reasoning.journal.keeper import ClientGoal, Ending, Keeper
from rosoclingo.reasoning.journal.kept_core import KeptCore
from rosoclingo.reasoning.keywords import return_of
from rosoclingo.reasoning.settings import JOINING
from rosoclingo.reasoning.stream_planner import Halt
from rosoclingo.runs.recorded_run import RunProgram

#: Seconds of wall time that a shutdown waits for the worker, so that every client hears of its goal's end.
SHUTDOWN_TIME = 5.0

#: Seconds, of wall time or of ROS time, after which an improvement lets what is due by time be done.
IMPROVING = 0.5

#: Seconds of wall time that actions have been under way before answers to what may come are prepared.
PREPARING = 0.1

#: Seconds of wall time between two turns of the worker, once answers are prepared.
IDLE = 0.25

#: Seconds of wall time that a search may take though a cancel waits; one so short has its plan before.
CANCEL_GRACE = 0.05

#: Why a goal has ended whose cancel came while the core was at something else.
RECALLED = "the goal was cancelled before it was planned for"


class CoreNode:
    """The reasoning layer as a node.

    Parameters
    ----------
        ~program_files (list of str, required): the reactive logic program, files in order.
        ~constants (map, default {}): values of the program's ``#const`` names; numbers where the program has numbers.
        ~labels (map, default {}): named locations, or a list of their names; each is given to the program's base part
            as ``label(Name).``
        ~places (str, default ""): facts to add to the program, of the floor as the command ``places`` writes them.
        ~horizon_limit (int, default 100): steps that a plan for one goal may reach beyond the current cycle; each
            further goal adds a tenth, and more where the plan that there is has nearly as many.
        ~plan (str, default soon): ``soon``: each plan is the best one that is found within ``~plan_time``; it is
            improved while actions run, and new goals join as soon as there is a plan with them; ``shortest``: each
            plan is the shortest, as in the paper, without a limit of time.
        ~plan_time (float, default 1.0): seconds of the solver's processor time in which it looks for a shorter plan
            than the first one that it has found; 0 takes the first.
        ~goals_at_once (int, default 0): goals that the program is told of at the same time; further ones wait, the
            oldest first. 0 for no limit: as many as plans are found for well within ``~search_timeout``.
        ~overtaking_limit (int, default 20): goals that may come later than a goal and end before it, or as many as it
            was planned for together with, if that is more; then no newer one is fed until it has ended. 0 for no limit.
        ~search_timeout (float, default 10.0): seconds of the solver's processor time that one search may go on before
            goals wait, the newest first. 0 for no limit.
        ~action_timeout (float, default 600.0): seconds of ROS time, which here passes no faster than wall time, until
            an action that has not returned counts as failed and ``_return(A,timeout,C)`` is fed, 0 for no limit.
        ~recovery_timeout (float, default 5.0): seconds of the solver's processor time in which to look for the fewest
            goals to give up, and again for the reasons, when there is no plan; then goals wait, too. 0 for no limit.
            The check under way still ends.
        ~preempt (bool, default false): end an action under way at once when the new plan does not want it.
        ~journal (str, default auto): the folder in which the core writes down all that it needs to go on after it was
            killed; ``auto`` for one below ``rosoclingo`` in ROS_HOME that is named after the node, its master and the
            program; ``none`` for none. Of those for ``auto``, what no core has written to for a week is removed, but
            for the latest 20.
        ~resume (str, default ask): whether to go on with what is in the journal. ``ask``: where the roslaunch that has
            started the core of the journal starts this one again; else a new run begins, the journal is set aside, and
            open goals in it are told. ``yes``: always, and it does not start where it can't. ``no``: never.
        ~required (bool, default false): in a launch file that starts the core again when it ends (``respawn``), have
            roslaunch end where that cannot help: the core cannot start, another node has taken its name, or it fails
            by a fault of its own within a minute of having been started again.
    Subscribes:
        in_rosoclingo (rosoclingo/InterfaceIO): facts from the interfaces, ``_return(A,V,C)`` and any declared external.
            In place of its cycle a fact may say ``now``: the next actions that go out heed it already.
            A message without facts announces that its node serves that interface.
    Publishes:
        out_rosoclingo (rosoclingo/InterfaceIO): the actions of a cycle, one message for each interface. Not latched,
            but each subscriber is sent first which run of the core this is, ``_run("ID")`` for the interface
            ``rosoclingo``, and the actions under way. ``_cancel(A,P,C)`` ends an action: an
            unwanted one with ``~preempt``, and each one under way when the core shuts down.
        ~task_plan (rosoclingo/TaskPlan, latched): the plan of the latest answer, after the last few actions done.
        ~state (rosoclingo/State, latched): what the latest answer shows of the present: what the program believes.
        ~goals (rosoclingo/GoalStates, latched): the goals with actionlib's statuses and texts: those that are open, and
            the last 100 that have ended, long texts shortened. Changes within 0.1 s are published together.
        ~updates (std_msgs/String): every stream update that is in force, once and as the solver took it, with the bound
            of its search and what is past: ``oclingo --shortest --stream`` plays them, with the same plans where
            ``~plan`` is ``shortest``, else with plans that may be shorter.
        ~program (std_msgs/String, latched): the program whole, its constants, and what else decisions depend on, as
            JSON: with ``~updates`` and ``~task_plan`` all that ``rosrun rosoclingo replay`` needs.
        ~cycle (std_msgs/UInt32, latched): the current cycle, from 1.
        /diagnostics (diagnostic_msgs/DiagnosticArray): the core's state, once a second and on change.
    Services:
        ~explain (rosoclingo/Explain): why a goal was given up: the fewest rules that forbid it, by file and line and in
            the program's words, the facts, and the steps. Of the last 20 goals for which there was no plan, also
            where the core was started again, as far as its journal has them; it takes up to 30 s of processor time, in
            a process of its own, while the core goes on.
    Actions served:
        rosoclingo (rosoclingo/ROSoClingoAction): goals of any number of clients, each with its own status.

    Raises ParameterError, ProgramError and JournalError when it cannot start.

    """

    def __init__(self) -> None:
        self._parameters = core_parameters()
        self._ending = False
        self._arrivals: Set[str] = set()  # keys of queued goals
        self._cancels: Set[str] = set()  # and of goals with a queued cancel
        self._recalled: List[str] = []  # and of queued goals that were cancelled, until the journal has it
        self._last_time, self._last_cycle, self._fault = 0.0, 0.0, ""
        self._clock = PacedClock()
        self._handles = GoalHandles()
        program, odd = load_program(self._parameters)
        for warning in odd:
            rospy.logwarn("%s: %s", rospy.get_name(), warning)
        plan_time = self._parameters.time_to_shorten
        self._solvers = WorkerPool(program, shortest=True, plan_time=plan_time, standby=True)
        found = find_journal(self._parameters, program)
        self._keeper = Keeper(self._let_out, found.journal, time.monotonic, rospy.get_time, found.fault)
        self._core = KeptCore(
            program,
            lambda: ProcessSolver(self._solvers),
            self._keeper,
            self._parameters.settings,
            self._watch_search,
            self._watch_recovery,
            None if self._parameters.time_to_shorten is None else self._watch_joining,
            record=found.state,
        )
        self._keeper.attach(self._core, found.state)
        self._results = Results(resumed=found.state is not None)
        self._worker = Worker(self._settle)
        self._given_up = UnmetGoals(program, self._worker, self._keeper.given_up)
        self._topics = CoreTopics(lambda: self._core.awaited, lambda: self._core.preempted, found.run, self._core.cycle)
        self._topics.program_loaded(RunProgram.of(found.run, program, self._parameters.deciding).text())
        self._register = InterfaceRegister()
        self._facts = FactIntake(self._core, self._register, self._worker)
        self._health = Health()
        self._diagnostics = Diagnostics(rospy.get_name().strip("/") + ": core", self._describe)
        self._outlets: Dict[Type[Event], Callable[[Any], None]] = {
            UpdateSent: self._topics.update_sent,
            PlanMade: self._plan_made,
            StateChanged: self._topics.state_changed,
            ActionsDispatched: self._topics.actions_dispatched,
            ActionsPreempted: self._topics.actions_preempted,
            ReturnTaken: self._return_taken,
            GoalChanged: self._handles.changed,
            GoalRefused: self._handles.refused,
            GoalProgress: self._handles.progress,
            Problem: self._log_problem,
        }
        self._connect()

    def _connect(self) -> None:
        self._worker.put(self._start)
        arrived = partial(self._worker.put, self._take_arrivals)
        self._server = GoalServer("rosoclingo", self._goal_arrived, self._cancel_arrived, arrived, self._results.add)
        self._go_on_with_clients()
        self._results.open("rosoclingo")
        self._facts.connect()
        rospy.on_shutdown(self._shut_down)
        start_server(self._server)
        self._worker.start()

    # -- the worker's side

    def _start(self) -> None:
        """Tell what is known, then wait for the solver's process, which is no part of the first search's time."""
        self._core.remind()
        if self._core.plan.actions:
            self._plan_made(PlanMade(self._core.cycle, self._core.horizon, self._core.shown))
        self._send()
        try:
            self._solvers.start(self._watch_start)
        except DroppedError as error:
            if not self._ending:
                rospy.logwarn("%s", error)
        self._core.start()

    def _go_on_with_clients(self) -> None:
        """Have the goals of a core that was killed, before the server tells of any."""
        for key, client in self._keeper.clients.items():
            status = status_of(client, self._core.goal(key))
            handle = self._server.restore(key, client.text, rospy.Time(*client.stamp), status)
            if client.ending is not None:
                result = ROSoClingoResult(int(client.ending.outcome), client.ending.message)
                self._results.add(handle.get_goal_status(), result)
                continue
            self._handles.add(key, handle)
            if self._core.goal(key) is None:
                self._worker.put(partial(self._core.add_goal, key, client.text))
            if client.cancelled:
                self._worker.put(partial(self._core.cancel_goal, key))
        self._handles.board.flush()

    def _take_arrivals(self) -> None:
        """Take goals and cancels, at any time: clients hear that they have come once that is written down.

        A goal whose cancel has come before the core heard of it ends at once, also while a search goes on.
        """
        self._server.take(self._keeper.keep)
        while self._recalled:
            self._handles.recall(self._recalled.pop(), RECALLED)

    def _goal_arrived(self, handle: ServerGoalHandle) -> None:
        key, text = handle.get_goal_id().id, handle.get_goal().request
        if not self._handles.has_room(handle):
            return
        self._arrivals.add(key)
        self._handles.add(key, handle)
        self._keeper.add(key, ClientGoal(text, stamp_of(handle)))
        self._worker.put(lambda: self._goal_came(key, text))

    def _goal_came(self, key: str, text: str) -> None:
        if key in self._arrivals:
            self._arrivals.discard(key)
            self._facts.gathering.goal_came(time.monotonic())
            self._core.add_goal(key, text)

    def _cancel_arrived(self, handle: ServerGoalHandle) -> None:
        key = handle.get_goal_id().id
        if key in self._arrivals:
            self._arrivals.discard(key)
            self._recalled.append(key)
            self._keeper.end(key, Ending(GoalState.RECALLED, Outcome.CANCELED, RECALLED))
            return
        self._cancels.add(key)
        self._keeper.cancel(key)
        self._worker.put(lambda: self._cancel_came(key))

    def _cancel_came(self, key: str) -> None:
        self._cancels.discard(key)
        self._core.cancel_goal(key)

    def _settle(self) -> Optional[float]:
        self._facts.take()
        self._tick()
        improvable = self._go_on()
        self._send()
        self._keeper.forget(self._results.over())
        self._look_after_journal()
        self._tick()
        if improvable or self._facts.waiting:
            return 0.0
        if self._facts.gathering.expects(time.monotonic()):
            return TOGETHER
        quiet = time.monotonic() - self._last_cycle >= 2 * PREPARING and not self._solvers.is_prefetching
        return IDLE if quiet else None

    def _go_on(self) -> bool:
        """Do what is due; tell whether the plan may be improved while nothing comes."""
        now = rospy.get_time()
        if now < self._last_time:
            rospy.logwarn("time jumped back by %.1f s", self._last_time - now)
            forget_cancels(self._server)
        self._last_time = now
        if now == 0.0:
            rospy.logwarn_throttle(10.0, "waiting for /clock")
            return False
        self._core.poll(self._time())
        self._send()
        while not self._ending and not self._facts.gather() and self._core.advance(self._time()):
            self._send()
            self._last_cycle = time.monotonic()
            if self._worker.waiting:  # a cancel that has come during the search bears on the next one
                break
        self._send()
        if time.monotonic() - self._last_cycle >= PREPARING:
            self._core.prepare()
        now = rospy.get_time()
        return self._parameters.time_to_shorten is not None and self._core.improve(self._watch_improvement(now))

    def _send(self) -> None:
        self._keeper.send(keep_ends=self._results.awaited)

    def _tick(self) -> None:
        """Tell what has changed; often, also while a search goes on."""
        for line in self._health.counted(time.monotonic()):
            rospy.logwarn("%s", line)
        self._diagnostics.tick()
        self._handles.board.tick()

    def _time(self) -> float:
        return self._clock.at(rospy.get_time(), time.monotonic())

    def _attend(self) -> None:
        """Attend to time and arrivals, also during a search."""
        self._tick()
        if self._server.arrivals:
            self._take_arrivals()

    def _watch_start(self) -> bool:
        """Tell whether the core ends while its solver starts."""
        self._attend()
        return self._ending

    def _watch_improvement(self, now: float) -> Callable[[], bool]:
        """End what improves the plan as soon as anything comes, or something may be due by time."""
        start = time.monotonic()

        def look() -> bool:
            """Tell whether to end it now."""
            self._tick()
            spent = max(time.monotonic() - start, abs(rospy.get_time() - now))
            return self._ending or self._worker.waiting or spent >= IMPROVING

        return look

    def _watch_search(self) -> Callable[[], Optional[Halt]]:
        """End a search that takes too long, or whose result a cancel or the shutdown makes useless."""
        start = time.monotonic()

        def look() -> Optional[Halt]:
            """Return why the search has to end now, None while it can go on."""
            if self._ending:
                return Halt("the core shuts down", disturbed=True)
            why = self._core.queue.why_left(self._cancels, bool(self._arrivals))
            return Halt(why, disturbed=True) if why and time.monotonic() - start >= CANCEL_GRACE else None

        return self._watching(look, self._parameters.settings.search_timeout)

    def _watch_recovery(self) -> Callable[[], Optional[Halt]]:
        """End the search for goals to give up after some time, with those that were found."""
        return self._watching(lambda: None, self._parameters.recovery_timeout)

    def _watch_joining(self) -> Callable[[], Optional[Halt]]:
        """End the wait for a plan with new goals before the next action."""
        start, late = time.monotonic(), Halt(f"it took longer than {JOINING:g} s")
        return self._watching(lambda: late if self._ending or time.monotonic() - start >= JOINING else None)

    def _watching(self, look: Callable[[], Optional[Halt]], seconds: float = 0.0) -> Callable[[], Optional[Halt]]:
        """Return a watch that attends to time and arrivals during a search.

        It ends the search by ``look``, or after ``seconds`` of processor time, 0 for no limit.
        """
        queue = self._core.queue
        worked, limit = self._solvers.stopwatch(), seconds * queue.patience

        def watch() -> Optional[Halt]:
            """Return why the search has to end now, None while it can go on."""
            self._attend()
            halt = look()
            if halt is None and 0 < limit <= worked():
                if not queue.unhurried:
                    halt = Halt(f"it took longer than {limit:g} s")
                elif self._worker.waiting:
                    halt = Halt("something has come", disturbed=True)
            return halt

        return watch

    def _shut_down(self) -> None:
        self._ending = True
        self._worker.put(lambda: self._core.leave("is aborted: the core shuts down"))
        self._worker.put(self._send)
        self._worker.put(self._handles.board.flush)
        self._worker.put(self._keeper.close)
        self._worker.put(self._solvers.close)
        self._worker.stop(SHUTDOWN_TIME)

    # -- what the core tells

    def _let_out(self, event: Event) -> None:
        outlet = self._outlets.get(type(event))
        if outlet is not None:
            outlet(event)

    def _look_after_journal(self) -> None:
        """Tell that nothing is written, once."""
        if self._keeper.fault != self._fault:
            self._fault = self._keeper.fault
            text = self._fault + ": the core goes on without" if self._fault else "the journal is written again"
            (rospy.logwarn if self._fault else rospy.loginfo)("%s: %s", rospy.get_name(), text)

    def _plan_made(self, event: PlanMade) -> None:
        self._topics.plan_made(event)
        self._health.plan_made(event)

    def _return_taken(self, event: ReturnTaken) -> None:
        self._topics.return_taken(event)
        self._register.answered(return_of(event.atom).interface_name)

    def _log_problem(self, event: Problem) -> None:
        """Log a problem, unless it was logged before."""
        line = self._health.problem(event, time.monotonic())
        if line:
            rospy.logwarn("%s", line)

    def _describe(self) -> Report:
        now = time.monotonic()
        missing = self._register.look(self._core.awaited, self._topics.listeners, self._facts.senders, now)
        for one in missing:
            if one.new:
                self._log_problem(Problem(self._core.cycle, one.text, one.action.interface_name))
        awaited, text = [str(action.atom) for action in self._core.awaited], missing[0].text if missing else ""
        goals, waiting = len(self._core.live_goals), sum(not goal.fed for goal in self._core.live_goals)
        report = self._health.report(self._core.cycle, goals, awaited, now, self._register.names, text, waiting)
        if self._keeper.fault:
            report = report._replace(level=Level.WARN, message=self._keeper.fault)
        return report if rospy.get_time() else report._replace(level=Level.WARN, message="waits for /clock")
