"""The watch over the interfaces: which robots are lost because an interface is silent, and which are back."""

from typing import Dict, FrozenSet, List, Set, Tuple

from clingo import Function, String, Symbol

from rosoclingo.oclingo import ProgressionError, ReactiveProgram, parse_term
from rosoclingo.planning.history import robots_of
from rosoclingo.reasoning.events import ActionsPreempted, Announcer
from rosoclingo.reasoning.interface_register import MOST_NAMES
from rosoclingo.reasoning.keywords import BACK, INTERFACE_LOST, LOST, NOW, Action
from rosoclingo.reasoning.records import PersistentPart, fields
from rosoclingo.reasoning.returns import ExecutionMonitor

#: Limit in seconds of the silence counted between two checks: a core that searches or is suspended receives nothing.
LONGEST_LOOK = 1.0


class InterfaceWatch(PersistentPart):
    """Reports lost robots to a program that declares ``#external _lost/2``, by ``_lost(R,C)`` and ``_back(R,C)``.

    An interface is watched from its first announcement or action on. It is silent after ``timeout`` seconds without a
    message; 0 for never. A robot is lost while one of its interfaces is silent.

    An action of a silent interface can still return. After ``lost_timeout`` seconds it fails with ``lost``; once its
    interface is heard again, it is cancelled there. A resumed watch hears each interface at its start.
    """

    GROUP = "interfaces"
    FIELDS = fields(_watched=Tuple[str, ...], _silent=Set[str], _failed=List[Action])

    def __init__(
        self,
        program: ReactiveProgram,
        execution: ExecutionMonitor,
        announce: Announcer,
        timeout: float,
        lost_timeout: float,
    ) -> None:
        self._execution, self._announce = execution, announce
        self._timeout = timeout if program.declares_external(LOST, 2) else 0.0
        self._reports_back = program.declares_external(BACK, 2)
        self._lost_timeout = lost_timeout
        self._time, self._looked = 0.0, float("inf")
        self._heard: Dict[str, float] = {}  # the watched interfaces, and the time of their last message
        self._silent: Set[str] = set()
        self._since: Dict[Action, float] = {}  # running actions of silent interfaces
        self._failed: List[Action] = []  # actions that failed with ``lost``, until their interface is heard again

    @property
    def lost(self) -> FrozenSet[Symbol]:
        """The lost robots."""
        return frozenset(map(robot_of, self._silent))

    def announce(self, interface: str) -> None:
        """Watch an interface from now on, and record its message."""
        if self._timeout > 0 and len(self._heard) < MOST_NAMES:
            self._heard.setdefault(interface, self._time)
        self.hear(interface)

    def hear(self, interface: str) -> None:
        """Record a message of an interface."""
        if interface not in self._heard:
            return
        self._heard[interface] = self._time
        if interface in self._silent:
            self._silent.remove(interface)
            late = tuple(one for one in self._failed if one.interface_name == interface)
            self._failed = [one for one in self._failed if one not in late]
            if late:
                self._announce.emit(ActionsPreempted(self._announce.cycle, late))
            if robot_of(interface) not in self.lost and self._reports_back:
                self._report(BACK, robot_of(interface), f"{interface} is heard again")

    def look(self, now: float) -> None:
        """Report robots that are lost, and fail actions whose time has expired; ``now`` is steady time in seconds."""
        self._time += min(max(now - self._looked, 0.0), LONGEST_LOOK)
        self._looked = now
        if self._timeout <= 0:
            return
        for action in self._execution.awaited:
            self._heard.setdefault(action.interface_name, self._time)
        for interface, heard in self._heard.items():
            if interface not in self._silent and self._time - heard >= self._timeout:
                known = robot_of(interface) in self.lost
                self._silent.add(interface)
                if not known:
                    self._report(LOST, robot_of(interface), f"{interface} has been silent for {self._timeout:g} s")
        running = [one for one in self._execution.awaited if one.interface_name in self._silent]
        self._since = {action: self._since.get(action, self._time) for action in running}
        late = [one for one, since in self._since.items() if 0 < self._lost_timeout <= self._time - since]
        self._execution.fail(late, INTERFACE_LOST, "has no return, and its interface is lost")
        self._failed += late

    def _report(self, name: str, robot: Symbol, why: str) -> None:
        self._announce.problem(f"{name}({robot},{NOW}): {why}", str(robot))
        self._execution.receive(str(robot), [str(Function(name, [robot, NOW]))])

    @property
    def _watched(self) -> Tuple[str, ...]:
        return tuple(self._heard)

    @_watched.setter
    def _watched(self, interfaces: Tuple[str, ...]) -> None:
        self._heard = dict.fromkeys(interfaces, self._time)


def robot_of(interface: str) -> Symbol:
    """Return the robot of an interface: the first argument of its name, else its name."""
    try:
        return robots_of(parse_term(interface))[0]
    except ProgressionError:
        return String(interface)
