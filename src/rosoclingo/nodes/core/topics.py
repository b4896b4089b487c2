"""The publishers of the core: actions for the interfaces, plans and stream updates."""

from typing import Dict, Iterable, List, Set, Tuple

import rospy
from clingo import Symbol
from std_msgs.msg import String, UInt32

from rosoclingo.common.prompt_publisher import prompt_publisher
from rosoclingo.msg import InterfaceIO, State, TaskPlan
from rosoclingo.reasoning.core import Core
from rosoclingo.reasoning.events import ActionsDispatched, ActionsPreempted, Mode, PlanMade, StateChanged, UpdateSent
from rosoclingo.reasoning.keywords import CORE, Action, run_of


class CoreTopics:
    """The topics of the core; use them on the worker only.

    ``program`` is the text of the program and of all parameters that affect decisions.
    """

    def __init__(self, core: Core, run: str, program: str) -> None:
        self._core = core
        self._running: Tuple[InterfaceIO, ...] = ()
        self.look()
        self._run = InterfaceIO(CORE, [str(run_of(run))])
        self._out = prompt_publisher("out_rosoclingo", InterfaceIO, greeting=self._greeting)
        self._task_plan = prompt_publisher("~task_plan", TaskPlan, 10, latch=True)
        self._state = prompt_publisher("~state", State, 10, latch=True)
        self._program = prompt_publisher("~program", String, 1, latch=True)
        self._program.publish(String(program))
        self._updates = prompt_publisher("~updates", String)
        self._cycle = prompt_publisher("~cycle", UInt32, 10, latch=True)
        self._mode = prompt_publisher("~mode", String, 1, latch=True)
        self._last_cycle = 0
        self._publish_cycle(core.cycle)

    @property
    def listeners(self) -> Set[str]:
        """The names of the nodes that subscribe to the actions."""
        return {connection.endpoint_id for connection in self._out.impl.connections}

    def _greeting(self) -> Tuple[InterfaceIO, ...]:
        return (self._run, *self._running)

    def update_sent(self, event: UpdateSent) -> None:
        """Publish a stream update."""
        self._updates.publish(String(event.stream))
        self._publish_cycle(event.cycle)

    def _publish_cycle(self, cycle: int) -> None:
        if cycle != self._last_cycle:
            self._last_cycle = cycle
            self._cycle.publish(UInt32(cycle))

    def publish_mode(self, mode: Mode) -> None:
        """Publish whether the core dispatches actions."""
        self._mode.publish(String(mode.value))

    def plan_made(self, event: PlanMade) -> None:
        """Publish a plan."""
        message = TaskPlan(cycle=event.cycle, horizon=event.horizon, actions=[str(one.atom) for one in event.actions])
        message.ground_time, message.solve_time = event.ground, event.solve
        message.header.stamp = rospy.Time.now()
        self._task_plan.publish(message)

    def state_changed(self, event: StateChanged) -> None:
        """Publish the beliefs."""
        message = State(cycle=event.cycle, atoms=sorted(map(str, event.atoms)))
        message.header.stamp = rospy.Time.now()
        self._state.publish(message)

    def actions_dispatched(self, event: ActionsDispatched) -> None:
        """Publish the actions of a cycle."""
        self._send((action, action.atom) for action in event.actions)

    def actions_preempted(self, event: ActionsPreempted) -> None:
        """Publish the cancellations of actions."""
        self._send((action, action.cancellation) for action in event.actions)

    def _send(self, facts: Iterable[Tuple[Action, Symbol]]) -> None:
        self.look()
        for message in _messages(facts):
            self._out.publish(message)

    def send_again(self, interface: str) -> None:
        """Publish the running actions of an interface again: their returns can be lost with its former connection."""
        for message in self._running:
            if message.interface == interface:
                self._out.publish(message)

    def look(self) -> None:
        """Update the running actions that new subscribers get; call this after each change."""
        wanted = _messages((action, action.atom) for action in self._core.awaited)
        self._running = (*wanted, *_messages((action, action.cancellation) for action in self._core.preempted))


def _messages(facts: Iterable[Tuple[Action, Symbol]]) -> Tuple[InterfaceIO, ...]:
    """Return one message for each interface, in the order of the actions."""
    texts: Dict[str, List[str]] = {}
    for action, fact in facts:
        texts.setdefault(action.interface_name, []).append(str(fact))
    return tuple(InterfaceIO(name, found) for name, found in texts.items())
