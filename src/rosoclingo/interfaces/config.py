"""Read and check the interface entries of config/interfaces.yaml.

An entry with all fields::

    move_base:                           # the first argument of _action_lib(move_base,P,C)
      server: move_base                  # name of the actionlib server; default: the interface's name
      type: move_base_msgs/MoveBaseAction
      goal: {target_pose: $parameter.pose}    # fields of the goal; see templates.py
      timeout: 120.0                     # seconds of ROS time for one goal, 0 for no limit
      server_timeout: 5.0                # seconds until a silent server counts as lost
      pause: 3.0                         # seconds to wait after another client has preempted the goal
      retries: 0                         # how often a failed goal is sent again ...
      retry_on: [failed]                 # ... for these reasons only
      repeatable: false                  # whether repeating the action does no harm
      done:                              # the message on a topic that shows that the action was done
        {topic: packages, type: rosoclingo/PackageStates, when: {packages: {id: $parameter, carried: true}}}
      returns:                           # the first matching rule applies; default: the parameter, or a reason
        - {status: aborted, text: "(?i)no path", return: blocked, facts: ["blocked(${parameter},${cycle})"]}
        - {status: aborted, when: {outcome: 3}, return: not_here}
        - {status: aborted, when: {outcome: 4}, success: true}  # counts as done: the parameter is returned
"""

import re
import warnings
from typing import Any, Dict, Mapping, NamedTuple, Optional, Pattern, Tuple

from rosoclingo.common.reading import MISSING, Reader
from rosoclingo.interfaces.action_runs import DEFAULT_LIMITS, ActionLimits
from rosoclingo.interfaces.answers import DEFAULT_RETURNS, SUCCEEDED, Rule, fact_fault, pattern_of
from rosoclingo.interfaces.templates import ANSWER_NAMES, GOAL_NAMES, faults
from rosoclingo.interfaces.values import TermError, read_term

DEFAULT_RETRY_ON = ("failed", "blocked", "server_lost")

_MESSAGE_TYPE = re.compile(r"[A-Za-z][A-Za-z0-9_]*/[A-Za-z][A-Za-z0-9_]*\Z")
_ACTION_TYPE = re.compile(r"[A-Za-z][A-Za-z0-9_]*/[A-Za-z][A-Za-z0-9_]*Action\Z")


class ConfigError(ValueError):
    """An invalid configuration; the message lists each fault with its place and how to fix it."""


class DoneCondition(NamedTuple):
    """A message that shows that an action was done: its topic, type, and values (or templates) of its fields."""

    topic: str
    type: str
    when: Mapping[str, Any] = {}


class InterfaceSpec(NamedTuple):
    """The description of one interface: its actionlib action, goal templates and answer rules."""

    name: str
    type: str
    server: str
    goal: Mapping[str, Any] = {}
    rules: Tuple[Rule, ...] = ()
    limits: ActionLimits = DEFAULT_LIMITS
    retry_on: Tuple[str, ...] = DEFAULT_RETRY_ON
    repeatable: bool = False
    done: Optional[DoneCondition] = None


def survey(reader: Reader) -> Dict[str, InterfaceSpec]:
    """Return all entries by name, with defaults in place of invalid values; the reader collects the faults."""
    entries = reader.entries("a mapping of interface names to their settings")
    if reader.value == {}:
        reader.fault("has no entries; write one for each action, like move_base: {type: move_base_msgs/MoveBaseAction}")
    return {name: _spec(name, entry) for name, entry in entries}


def _spec(name: str, entry: Reader) -> InterfaceSpec:
    spec = InterfaceSpec(
        name=_term(name, entry),
        type=_type(entry.at("type"), "an action type like move_base_msgs/MoveBaseAction", _ACTION_TYPE),
        server=entry.at("server").text(name, wanted="the name of an actionlib server"),
        goal=_templates(entry.at("goal"), "a mapping of the goal's fields", {}),
        limits=read_limits(entry),
        retry_on=entry.at("retry_on").texts(DEFAULT_RETRY_ON, "a list of reasons like [failed, blocked]"),
        repeatable=entry.at("repeatable").flag(False),
        done=_done(entry.at("done")),
        rules=tuple(_rule(rule) for rule in entry.at("returns").items("a list of rules")),
    )
    entry.close()
    return spec


def _term(name: str, entry: Reader) -> str:
    try:
        return str(read_term(name))
    except TermError:
        entry.fault("the name must be the ASP term that the program uses, like gripper or arm(left)")
        return name


def _done(reader: Reader) -> Optional[DoneCondition]:
    if not reader.given:
        return None
    topic, kind, when = (reader.at(key) for key in ("topic", "type", "when"))
    done = DoneCondition(
        topic=topic.text(wanted="the name of a topic"),
        type=_type(kind, "a message type like rosoclingo/PackageStates", _MESSAGE_TYPE),
        when=_templates(when, "a mapping of the message's fields to values"),
    )
    if when.value == {}:
        when.fault("names no field, so any message would match; add a field and its value")
    reader.close()
    return done


def _type(reader: Reader, wanted: str, pattern: Pattern[str]) -> str:
    return reader.read(wanted, lambda text: text if isinstance(text, str) and pattern.match(text) else None, empty="")


def _templates(reader: Reader, wanted: str, default: Any = MISSING) -> Mapping[str, Any]:
    found = reader.mapping(wanted, default)
    reader.faults += faults(found, GOAL_NAMES, reader.named)
    return found


def read_limits(reader: Reader, defaults: ActionLimits = DEFAULT_LIMITS) -> ActionLimits:
    """Return time-outs and pause (s), and retries; missing values are those of ``defaults``."""
    return ActionLimits(
        reader.at("timeout").number(defaults.timeout, low=0.0),
        reader.at("server_timeout").number(defaults.server_timeout, above=0.0),
        reader.at("retries").whole(defaults.retries, low=0),
        reader.at("pause").number(defaults.pause, low=0.0),
    )


def _rule(reader: Reader) -> Rule:
    status, text, when, returns, facts = (reader.at(key) for key in ("status", "text", "when", "return", "facts"))
    named = status.choice(DEFAULT_RETURNS) if status.given else None
    wanted = {str(field): value for field, value in when.mapping("a mapping of result fields to values", {}).items()}
    for field, value in wanted.items():
        _pattern(pattern_of(value), when.at(field))
    success = reader.at("success").flag(False)
    if success and returns.given:
        returns.fault("has to be omitted with `success: true`: the action counts as done and returns its parameter")
    default = DEFAULT_RETURNS[SUCCEEDED] if success else DEFAULT_RETURNS.get(str(named), "failed")
    result = returns.value if returns.given else default
    texts = facts.texts((), "a list of atoms as text")
    wrong = faults(result, ANSWER_NAMES, returns.named) + faults(texts, ANSWER_NAMES, facts.named)
    broken = [(index, fact_fault(fact)) for index, fact in enumerate(texts)]
    reader.faults += wrong or [f"{facts.named}[{index}]: {fault}" for index, fault in broken if fault]
    rule = Rule(result, named, _pattern(text.value if text.given else None, text), wanted, texts, success)
    reader.close()
    return rule


def _pattern(value: Any, reader: Reader) -> Optional[Pattern[str]]:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", FutureWarning)
            return None if value is None else re.compile(str(value))
    except re.error as error:
        reader.fault(f"{value!r} is not a regular expression: {error}")
    except FutureWarning as warning:
        fix = "put a backslash before the character"
        reader.fault(f"later versions of Python read the regular expression {value!r} differently, {fix}: {warning}")
    return None
