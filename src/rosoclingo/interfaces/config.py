"""Read and check the interface entries of config/interfaces.yaml.

doc/interfaces.md describes the format. A name with variables, arguments that begin with a capital, stands for several
entries, one for each value. Texts of the entry contain the value as ``{R}``::

    move_base(R): {server: "/{R}/move_base", type: move_base_msgs/MoveBaseAction, goal: {target_pose: $parameter.pose}}
"""

import itertools
import re
import warnings
from typing import Any, Dict, Iterator, List, Mapping, NamedTuple, Optional, Pattern, Sequence, Tuple

from rosoclingo.common.reading import MISSING, Reader
from rosoclingo.interfaces.answers import DEFAULT_RETURNS, SUCCEEDED, Rule, fact_fault, pattern_of
from rosoclingo.interfaces.attempt import DEFAULT_LIMITS, ActionLimits
from rosoclingo.interfaces.templates import ANSWER_NAMES, GOAL_NAMES, faults
from rosoclingo.interfaces.values import TermError, read_term

DEFAULT_RETRY_ON = ("failed", "blocked", "server_lost")

_MESSAGE_TYPE = re.compile(r"[A-Za-z][A-Za-z0-9_]*/[A-Za-z][A-Za-z0-9_]*\Z")
_ACTION_TYPE = re.compile(r"[A-Za-z][A-Za-z0-9_]*/[A-Za-z][A-Za-z0-9_]*Action\Z")
_VARIABLE = re.compile(r"(?<=[(,])[A-Z][A-Za-z0-9_]*(?=[),])")
_IN_TEXT = re.compile(r"\{([A-Z][A-Za-z0-9_]*)\}")
_ROS_NAME = re.compile(r"[~/A-Za-z][A-Za-z0-9_/]*\Z")
_CONSTANT = re.compile(r"[a-z][A-Za-z0-9_]*\Z")

Values = Mapping[str, Sequence[str]]
"""The values of variables in the names of entries: ``{"R": ["r1", "r2"]}``."""


class ConfigError(ValueError):
    """An invalid configuration; the message lists each fault with its place and how to fix it."""


class DoneCondition(NamedTuple):
    """A message that shows that an action was done: its topic, type, and values (or templates) of its fields."""

    topic: str
    type: str
    when: Mapping[str, Any] = {}


class InterfaceSpec(NamedTuple):
    """The description of one interface: its actionlib action, goal templates and answer rules.

    ``key`` is the entry's name in the file, which can have variables; so can ``name`` if their values are unknown.
    """

    key: str
    name: str
    type: str
    server: str
    goal: Mapping[str, Any] = {}
    rules: Tuple[Rule, ...] = ()
    limits: ActionLimits = DEFAULT_LIMITS
    retry_on: Tuple[str, ...] = DEFAULT_RETRY_ON
    repeatable: bool = False
    done: Optional[DoneCondition] = None

    def instance(self, action: str) -> "Optional[InterfaceSpec]":
        """Return the interface of this entry for an action, None for an action with another name."""
        if action == self.name:
            return self
        pieces = [re.escape(one) for one in _VARIABLE.split(self.name)]
        return self._replace(name=action) if pieces[1:] and re.fullmatch("[^,]+".join(pieces), action) else None


def survey(reader: Reader, values: Optional[Values] = None) -> Dict[str, InterfaceSpec]:
    """Return all entries by name, with defaults in place of invalid values; the reader collects the faults.

    Without ``values``, an entry whose name has variables stays one entry.
    """
    entries = reader.entries("a mapping of interface names to their settings")
    if reader.value == {}:
        reader.fault("has no entries; write one for each action, like move_base: {type: move_base_msgs/MoveBaseAction}")
    instances = (one for name, entry in entries for one in _instances(name, entry, values))
    specs: Dict[str, InterfaceSpec] = {}
    for key, name, entry in instances:
        if name in specs:
            entry.fault(f"{name} has another entry, {specs[name].key}; remove one of them")
        specs[name] = _spec(key, name, entry)
    reader.faults[:] = dict.fromkeys(reader.faults)
    return specs


def read_values(reader: Reader) -> Values:
    """Return the values of variables in names of entries, from ``{R: [r1, r2]}``; the reader collects the faults."""
    entries = reader.entries("a mapping of variables to values such as {R: [r1, r2]}", {})
    values = {name: one.texts(wanted="a list of values such as [r1, r2]", some=True) for name, one in entries}
    for name, some in values.items():
        if not _VARIABLE.search(f"({name})"):
            reader.fault(f"{name} is not a variable: begin it with a capital, such as R in move_base(R)")
        for value in some:
            if not _CONSTANT.match(value):
                reader.fault(f"{value!r} for {name} is not a constant: write one such as r1")
    return values


def _instances(key: str, entry: Reader, values: Optional[Values]) -> Iterator[Tuple[str, str, Reader]]:
    """Yield the key, the name and the settings of an entry for each combination of ``values`` of its variables."""
    names = list(dict.fromkeys(_VARIABLE.findall(key)))
    _check_variables(entry, names)
    missing = [name for name in names if values is not None and name not in values]
    for name in missing:
        entry.fault(f"there are no values for {name}; set ~values, such as {{{name}: [r1, r2]}}")
    if values is None or missing:
        yield key, key, entry
        return
    for some in itertools.product(*(values[name] for name in names)):
        given = dict(zip(names, some))
        yield key, _named(key, given), entry.holding(_filled(entry.value, given))


def _named(key: str, given: Mapping[str, str]) -> str:
    return _VARIABLE.sub(lambda match: given[match.group()], key)


def _check_variables(entry: Reader, names: List[str]) -> None:
    """Report variables of server and topic that the name lacks."""
    inside = entry.holding(entry.value)
    for reader in (inside.at("server"), inside.at("done").at("topic")):
        for name in _IN_TEXT.findall(reader.value) if isinstance(reader.value, str) else ():
            if name not in names:
                fix = f"its variables are {', '.join(names)}" if names else "write a name such as move_base(R)"
                reader.fault(f"{{{name}}} is not a variable of the entry's name ({fix})")


def _filled(value: Any, given: Mapping[str, str]) -> Any:
    """Return a value with the variables in its texts replaced."""
    if isinstance(value, Mapping):
        return {key: _filled(inside, given) for key, inside in value.items()}
    if isinstance(value, list):
        return [_filled(inside, given) for inside in value]
    if isinstance(value, str):
        return _IN_TEXT.sub(lambda match: given.get(match.group(1), match.group()), value)
    return value


def _spec(key: str, name: str, entry: Reader) -> InterfaceSpec:
    spec = InterfaceSpec(
        key=key,
        name=_term(name, entry),
        type=_type(entry.at("type"), "an action type like move_base_msgs/MoveBaseAction", _ACTION_TYPE),
        server=ros_name(entry.at("server"), "an actionlib server", name if _ROS_NAME.match(name) else MISSING),
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
        term = str(read_term(_VARIABLE.sub("v", name)))
        return name if _VARIABLE.search(name) else term
    except TermError:
        entry.fault("the name must be the ASP term that the program uses, like gripper or arm(left)")
        return name


def ros_name(reader: Reader, what: str, default: Any = MISSING) -> str:
    """Return a name of ``what`` in ROS; ``{R}`` in it stands for a value."""

    def fit(value: Any) -> Optional[str]:
        return value if isinstance(value, str) and _ROS_NAME.match(_IN_TEXT.sub("v", value)) else None

    return reader.read(f"the name of {what}, of letters, digits, _ and /", fit, default, "")


def _done(reader: Reader) -> Optional[DoneCondition]:
    if not reader.given:
        return None
    topic, kind, when = (reader.at(key) for key in ("topic", "type", "when"))
    done = DoneCondition(
        topic=ros_name(topic, "a topic"),
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
