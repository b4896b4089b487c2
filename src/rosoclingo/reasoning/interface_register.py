"""Which interfaces there are, and which actions wait for one that is not there."""

import re
from typing import AbstractSet, Dict, FrozenSet, Iterable, List, NamedTuple, Optional, Sequence, Set

from rosoclingo.reasoning.keywords import Action, shortened

#: Interfaces that one node can announce.
MOST_NAMES = 1000

#: Seconds for which an action may wait for its interface to appear before that is told.
GRACE = 2.0


#: Seconds after which a client can expect the core to have reported a missing interface.
REPORTED = GRACE + 3.0

_MISSING = "no interface '{}' for {}: {}"
_PERHAPS = " may have others"
_MISSED = re.compile(r"no interface '.*?' for (_action_lib\(.*\)): ")


class Missing(NamedTuple):
    """An action that waits for an interface that is not there, in words; ``new`` the first time that it is told."""

    action: Action
    text: str
    new: bool


class InterfaceRegister:
    """Knows interfaces by what their nodes announce, and those of nodes that announce nothing by what they answer.

    Nodes are known by name. ``now`` is in seconds of a clock that only goes forward.
    """

    def __init__(self) -> None:
        self._announced: Dict[str, Set[str]] = {}  # node -> its interfaces
        self._answered: Set[str] = set()
        self._since: Dict[Action, float] = {}
        self._told: Set[Action] = set()

    @property
    def names(self) -> List[str]:
        """The interfaces that were announced, sorted."""
        return sorted(set().union(*self._announced.values()))

    def announce(self, node: str, interface: str) -> None:
        """Record that a node announces an interface."""
        names = self._announced.setdefault(node, set())
        if len(names) < MOST_NAMES:
            names.add(interface)

    def answered(self, interface: str) -> None:
        """Record that a return of an interface was taken."""
        self._answered.add(interface)

    def look(
        self, awaited: Sequence[Action], listening: AbstractSet[str], speaking: AbstractSet[str], now: float
    ) -> List[Missing]:
        """The actions that have waited for long for an interface that is not there.

        ``listening`` are the nodes that hear the actions, ``speaking`` those that may send returns.
        """
        self._announced = {node: names for node, names in self._announced.items() if node in speaking}
        self._since = {action: self._since.get(action, now) for action in awaited}
        self._told &= set(awaited)
        silent = sorted(node for node in listening & speaking if node not in self._announced)
        there = set().union(*(names for node, names in self._announced.items() if node in listening))
        there |= self._answered if silent else set()
        late = [action for action, since in self._since.items() if now - since >= GRACE]
        missing = [action for action in late if action.interface_name not in there]
        found = [Missing(one, self._text(one, silent, bool(listening)), one not in self._told) for one in missing]
        self._told.update(missing)
        return found

    def _text(self, action: Action, silent: Sequence[str], heard: bool) -> str:
        wanted, known = shortened(action.interface_name), ", ".join(self.names) or "none"
        perhaps = f", and {', '.join(silent)}{_PERHAPS}" if silent else ""
        there = f"the interfaces are {known}{perhaps}" if heard else "nobody listens on out_rosoclingo"
        return _MISSING.format(wanted, shortened(str(action.atom)), there)


class ReportedInterfaces:
    """The actions with an interface, as a client knows them from the core's reports on /diagnostics."""

    def __init__(self) -> None:
        self._names: Optional[FrozenSet[str]] = None
        self._message = ""
        self._since: Dict[Action, float] = {}

    @property
    def known(self) -> bool:
        """Whether the core has reported."""
        return self._names is not None

    def report(self, names: Iterable[str], message: str) -> None:
        """Take the interfaces announced to the core, and the message of its report."""
        self._names, self._message = frozenset(names), message

    def fault(self, action: Action, now: float) -> Optional[str]:
        """Return why no interface serves a sent action, empty if that is not known yet, None if one does.

        ``now`` is in seconds of a monotonic clock. An interface counts as present if a node without announcements may
        have it, and if the core reports nothing for a while.
        """
        if self._names is None or action.interface_name in self._names:
            return None
        missed = _MISSED.match(self._message)
        if missed is not None and missed.group(1) == shortened(str(action.atom)):
            return None if self._message.endswith(_PERHAPS) else self._message
        return "" if now - self._since.setdefault(action, now) < REPORTED else None
