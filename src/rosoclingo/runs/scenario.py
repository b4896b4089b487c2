"""Scenarios: timed events of clients, initial places of packages, and the expected end.

doc/scenarios.md describes the format.
"""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Callable, Dict, Mapping, Optional, Tuple

from rosoclingo.common.reading import MISSING, Reader, read_yaml

#: The verbs of events: the description of their value, and the function that reads it.
VERBS: Dict[str, Tuple[str, Callable[[Any], Any]]] = {
    "request": ("a goal as text", lambda value: value if isinstance(value, str) else None),
    "cancel": ("a goal's identifier", lambda value: value),
    "facts": ("a list of atoms", lambda value: value if isinstance(value, list) else None),
    "call": ("the name of a service", lambda value: value if isinstance(value, str) else None),
}

#: The action servers of the case study.
SERVERS = ("move_base", "pickup", "deliver")

OUTCOMES = ("succeeded", "canceled", "rejected", "aborted")


class ScenarioError(ValueError):
    """A scenario that cannot be played; the text has the place and the fault."""


@dataclass(frozen=True)
class ScenarioEvent:
    """An event: ``verb`` with ``value``, at ``time``, or ``time`` seconds into ``cycle``.

    ``fields`` are the fields of a service's request.
    """

    verb: str
    value: Any
    time: float = 0.0
    cycle: Optional[int] = None
    client: str = "client"
    origin: str = "scenario"
    fields: Mapping[str, Any] = field(default_factory=dict)

    def due(self, elapsed: float, begun: Mapping[int, float]) -> bool:
        """Return whether the event is due ``elapsed`` seconds after the start; ``begun`` has the times of cycles."""
        if self.cycle is None:
            return elapsed >= self.time
        reached = [moment for cycle, moment in begun.items() if cycle >= self.cycle]
        return bool(reached) and elapsed >= min(reached) + self.time

    def __str__(self) -> str:
        when = f"at {self.time:g} s" if self.cycle is None else f"in cycle {self.cycle}"
        return f"{when} {self.verb} {self.value}"


@dataclass(frozen=True)
class Scenario:
    """A scenario; without ``expect`` it accepts any end."""

    title: str
    events: Tuple[ScenarioEvent, ...]
    packages: Dict[str, str] = field(default_factory=dict)
    expect: Dict[str, Any] = field(default_factory=dict)
    timeout: float = 3600.0
    launch: str = "mailbot"
    servers: Tuple[str, ...] = SERVERS

    @classmethod
    def from_file(cls, path: Path) -> "Scenario":
        """Read a scenario from a YAML file; raises ScenarioError with all faults."""
        return cls.read(read_yaml(path, "scenario", ScenarioError))

    @classmethod
    def read(cls, reader: Reader) -> "Scenario":
        """Read a scenario; raises ScenarioError with all faults."""
        scenario = cls(
            title=reader.at("title").text(""),
            events=tuple(_event(one) for one in reader.at("events").items("a list of events", MISSING)),
            packages=_places(reader.at("packages")),
            expect=_expectation(reader.at("expect")),
            timeout=_seconds(reader.at("timeout"), cls.timeout),
            launch=reader.at("launch").text(cls.launch),
            servers=reader.at("servers").texts(SERVERS, "a list of action servers"),
        )
        reader.close()
        reader.check(ScenarioError)
        return scenario


def _event(reader: Reader) -> ScenarioEvent:
    verbs = {verb: value for verb, value in ((verb, reader.at(verb)) for verb in VERBS) if value.given}
    verb, value = next(iter(verbs.items()), ("", reader))
    time, cycle, delay, fields = (reader.at(key) for key in ("time", "cycle", "delay", "with"))
    event = ScenarioEvent(
        verb,
        value.read(VERBS[verb][0], VERBS[verb][1]) if verb else None,
        _seconds(delay if cycle.given else time, 0.0),
        cycle.whole(low=1) if cycle.given else None,
        reader.at("client").text(ScenarioEvent.client),
        reader.at("origin").text(ScenarioEvent.origin),
        fields.mapping("a mapping of the request's fields", {}),
    )
    reader.close()
    if isinstance(reader.value, dict):
        if len(verbs) != 1:
            reader.fault("give one of {}".format(", ".join(VERBS)))
        if time.given == cycle.given:
            reader.fault("give either 'time' or 'cycle'")
        if delay.given and not cycle.given:
            delay.fault("is only for events with a 'cycle'")
        if fields.given and verb != "call":
            fields.fault("is only for 'call'")
    return event


def _expectation(reader: Reader) -> Dict[str, Any]:
    goals, packages, robot, robots, actions = map(reader.at, ("goals", "packages", "robot", "robots", "actions"))
    found = {
        "goals": [one.choice(OUTCOMES) for one in goals.items("a list of outcomes")],
        "packages": _places(packages),
        "robot": robot.text(""),
        "robots": _places(robots, "robots"),
        "actions": list(actions.texts((), "a list of atoms as text")),
    }
    reader.close()
    return {key: value for key, value in found.items() if reader.at(key).given}


def _places(reader: Reader, things: str = "packages") -> Dict[str, str]:
    """Return the places of things by name; both are terms, so numbers need no quotes."""
    return {name: str(place.value) for name, place in reader.entries(f"a mapping of {things} to labels", {})}


def _seconds(reader: Reader, default: float) -> float:
    return reader.number(default, low=0.0, wanted="a number of seconds, at least 0")
