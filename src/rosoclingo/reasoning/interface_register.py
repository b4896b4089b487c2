"""The register of interfaces, which detects actions that wait for a missing interface."""

import re
from typing import AbstractSet, Dict, FrozenSet, Iterable, List, NamedTuple, Optional, Sequence, Set

from rosoclingo.reasoning.keywords import Action, shortened

#: Maximum number of interfaces that a node can announce.
MOST_NAMES = 1000

#: Seconds that an action waits for its interface before the core reports that it is missing.
GRACE = 2.0


#: Seconds within which the core has reported a missing interface to clients.
REPORTED = GRACE + 3.0

_MISSING = "no interface '{}' for {}: {}"
_PERHAPS = " may have others"
_MISSED = re.compile(r"no interface '.*?' for (_action_lib\(.*\)): ")


class Missing(NamedTuple):
    """An action whose interface is missing, and a message; ``new`` is true for the first report of the action."""

    action: Action
    text: str
    new: bool


class InterfaceRegister:
    """Tracks interfaces by the announcements of their nodes, or by their returns if a node announces nothing.

    Nodes are identified by name. ``now`` is in seconds of a monotonic clock.
    """

    def __init__(self) -> None:
        self._announced: Dict[str, Set[str]] = {}  # node -> its interfaces
        self._answered: Set[str] = set()
        self._since: Dict[Action, float] = {}
        self._reported: Set[Action] = set()

    @property
    def names(self) -> List[str]:
        """The announced interfaces, sorted."""
        return sorted(set().union(*self._announced.values()))

    def announce(self, node: str, interface: str) -> None:
        """Record that a node announces an interface."""
        names = self._announced.setdefault(node, set())
        if len(names) < MOST_NAMES:
            names.add(interface)

    def answered(self, interface: str) -> None:
        """Record that a return of an interface was accepted."""
        self._answered.add(interface)

    def look(
        self, awaited: Sequence[Action], listening: AbstractSet[str], speaking: AbstractSet[str], now: float
    ) -> List[Missing]:
        """Return the actions that have waited too long for a missing interface.

        The nodes ``listening`` receive actions, and the nodes ``speaking`` can send returns.
        """
        self._announced = {node: names for node, names in self._announced.items() if node in speaking}
        self._since = {action: self._since.get(action, now) for action in awaited}
        self._reported &= set(awaited)
        silent = sorted(node for node in listening & speaking if node not in self._announced)
        there = set().union(*(names for node, names in self._announced.items() if node in listening))
        there |= self._answered if silent else set()
        late = [action for action, since in self._since.items() if now - since >= GRACE]
        missing = [action for action in late if action.interface_name not in there]
        found = [Missing(one, self._text(one, silent, bool(listening)), one not in self._reported) for one in missing]
        self._reported.update(missing)
        return found

    def _text(self, action: Action, silent: Sequence[str], heard: bool) -> str:
        wanted, known = shortened(action.interface_name), ", ".join(self.names) or "none"
        perhaps = f", and {', '.join(silent)}{_PERHAPS}" if silent else ""
        there = f"the interfaces are {known}{perhaps}" if heard else "no node subscribes to out_rosoclingo"
        return _MISSING.format(wanted, shortened(str(action.atom)), there)


class ReportedInterfaces:
    """The interfaces as reported by the core on /diagnostics, for clients."""

    def __init__(self) -> None:
        self._names: Optional[FrozenSet[str]] = None
        self._message = ""
        self._since: Dict[Action, float] = {}

    @property
    def known(self) -> bool:
        """Whether the core has reported."""
        return self._names is not None

    def report(self, names: Iterable[str], message: str) -> None:
        """Record the interfaces announced to the core, and the message of its report."""
        self._names, self._message = frozenset(names), message

    def fault(self, action: Action, now: float) -> Optional[str]:
        """Return why no interface executes an action, empty if that is not known yet, None if an interface does.

        ``now`` is in seconds of a monotonic clock. An interface counts as present if a node without announcements can
        have it, or if the core does not report it as missing in time.
        """
        if self._names is None or action.interface_name in self._names:
            return None
        missed = _MISSED.match(self._message)
        if missed is not None and missed.group(1) == shortened(str(action.atom)):
            return None if self._message.endswith(_PERHAPS) else self._message
        return "" if now - self._since.setdefault(action, now) < REPORTED else None
