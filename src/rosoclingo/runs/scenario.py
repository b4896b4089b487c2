"""Scenarios: what clients do at which moment, where packages lie at first, and how it should end. Data in YAML.

    title: The case study of the paper
    packages: {1: office3, 2: office3}
    events:
      - {time: 1.0, request: "goal(office3,office2,1)"}
      - {cycle: 2, cancel: 1}
      - {cycle: 3, delay: 0.5, request: "goal(office3,office4,2)", client: second}
      - {cycle: 5, call: simulator/set_door, with: {door: corridor, open: false}}
    expect:
      goals: [canceled, succeeded]
      packages: {1: office3, 2: office4}
      robot: office4
      actions: ["_action_lib(move_base,office2,1)"]

An event happens ``time`` seconds (simulated) after the scenario began, or ``delay`` seconds after the plan of
``cycle`` is out. ``request`` sends a goal, ``cancel`` cancels the latest one with this identity, ``facts`` tells the
core something as the interface ``origin``. ``call`` calls a service with the fields of its request: so doors are closed
and packages taken away. ``launch`` names the launch file that starts the scenario's world (mailbot), ``timeout`` is how
long the whole may take, in simulated seconds.
"""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Dict, List, Mapping, Optional, Tuple

import yaml

#: What an event can do, and the type of what is done.
VERBS: Dict[str, type] = {"request": str, "cancel": object, "facts": list, "call": str}

_WHEN = {"time", "cycle", "delay"}
_EXTRAS = {"client", "origin"}
_KEYS = {"title", "launch", "packages", "events", "expect", "timeout"}
_EXPECTED = {"goals", "packages", "robot", "actions"}
_OUTCOMES = {"succeeded", "canceled", "rejected", "aborted"}


class ScenarioError(ValueError):
    """A scenario that cannot be played; the text names the place and the fault."""


@dataclass(frozen=True)
class ScenarioEvent:
    """One thing that happens: ``verb`` with ``value``, at ``time`` or ``delay`` seconds into ``cycle``.

    ``fields`` are those of the request when a service is called.
    """

    verb: str
    value: Any
    time: float = 0.0
    cycle: Optional[int] = None
    client: str = "client"
    origin: str = "scenario"
    fields: Dict[str, Any] = field(default_factory=dict)

    def due(self, elapsed: float, begun: Mapping[int, float]) -> bool:
        """Whether it is to happen ``elapsed`` seconds after the start; ``begun`` tells when each cycle so far began."""
        if self.cycle is None:
            return elapsed >= self.time
        reached = [moment for cycle, moment in begun.items() if cycle >= self.cycle]
        return bool(reached) and elapsed >= min(reached) + self.time

    def __str__(self) -> str:
        when = f"at {self.time:g} s" if self.cycle is None else f"in cycle {self.cycle}"
        return f"{when} {self.verb} {self.value}"


@dataclass(frozen=True)
class Scenario:
    """A whole scenario; ``expect`` is empty when any end will do."""

    title: str
    events: Tuple[ScenarioEvent, ...]
    packages: Dict[str, str] = field(default_factory=dict)
    expect: Dict[str, Any] = field(default_factory=dict)
    timeout: float = 3600.0
    launch: str = "mailbot"

    @classmethod
    def from_file(cls, path: Path) -> "Scenario":
        """Read a YAML file; raises ScenarioError."""
        try:
            return cls.from_text(path.read_text(encoding="utf-8"))
        except (OSError, UnicodeDecodeError, ScenarioError) as error:
            raise ScenarioError(f"{path}: {error}") from error

    @classmethod
    def from_text(cls, text: str) -> "Scenario":
        """Read YAML; raises ScenarioError."""
        try:
            data = yaml.safe_load(text)
        except yaml.YAMLError as error:
            raise ScenarioError(f"this is no YAML: {error}") from error
        _check_keys(data, _KEYS, "the scenario")
        if not isinstance(data.get("events"), list):
            raise ScenarioError("events: give a list of events")
        return cls(
            title=str(data.get("title", "")),
            events=tuple(_event(one, f"event {number}") for number, one in enumerate(data["events"], 1)),
            packages={str(key): str(value) for key, value in _map(data, "packages").items()},
            expect=_expectation(_map(data, "expect")),
            timeout=_number(data.get("timeout", cls.timeout), "timeout"),
            launch=str(data.get("launch", cls.launch)),
        )


def _event(data: Any, place: str) -> ScenarioEvent:
    _check_keys(data, _WHEN | _EXTRAS | {"with"} | set(VERBS), place)
    verbs = [verb for verb in VERBS if verb in data]
    if len(verbs) != 1:
        raise ScenarioError("{}: give one of {}".format(place, ", ".join(VERBS)))
    if ("time" in data) == ("cycle" in data):
        raise ScenarioError(f"{place}: give either 'time' or 'cycle'")
    value = data[verbs[0]]
    if not isinstance(value, VERBS[verbs[0]]):
        raise ScenarioError(f"{place}: {value!r} is nothing to {verbs[0]}")
    cycle = data.get("cycle")
    if cycle is not None and (not isinstance(cycle, int) or cycle < 1):
        raise ScenarioError(f"{place}: cycle: {cycle!r} is no cycle")
    moment = _number(data.get("delay" if cycle else "time", 0.0), place)
    if "with" in data and verbs != ["call"]:
        raise ScenarioError(f"{place}: 'with' goes with 'call' alone")
    fields = _map(data, "with", f"{place}: with")
    extras = {key: str(data[key]) for key in _EXTRAS if key in data}
    return ScenarioEvent(verbs[0], value, moment, cycle, **extras, fields=fields)


def _expectation(data: Dict[str, Any]) -> Dict[str, Any]:
    _check_keys(data, _EXPECTED, "expect")
    unknown = [str(one) for one in data.get("goals", []) if one not in _OUTCOMES]
    if unknown:
        raise ScenarioError("expect: goals: {} is none of {}".format(unknown[0], ", ".join(sorted(_OUTCOMES))))
    if "packages" in data:
        data = {**data, "packages": {str(key): str(value) for key, value in _map(data, "packages").items()}}
    return data


def _check_keys(data: Any, known: "set[str]", place: str) -> None:
    if not isinstance(data, dict):
        raise ScenarioError("{}: give a map with the keys {}".format(place, ", ".join(sorted(known))))
    unknown: List[str] = [str(key) for key in data if key not in known]
    if unknown:
        raise ScenarioError("{}: '{}' is none of {}".format(place, unknown[0], ", ".join(sorted(known))))


def _map(data: Mapping[str, Any], key: str, place: str = "") -> Dict[Any, Any]:
    found = data.get(key) or {}
    if not isinstance(found, dict):
        raise ScenarioError(f"{place or key}: give a map")
    return found


def _number(value: Any, place: str) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0 <= value < float("inf"):
        raise ScenarioError(f"{place}: {value!r} is no number of seconds")
    return float(value)
