"""The node ``rosoclingo``: connects the pure core to topics, parameters and an action server."""

import time
from functools import partial
from typing import Any, Callable, Dict, List, Optional, Set, Type

import rospy
from actionlib import ServerGoalHandle

from rosoclingo.common.action_servers import forget_cancels, start_server
from rosoclingo.common.diagnostics import Diagnostics, Findings
from rosoclingo.common.paced_clock import PacedClock
from rosoclingo.common.worker import Worker
from rosoclingo.msg import ROSoClingoResult
from rosoclingo.nodes.core.fact_intake import FactIntake
from rosoclingo.nodes.core.gathering import TOGETHER, Gathering
from rosoclingo.nodes.core.goal_handles import GoalHandles, stamp_of
from rosoclingo.nodes.core.goal_server import GoalServer
from rosoclingo.nodes.core.keeping import find_journal
from rosoclingo.nodes.core.loading import core_parameters, load_program
from rosoclingo.nodes.core.operator_commands import OperatorCommands
from rosoclingo.nodes.core.topics import CoreTopics
from rosoclingo.nodes.core.unmet_goals import UnmetGoals
from rosoclingo.oclingo import DroppedError
from rosoclingo.planning.workers.pool import WorkerPool
from rosoclingo.planning.workers.process_solver import ProcessSolver
from rosoclingo.reasoning.core import Core
from rosoclingo.reasoning.core_state import describe_core
from rosoclingo.reasoning.events import (
    ActionsDispatched,
    ActionsPreempted,
    Event,
    GoalChanged,
    GoalProgress,
    ModeChanged,
    PlanMade,
    Problem,
    ReturnAccepted,
    StateChanged,
    UpdateSent,
)
from rosoclingo.reasoning.goals import GoalState, Outcome
from rosoclingo.reasoning.interface_register import InterfaceRegister
from rosoclingo.reasoning.journal.keeper import ClientGoal, Ending, Keeper
from rosoclingo.reasoning.keywords import return_of
from rosoclingo.reasoning.log_throttle import LogThrottle
from rosoclingo.reasoning.settings import JOINING
from rosoclingo.reasoning.stream_planner import Halt
from rosoclingo.runs.recorded_run import RunProgram

#: Limit in seconds of wall time for the worker to end all goals at a shutdown.
SHUTDOWN_TIME = 5.0

#: Seconds, of wall time or of ROS time, after which an improvement pauses for timed work.
IMPROVING = 0.5

#: Seconds of wall time after the last cycle before answers are prefetched and the history is compacted.
PREPARING = 0.1

#: Seconds of wall time between two turns of the worker, once answers are prefetched.
IDLE = 0.25

#: Seconds of wall time that a search can continue although a cancel waits: a short search finds its plan in that time.
CANCEL_GRACE = 0.05

#: The reason of a goal that was cancelled while it was queued.
RECALLED = "the goal was cancelled before it was planned for"


class CoreNode:
    """The core node: plans for goals of clients and sends actions to interfaces.

    Parameters
    ----------
        ~program_files (list of str, required): the files of the reactive logic program, in order.
        ~constants (map, default {}): values of the program's ``#const`` names; numbers have to stay numbers.
        ~labels (map, default {}): named locations, or a list of their names; each becomes a fact ``label(Name).`` of
            the program's base part.
        ~places (str, default ""): further facts of the program: the floor, as the command ``places`` prints it.
        ~horizon_limit (int, default 100): limit of a plan's steps beyond the current cycle for one goal. Each further
            goal adds a tenth. The limit also grows with a plan that nearly reaches it.
        ~plan (str, default soon): ``soon``: each plan is the best that is found within ``~plan_time``. It is
            improved while actions run, and new goals join as soon as a plan includes them. ``shortest``: each plan is
            the shortest, as in the paper, without a time limit.
        ~plan_time (float, default 1.0): seconds of the solver's processor time to search for a shorter plan than the
            first; 0 uses the first plan.
        ~goals_at_once (int, default 0): limit of goals in the program; further goals are queued, the oldest first.
            0 adapts the limit, so that plans are found well within ``~search_timeout``.
        ~overtaking_limit (int, default 20): limit of newer goals that can end before a goal, or the number of goals
            that it was planned together with, if that is more. Then newer goals are queued until it has ended. 0 for
            no limit.
        ~search_timeout (float, default 10.0): seconds of the solver's processor time for one search, after which the
            newest goals are queued. 0 for no limit.
        ~action_timeout (float, default 600.0): seconds of ROS time, counted no faster than wall time, after which an
            action without a return fails with ``_return(A,timeout,C)``. 0 for no limit.
        ~interface_timeout (float, default 10.0): seconds of wall time without a message from an interface, after which
            a program that declares ``#external _lost/2`` receives ``_lost(R,C)``, and ``_back(R,C)`` after the next
            message. 0 for never. R is the first argument of the interface's name, else the name.
        ~lost_timeout (float, default 60.0): seconds of wall time for which an action of a lost interface can still
            return. Then it fails with ``_return(A,lost,C)``. 0 waits for ``~action_timeout``.
        ~recovery_timeout (float, default 5.0): seconds of the solver's processor time to search for the fewest goals
            to abort when there is no plan, and again for the reasons. Afterwards goals are queued instead. 0 for no
            limit. A check that has started still completes.
        ~preempt (bool, default false): cancel a running action immediately if the new plan does not contain it.
        ~learn_durations (bool, default true): state the durations of actions, as medians of those observed in this run,
            by ``_takes(A,P,S)`` to a program that declares ``#external _takes/3``.
        ~journal (str, default auto): the folder of the journal, from which the core resumes after it was killed.
            ``auto``: a folder below ``rosoclingo`` in ROS_HOME, named after the node, its master and the program.
            ``none``: no journal. Automatic folders that were not used for a week are deleted, except the latest 20.
        ~resume (str, default ask): whether to resume from the journal. ``ask``: if the roslaunch that started the
            journal's core also started this core; else a new run begins, the journal is set aside, and its
            open goals are logged. ``yes``: always; the core does not start if it cannot resume. ``no``: never.
        ~required (bool, default false): in a launch file with ``respawn``, end roslaunch if a restart cannot help: the
            core cannot start, another node has taken its name, or it crashes again within a minute after a restart.
    Subscribes:
        in_rosoclingo (rosoclingo/InterfaceIO): facts of the interfaces, ``_return(A,V,C)`` and any declared external.
            ``now`` in place of the cycle makes the next actions depend on the fact.
            A message without facts announces that its node serves the interface. Each interface repeats it once a
            second.
    Publishes:
        out_rosoclingo (rosoclingo/InterfaceIO): the actions of a cycle, one message for each interface. Not latched,
            but each new subscriber first gets the run of the core, ``_run("ID")`` for the interface ``rosoclingo``,
            and the running actions. ``_cancel(A,P,C)`` cancels an action: with ``~preempt`` an action that the new
            plan does not contain, at shutdown all running actions.
        ~task_plan (rosoclingo/TaskPlan, latched): the plan of the latest answer, after the last executed actions.
        ~state (rosoclingo/State, latched): the beliefs of the program: the shown atoms that hold now.
        ~goals (rosoclingo/GoalStates, latched): the goals with actionlib's statuses and texts: all open goals, and
            the last 100 that have ended. Long texts are shortened. Changes within 0.1 s are published together.
        ~updates (std_msgs/String): each accepted stream update, once, as the solver received it, with the bound
            of its search and the past. ``oclingo --shortest --stream`` plays them, with the same plans if ``~plan``
            is ``shortest``, else with plans that can be shorter.
        ~program (std_msgs/String, latched): the whole program, its constants, and all parameters that affect
            decisions, as JSON. With ``~updates`` and ``~task_plan`` it is the input of ``rosrun rosoclingo replay``.
        ~cycle (std_msgs/UInt32, latched): the current cycle, from 1.
        ~mode (std_msgs/String, latched): ``running``, ``paused`` or ``stopped``, see ``~pause`` and ``~stop``.
        /diagnostics (diagnostic_msgs/DiagnosticArray): the core's state, once a second and on change.
    Services:
        ~explain (rosoclingo/Explain): explains why a goal was aborted: the fewest rules that forbid it, by file and
            line and in the program's words, the facts, and the steps. Available for the last 20 goals without a plan,
            also after a restart. It takes up to 30 s of processor time in a separate process, while the core continues.
        ~pause (std_srvs/SetBool): true: no action begins any more. Running actions end as usual, and goals join and are
            planned for. false: the plan continues. A paused core that was killed resumes paused.
        ~stop (std_srvs/Trigger): cancels the running actions and aborts all goals. Then no action begins until the next
            goal arrives, or ``~pause`` gets false; a paused core stays paused.
    Actions served:
        rosoclingo (rosoclingo/ROSoClingoAction): goals of any number of clients, each with its own status.

    Raises ParameterError, ProgramError and JournalError if the core cannot start.

    """

    def __init__(self) -> None:
        self._parameters = core_parameters()
        self._ending = False
        self._arrivals: Set[str] = set()  # keys of queued goals
        self._cancels: Set[str] = set()  # keys of goals with a queued cancel
        self._recalled: List[str] = []  # keys of queued goals that were cancelled, until the journal records that
        self._last_time, self._last_cycle, self._fault = 0.0, 0.0, ""
        self._clock, self._register = PacedClock(), InterfaceRegister()
        self._gathering = Gathering(time.monotonic())
        self._handles = GoalHandles(self._missing)
        program, odd = load_program(self._parameters)
        for warning in odd:
            rospy.logwarn("%s: %s", rospy.get_name(), warning)
        plan_time = self._parameters.time_to_shorten
        self._solvers = WorkerPool(program, shortest=True, plan_time=plan_time, standby=True)
        found = find_journal(self._parameters, program)
        self._keeper = Keeper(self._let_out, found.journal, time.monotonic, rospy.get_time, found.fault)
        self._core = Core(
            program,
            lambda: ProcessSolver(self._solvers),
            self._keeper,
            self._parameters.settings,
            lambda: self._watch(self._parameters.settings.search_timeout, self._why_useless),
            lambda: self._watch(self._parameters.recovery_timeout, lambda spent: None),
            None if plan_time is None else lambda: self._watch(0.0, self._why_late),
            record=found.state,
        )
        self._keeper.attach(self._core, found.state)
        self._worker = Worker(self._settle)
        self._unmet_goals = UnmetGoals(program, self._worker, self._keeper.aborted_goals)
        described = RunProgram.of(found.run, program, self._parameters.deciding).text()
        self._topics = CoreTopics(self._core, found.run, described)
        self._facts = FactIntake(self._core, self._register, self._worker, self._topics)
        self._problems, self._plan = LogThrottle(), None  # type: LogThrottle, Optional[PlanMade]
        self._diagnostics = Diagnostics(rospy.get_name().strip("/") + ": core", self._describe)
        self._outlets: Dict[Type[Event], Callable[[Any], None]] = {
            UpdateSent: self._topics.update_sent,
            PlanMade: self._plan_made,
            StateChanged: self._topics.state_changed,
            ActionsDispatched: self._topics.actions_dispatched,
            ActionsPreempted: self._topics.actions_preempted,
            ReturnAccepted: self._return_taken,
            GoalChanged: self._handles.changed,
            GoalProgress: self._handles.progress,
            ModeChanged: lambda event: self._topics.publish_mode(event.mode),
            Problem: self._log_problem,
        }
        self._connect(resumed=found.state is not None)

    def _connect(self, resumed: bool) -> None:
        self._worker.put(self._start)
        arrived = partial(self._worker.put, self._take_arrivals)
        taken = self._goal_arrived, self._cancel_arrived
        self._server = GoalServer("rosoclingo", *taken, arrived, resumed)
        self._go_on_with_clients()
        self._server.greet()
        self._facts.connect()
        self._commands = OperatorCommands(self._core, self._worker, self._send)
        rospy.on_shutdown(self._shut_down)
        start_server(self._server)
        self._worker.start()

    # -- jobs of the worker

    def _start(self) -> None:
        """Publish the restored state, then wait for the solver process, which no search time includes."""
        self._topics.publish_mode(self._core.mode)
        self._core.report_beliefs()
        if self._core.plan.actions:
            self._plan_made(PlanMade(self._core.cycle, self._core.horizon, self._core.shown))
        self._send()
        try:
            self._solvers.start(self._attend)
        except DroppedError as error:
            if not self._ending:
                rospy.logwarn("%s", error)
        self._core.start()

    def _go_on_with_clients(self) -> None:
        """Restore the goals of a killed core before the server publishes a status."""
        for key, client in self._keeper.clients.items():
            goal = self._core.goal(key)
            status = client.state(None if goal is None else goal.state).number
            reason = "" if client.ending is None else client.ending.message
            handle = self._server.restore(key, client.text, rospy.Time(*client.stamp), status, reason)
            if client.ending is not None:
                self._handles.add(key, handle, has_ended=True)  # its end can have reached no node yet
                result = ROSoClingoResult(int(client.ending.outcome), client.ending.message)
                self._server.keep_result(handle.get_goal_status(), result)
                continue
            self._handles.add(key, handle)
            if goal is None:
                self._worker.put(partial(self._core.add_goal, key, client.text))
            if client.cancelled:
                self._worker.put(partial(self._core.cancel_goal, key))
        self._handles.flush()

    def _take_arrivals(self) -> None:
        """Take queued goals and cancels, also during a search; clients see them once the journal has them.

        A goal that is cancelled before the core has received it ends immediately.
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
        self._worker.put(lambda: self._add_goal(key, text))

    def _add_goal(self, key: str, text: str) -> None:
        if key in self._arrivals:
            self._arrivals.discard(key)
            self._gathering.goal_arrived(time.monotonic())
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
        self._facts.announce()
        self._tick()
        improvable = self._go_on()
        self._send()
        self._keeper.forget(self._server.drop_results())
        self._look_after_journal()
        self._tick()
        if improvable:
            return 0.0
        if self._gathering.expects(time.monotonic()):
            return TOGETHER
        quiet = time.monotonic() - self._last_cycle >= 2 * PREPARING and not self._solvers.is_prefetching
        return IDLE if quiet else None

    def _go_on(self) -> bool:
        """Advance the core; return whether the plan can be improved until the next arrival."""
        now = rospy.get_time()
        if now < self._last_time:
            rospy.logwarn("time jumped back by %.1f s", self._last_time - now)
            forget_cancels(self._server)
        self._last_time = now
        if now == 0.0:
            rospy.logwarn_throttle(10.0, "waiting for /clock")
            return False
        self._core.poll(self._time())
        self._core.interfaces.look(time.monotonic())
        self._send()
        while not self._ending:
            gathers = self._gathering.waits(time.monotonic(), self._worker.waiting)
            if gathers or not self._core.advance(self._time()):
                break
            self._send()
            self._last_cycle = time.monotonic()
            if self._worker.waiting:  # a cancel that arrived during the search affects the next search
                break
        self._send()
        arrives = self._watch_arrivals(rospy.get_time())
        if time.monotonic() - self._last_cycle >= PREPARING:
            self._core.prepare()
            self._core.compact(arrives)
        return self._parameters.time_to_shorten is not None and self._core.improve(arrives)

    def _send(self) -> None:
        self._keeper.send(keep_ends=self._server.awaits_clients)

    def _tick(self) -> None:
        """Publish and log changes; called often, also during a search."""
        for line in self._problems.counted(time.monotonic()):
            rospy.logwarn("%s", line)
        self._diagnostics.tick()
        self._handles.tick()

    def _time(self) -> float:
        return self._clock.at(rospy.get_time(), time.monotonic())

    def _attend(self) -> bool:
        """Publish changes and take arrivals, also during a search; return whether the core shuts down."""
        self._tick()
        if self._server.arrivals:
            self._take_arrivals()
        return self._ending

    def _watch_arrivals(self, now: float) -> Callable[[], bool]:
        """Return a watch that ends optional work on any arrival, or after IMPROVING seconds."""
        start = time.monotonic()

        def look() -> bool:
            """Return whether to end it now."""
            self._tick()
            spent = max(time.monotonic() - start, abs(rospy.get_time() - now))
            return self._ending or self._worker.waiting or spent >= IMPROVING

        return look

    def _why_useless(self, spent: float) -> Optional[Halt]:
        """Return why a search of ``spent`` seconds of wall time is useless: a cancel, or the shutdown."""
        if self._ending:
            return Halt("the core shuts down", disturbed=True)
        why = self._core.queue.why_interrupted(self._cancels, bool(self._arrivals))
        return Halt(why, disturbed=True) if why and spent >= CANCEL_GRACE else None

    def _why_late(self, spent: float) -> Optional[Halt]:
        """Return why a search for a plan with new goals would delay the next action, after ``spent`` seconds."""
        return Halt(f"it took longer than {JOINING:g} s") if self._ending or spent >= JOINING else None

    def _watch(self, seconds: float, look: Callable[[float], Optional[Halt]]) -> Callable[[], Optional[Halt]]:
        """Return a watch that publishes changes and takes arrivals during a search.

        It ends the search if ``look`` does, whose argument is the wall time spent, or after ``seconds`` of processor
        time, 0 for no limit.
        """
        queue, start = self._core.queue, time.monotonic()
        worked, limit = self._solvers.stopwatch(), seconds * queue.patience

        def watch() -> Optional[Halt]:
            """Return why the search has to end now, None while it can continue."""
            self._attend()
            if self._commands.waiting:
                return Halt("an operator's command has arrived", disturbed=True)
            halt = look(time.monotonic() - start)
            if halt is None and 0 < limit <= worked():
                if not queue.unhurried:
                    halt = Halt(f"it took longer than {limit:g} s")
                elif self._worker.waiting:
                    halt = Halt("something has come", disturbed=True)
            return halt

        return watch

    def _shut_down(self) -> None:
        self._ending = True
        self._worker.put(lambda: self._core.shut_down("is aborted: the core shuts down"))
        self._worker.put(self._send)
        self._worker.put(self._handles.flush)
        self._worker.put(self._keeper.close)
        self._worker.put(self._solvers.close)
        self._worker.stop(SHUTDOWN_TIME)

    # -- events of the core

    def _let_out(self, event: Event) -> None:
        outlet = self._outlets.get(type(event))
        if outlet is not None:
            outlet(event)

    def _look_after_journal(self) -> None:
        """Log once that the journal cannot be written, or can be written again."""
        if self._keeper.fault != self._fault:
            self._fault = self._keeper.fault
            text = self._fault + ": the core continues without" if self._fault else "the journal is written again"
            (rospy.logwarn if self._fault else rospy.loginfo)("%s: %s", rospy.get_name(), text)

    def _plan_made(self, event: PlanMade) -> None:
        self._topics.plan_made(event)
        self._plan = event

    def _return_taken(self, event: ReturnAccepted) -> None:
        self._topics.look()
        self._register.answered(return_of(event.atom).interface_name)

    def _log_problem(self, event: Problem) -> None:
        """Log a problem, unless it was logged before."""
        line = self._problems.take(event, time.monotonic())
        if line:
            rospy.logwarn("%s", line)

    def _missing(self) -> str:
        """Return a message if a running action has no interface, else an empty text."""
        now = time.monotonic()
        return self._register.fault(self._core.awaited, self._topics.listeners, self._facts.senders, now)

    def _describe(self) -> Findings:
        now = time.monotonic()
        missing = self._register.look(self._core.awaited, self._topics.listeners, self._facts.senders, now)
        for one in missing:
            if one.new:
                self._log_problem(Problem(self._core.cycle, one.text, one.action.interface_name))
        start = "" if rospy.get_time() else "waits for /clock"
        fault = start or self._keeper.fault or (missing[0].text if missing else "")
        return describe_core(self._core, self._plan, self._problems, self._register.names, fault, now)
