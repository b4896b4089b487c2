"""Interfaces by configuration: reading and checking the entries of config/interfaces.yaml.  No ROS.

move_base:                           # the first argument of _action_lib(move_base,P,C)
  server: move_base                  # name of the actionlib server; default: the interface's name
  type: move_base_msgs/MoveBaseAction
  goal: {target_pose: $parameter.pose}    # fields of the goal; see templates.py
  timeout: 120.0                     # seconds of ROS time for one goal, 0 for no limit
  server_timeout: 5.0                # seconds until a silent server counts as lost
  pause: 3.0                         # seconds for which the server is left to somebody else who has taken it
  retries: 0                         # how often a goal that failed is sent again ...
  retry_on: [failed]                 # ... for these reasons only
  returns:                           # first rule that matches; without: the parameter, or a reason
    - {status: aborted, text: "(?i)no path", return: blocked, facts: ["blocked(${parameter},${cycle})"]}
    - {status: aborted, when: {outcome: 3}, return: not_here}
"""

import math
import re
from typing import Any, Callable, Dict, List, Mapping, NamedTuple, Optional, Pattern, Tuple

from rosoclingo.interfaces.action_runs import DEFAULT_LIMITS, Limits
from rosoclingo.interfaces.answers import DEFAULT_RETURNS, Rule, pattern_of
from rosoclingo.interfaces.templates import ANSWER_NAMES, GOAL_NAMES, TemplateError, check
from rosoclingo.interfaces.values import TermError, read_term

DEFAULT_RETRY_ON = ("failed", "blocked", "server_lost")

_TYPE = re.compile(r"[A-Za-z][A-Za-z0-9_]*/[A-Za-z][A-Za-z0-9_]*Action\Z")
_FIELDS = ("server", "type", "goal", "timeout", "server_timeout", "pause", "retries", "retry_on", "returns")
_RULE_FIELDS = ("status", "text", "when", "return", "facts")


class ConfigError(ValueError):
    """A configuration that cannot be used; the message lists each fault with its place and its mend."""


class InterfaceSpec(NamedTuple):
    """One interface: which actionlib action it drives, how goals are filled, how ends are answered."""

    name: str
    type: str
    server: str
    goal: Mapping[str, Any] = {}
    rules: Tuple[Rule, ...] = ()
    limits: Limits = DEFAULT_LIMITS
    retry_on: Tuple[str, ...] = DEFAULT_RETRY_ON


def read_specs(data: Any) -> Dict[str, InterfaceSpec]:
    """All entries of an interface configuration by name.  Raises ConfigError listing all faults."""
    specs, faults = survey(data)
    if faults:
        raise ConfigError("\n".join(faults))
    return specs


def survey(data: Any) -> Tuple[Dict[str, InterfaceSpec], List[str]]:
    """All entries by name, with defaults in place of what cannot be used, and the faults, each with its place."""
    if not isinstance(data, Mapping):
        return {}, [f"must be a mapping of interface names to their settings, not {data!r}"]
    if not data:
        return {}, ["has no entries; write one for each action, like move_base: {type: move_base_msgs/MoveBaseAction}"]
    specs: Dict[str, InterfaceSpec] = {}
    faults: List[str] = []
    for name, entry in data.items():
        specs[str(name)] = _spec(str(name), entry, faults)
    return specs, faults


def read_spec(name: str, entry: Any) -> InterfaceSpec:
    """One entry of an interface configuration.  Raises ConfigError listing its faults."""
    faults: List[str] = []
    spec = _spec(name, entry, faults)
    if faults:
        raise ConfigError("\n".join(faults))
    return spec


def _spec(name: str, entry: Any, faults: List[str]) -> InterfaceSpec:
    if not isinstance(entry, Mapping):
        faults.append(f"{name}: must be a mapping with type, server, goal ..., not {entry!r}")
        return InterfaceSpec(name, "", name)
    reader = _Reader(name)
    reader.known_fields(entry, _FIELDS, "")
    spec = InterfaceSpec(
        name=reader.term(name),
        type=reader.type_name(entry.get("type")),
        server=reader.text(entry.get("server", name), "server"),
        goal=reader.goal(entry.get("goal", {})),
        rules=reader.rules(entry.get("returns", [])),
        limits=reader.limits(entry),
        retry_on=reader.reasons(entry.get("retry_on", DEFAULT_RETRY_ON)),
    )
    faults.extend(reader.faults)
    return spec


def read_limits(entry: Mapping[str, Any], place: str, defaults: Limits = DEFAULT_LIMITS) -> Limits:
    """The fields `timeout`, `server_timeout`, `pause` and `retries` of a mapping.  Raises ConfigError."""
    reader = _Reader(place)
    limits = reader.limits(entry, defaults)
    if reader.faults:
        raise ConfigError("\n".join(reader.faults))
    return limits


class _Reader:
    """Reads the fields of one entry and collects the faults."""

    def __init__(self, place: str) -> None:
        self._place = place
        self.faults: List[str] = []

    def fault(self, field: str, message: str) -> None:
        """Note a fault of ``field``; empty for the entry as a whole."""
        self.faults.append("{}{}: {}".format(self._place, "." + field if field else "", message))

    def known_fields(self, entry: Mapping[str, Any], known: Tuple[str, ...], place: str) -> None:
        """Note each field of ``entry``, which stands at ``place``, that is not ``known``."""
        for field in entry:
            if field not in known:
                self.fault(place, "unknown field {!r}; fields are {}".format(field, ", ".join(known)))

    def term(self, name: str) -> str:
        """Return the interface's name as clingo prints it."""
        try:
            return str(read_term(name))
        except TermError:
            self.fault("", "the name must be the ASP term that the program uses, like gripper or arm(left)")
            return name

    def type_name(self, value: Any) -> str:
        """Return the name of an action type, package/NameAction; empty where it is none."""
        if value is None:
            self.fault("type", "is missing; name the action type, like move_base_msgs/MoveBaseAction")
        elif not isinstance(value, str) or not _TYPE.match(value):
            self.fault("type", f"{value!r} is no action type; write package/NameAction")
        else:
            return value
        return ""

    def text(self, value: Any, field: str) -> str:
        """Return the text of a field that must have one."""
        if not isinstance(value, str) or not value:
            self.fault(field, f"must be a text, not {value!r}")
        return str(value)

    def goal(self, value: Any) -> Mapping[str, Any]:
        """Return the templates for the goal's fields."""
        if not isinstance(value, Mapping):
            self.fault("goal", f"must be a mapping of the goal's fields, not {value!r}")
            return {}
        self._check(value, GOAL_NAMES, "goal")
        return value

    def limits(self, entry: Mapping[str, Any], defaults: Limits = DEFAULT_LIMITS) -> Limits:
        """Return time-outs and pause (s), and retries; ``defaults`` where ``entry`` has none."""
        timeout = self._number(entry, "timeout", defaults.timeout, lambda value: value >= 0, "a number from 0 on")
        server = self._number(entry, "server_timeout", defaults.server_timeout, lambda value: value > 0, "above 0")
        retries = self._number(
            entry, "retries", defaults.retries, lambda value: value >= 0 and value == int(value), "a whole number"
        )
        pause = self._number(entry, "pause", defaults.pause, lambda value: value >= 0, "a number from 0 on")
        return Limits(timeout, server, int(retries), pause)

    def _number(
        self, entry: Mapping[str, Any], field: str, default: float, holds: Callable[[float], bool], wanted: str
    ) -> float:
        value = entry.get(field, default)
        number = isinstance(value, (int, float)) and not isinstance(value, bool)
        if not number or not math.isfinite(value) or not holds(value):
            self.fault(field, f"must be {wanted}, not {value!r}")
            return default
        return float(value)

    def reasons(self, value: Any) -> Tuple[str, ...]:
        """Return the reasons for which a goal is sent again."""
        if not isinstance(value, (list, tuple)) or not all(isinstance(reason, str) for reason in value):
            self.fault("retry_on", f"must be a list of reasons like [failed, blocked], not {value!r}")
            return ()
        return tuple(value)

    def rules(self, value: Any) -> Tuple[Rule, ...]:
        """Return the rules that choose what is returned; what is no rule is left out."""
        if not isinstance(value, (list, tuple)):
            self.fault("returns", f"must be a list of rules, not {value!r}")
            return ()
        rules = [self._rule(entry, f"returns[{index}]") for index, entry in enumerate(value)]
        return tuple(rule for rule in rules if rule is not None)

    def _rule(self, entry: Any, place: str) -> Optional[Rule]:
        if not isinstance(entry, Mapping):
            self.fault(place, "must be a mapping with {}, not {!r}".format(", ".join(_RULE_FIELDS), entry))
            return None
        self.known_fields(entry, _RULE_FIELDS, place)
        status, when, facts = entry.get("status"), entry.get("when", {}), entry.get("facts", [])
        if status is not None and str(status) not in DEFAULT_RETURNS:
            self.fault(place, "no status {!r}; statuses are {}".format(status, ", ".join(DEFAULT_RETURNS)))
        if not isinstance(when, Mapping):
            self.fault(place, f"when must be a mapping of result fields to values, not {when!r}")
            when = {}
        if not isinstance(facts, (list, tuple)) or not all(isinstance(fact, str) for fact in facts):
            self.fault(place, f"facts must be a list of atoms as text, not {facts!r}")
            facts = []
        when = {str(field): wanted for field, wanted in when.items()}
        for field, wanted in when.items():
            self._pattern(pattern_of(wanted), f"{place}.when.{field}")
        returns = entry.get("return", DEFAULT_RETURNS.get(str(status), "failed"))
        self._check([returns, *facts], ANSWER_NAMES, place)
        return Rule(returns, status, self._pattern(entry.get("text"), place), when, tuple(facts))

    def _pattern(self, value: Any, place: str) -> Optional[Pattern[str]]:
        if value is None:
            return None
        try:
            return re.compile(str(value))
        except re.error as error:
            self.fault(place, f"text {value!r} is no regular expression: {error}")
            return None

    def _check(self, template: Any, names: Tuple[str, ...], place: str) -> None:
        if isinstance(template, Mapping):
            for key, value in template.items():
                self._check(value, names, f"{place}.{key}")
        elif isinstance(template, (list, tuple)):
            for index, value in enumerate(template):
                self._check(value, names, f"{place}[{index}]")
        else:
            self._check_text(template, names, place)

    def _check_text(self, template: Any, names: Tuple[str, ...], place: str) -> None:
        try:
            check(template, names, place)
        except TemplateError as error:
            self.fault("", str(error))
