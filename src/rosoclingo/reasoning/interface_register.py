"""The register of interfaces, which detects actions that wait for a missing interface."""

from typing import AbstractSet, Dict, List, NamedTuple, Sequence, Set, Tuple

from rosoclingo.reasoning.keywords import Action, shortened

#: Maximum number of interfaces that a node can announce.
MOST_NAMES = 1000

#: Seconds that an action waits for its interface before the core reports that it is missing.
GRACE = 2.0


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
        there, silent = self._served(listening, speaking)
        missing = [one for one in self._late(awaited, now) if one.interface_name not in there]
        found = [Missing(one, self._text(one, silent, bool(listening)), one not in self._reported) for one in missing]
        self._reported.update(missing)
        return found

    def fault(
        self, awaited: Sequence[Action], listening: AbstractSet[str], speaking: AbstractSet[str], now: float
    ) -> str:
        """Return the message about the first late action that certainly has no interface now, empty for none."""
        there, silent = self._served(listening, speaking)
        missing = [] if silent else [one for one in self._late(awaited, now) if one.interface_name not in there]
        return self._text(missing[0], silent, bool(listening)) if missing else ""

    def _late(self, awaited: Sequence[Action], now: float) -> List[Action]:
        """Return the actions that are awaited since :data:`GRACE` seconds; starting interfaces need some time."""
        return [action for action in awaited if now - self._since.get(action, now) >= GRACE]

    def _served(self, listening: AbstractSet[str], speaking: AbstractSet[str]) -> Tuple[Set[str], List[str]]:
        """Return the interfaces of connected nodes, and the connected nodes without announcements."""
        nodes = listening & speaking
        silent = sorted(node for node in nodes if node not in self._announced)
        there = set().union(*(names for node, names in self._announced.items() if node in nodes))
        return there | (self._answered if silent else set()), silent

    def _text(self, action: Action, silent: Sequence[str], heard: bool) -> str:
        wanted, known = shortened(action.interface_name), ", ".join(self.names) or "none"
        perhaps = f", and {', '.join(silent)} may have others" if silent else ""
        there = f"the interfaces are {known}{perhaps}" if heard else "no node subscribes to out_rosoclingo"
        return f"no interface '{wanted}' for {shortened(str(action.atom))}: {there}"
