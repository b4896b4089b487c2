"""Templates: fill fields of a goal and terms of an answer from an action and its end.  No ROS.

doc/interfaces.md lists the references. A text that is a single reference stands for the value itself; other texts can
contain references in braces. Where the text is an ASP term or atom (`fill_term`), a reference in braces stands for one
term.  Within double quotes it stands for any characters of an ASP string: `heard("${text}",now)`.
"""

import re
from typing import Any, Callable, Iterator, List, Mapping, NamedTuple, Tuple

from clingo import Symbol, SymbolType

from rosoclingo.common.labels import Label, LabelTable
from rosoclingo.common.reading import likely
from rosoclingo.interfaces.values import TermError, as_string, as_text, read_term
from rosoclingo.reasoning.keywords import shortened

LABEL_FIELDS = ("pose", "x", "y", "yaw", "frame")
GOAL_NAMES = ("parameter", "cycle", "now")
ANSWER_NAMES = (*GOAL_NAMES, "status", "text", "result")

_WHOLE = re.compile(r"\$(?:\{([A-Za-z0-9_.]+)\}|([A-Za-z0-9_.]+))\Z")
_INSIDE = re.compile(r"\$\$|\$\{([^}]*)\}|\$")
_IN_TERM = re.compile(r"\$\$|\$\{([^}]*)\}|\\.|\"", re.DOTALL)
_NAME_BEFORE, _NAME_BEHIND = re.compile(r"[A-Za-z0-9_'}]\Z"), re.compile(r"[A-Za-z0-9_'($]")
_PART_OF_NAME = re.compile(r"[A-Za-z0-9_']+\Z")


class FillError(ValueError):
    """A template that cannot be filled for an action, for example because its parameter has too few arguments."""


class Now:
    """A placeholder for the time at which the message is built."""


class GoalEnd(NamedTuple):
    """The end of a goal: actionlib's terminal status in lower case, the server's status text, the result message."""

    status: str
    text: str = ""
    result: Any = None


class ActionScope(NamedTuple):
    """The values for the references of a template."""

    parameter: Symbol
    cycle: int
    labels: LabelTable = LabelTable()
    ended: GoalEnd = GoalEnd("aborted")


def evaluate(template: Any, scope: ActionScope) -> Any:
    """Return the value of a template, with lists and mappings filled.  Raises FillError, UnknownLabelError."""
    if isinstance(template, Mapping):
        return {key: evaluate(value, scope) for key, value in template.items()}
    if isinstance(template, (list, tuple)):
        return [evaluate(value, scope) for value in template]
    if not isinstance(template, str):
        return template
    whole = _WHOLE.match(template)
    if whole:
        return _lookup(whole.group(1) or whole.group(2), scope)
    return _INSIDE.sub(
        lambda match: "$" if match.group(0) == "$$" else _inner_text(_lookup(match.group(1), scope)), template
    )


def is_reference(template: Any) -> bool:
    """Return whether a template is a single reference, which stands for the value itself."""
    return isinstance(template, str) and _WHOLE.match(template) is not None


def fill_term(template: str, scope: ActionScope) -> str:
    """Return the text of an ASP term or atom with its references filled.  Raises FillError, UnknownLabelError.

    A reference outside quotes has to be one term, or, next to the characters of a name, a part of that name.
    """
    return _written(template, lambda reference: _lookup(reference, scope))


def term_with(template: str, placeholder: Symbol) -> str:
    """Return the text of an ASP term or atom with ``placeholder`` in place of each reference."""
    return _written(template, lambda reference: placeholder)


def texts_in(template: Any, place: str = "") -> Iterator[Tuple[str, str]]:
    """Yield all texts of a template, at any depth, each with its place."""
    if isinstance(template, Mapping):
        for key, value in template.items():
            yield from texts_in(value, f"{place}.{key}")
    elif isinstance(template, (list, tuple)):
        for index, value in enumerate(template):
            yield from texts_in(value, f"{place}[{index}]")
    elif isinstance(template, str):
        yield place, template


def faults(template: Any, names: Tuple[str, ...] = GOAL_NAMES, place: str = "") -> List[str]:
    """Return the faults of a template's references, which are malformed or not in `names`, each with its place."""
    found = []
    for where, text in texts_in(template, place):
        wrong = [fault for fault in (_reference_fault(one, names) for one in references(text)) if fault]
        if not is_reference(text) and any(match.group(0) == "$" for match in _INSIDE.finditer(text)):
            wrong.insert(0, f"{text!r}: write $name alone, ${{name}} inside a text, $$ for a dollar sign")
        found += [f"{where}: {fault}" for fault in wrong[:1]]
    return found


def references(template: str) -> List[str]:
    """Return the references in a text, without dollar and braces."""
    whole = _WHOLE.match(template)
    if whole:
        return [whole.group(1) or whole.group(2)]
    return [match.group(1) for match in _INSIDE.finditer(template) if match.group(1) is not None]


def label_references(template: Any) -> List[str]:
    """Return references, as templates, to the terms that a template uses as labels."""
    steps = [reference.split(".") for _, text in texts_in(template) for reference in references(text)]
    return ["$" + ".".join(one[:-1]) for one in steps if one[1:] and one[-1] in LABEL_FIELDS and one[0] != "result"]


def _reference_fault(reference: str, names: Tuple[str, ...]) -> str:
    """Return the fault of a reference that no action can fill, empty for a valid reference."""
    head, _, tail = reference.partition(".")
    if not head.isdigit() and head not in names:
        near = likely(head, names, "$")
        known = ", ".join("$" + name for name in names)
        return f"no ${reference}{near}; known are {known}, $1, $2 ..."
    if head in ("cycle", "now", "status", "text") and tail:
        return f"${head} has no .{tail}"
    if head.isdigit() or head == "parameter":
        steps = tail.split(".") if tail else []
        wrong = [step for step in steps[:-1] if not step.isdigit()]
        wrong += [step for step in steps[-1:] if not step.isdigit() and step not in LABEL_FIELDS]
        if wrong or head == "0" or "0" in steps:
            fields = ", ".join(LABEL_FIELDS)
            return f"${reference}: after a term, write argument numbers of at least 1 and then one of {fields}"
    return ""


def _written(template: str, value_of: Callable[[str], Any]) -> str:
    pieces: List[str] = []
    end, quoted = 0, False
    for match in _IN_TERM.finditer(template):
        pieces.append(template[end : match.start()])
        end = match.end()
        token, reference = match.group(0), match.group(1)
        quoted ^= token == '"'
        if reference is None:
            pieces.append("$" if token == "$$" else token)
        elif quoted:
            pieces.append(str(as_string(_inner_text(value_of(reference))))[1:-1])
        else:
            joined = bool(_NAME_BEFORE.search(template[: match.start()]) or _NAME_BEHIND.match(template[end:]))
            pieces.append(_one_term(reference, value_of(reference), joined))
    return "".join([*pieces, template[end:]])


def _one_term(reference: str, value: Any, joined: bool) -> str:
    """Return the text of a value outside quotes.  Raises FillError if it is not a single term."""
    text = str(value) if isinstance(value, Symbol) and not joined else _inner_text(value)
    if joined and not _PART_OF_NAME.match(text):
        raise FillError(f"${{{reference}}} is {shortened(text)!r}, which is not part of a name")
    try:
        if isinstance(value, float):
            raise TermError("ASP has no fractions")
        return text if joined or isinstance(value, Symbol) else str(read_term(text))
    except TermError:
        fix = f'write "${{{reference}}}", within quotes, for an ASP string'
        raise FillError(f"${{{reference}}} is {shortened(text)!r}, which is not a term: {fix}") from None


def _inner_text(value: Any) -> str:
    if isinstance(value, (Label, Now)):
        raise FillError("a pose or time cannot stand inside a text")
    return as_text(value)


def _lookup(reference: str, scope: ActionScope) -> Any:
    head, *steps = reference.split(".")
    if head.isdigit():
        return _walk_term(_argument(scope.parameter, int(head), top=True), steps, scope)
    if head == "parameter":
        return _walk_term(scope.parameter, steps, scope)
    if head == "result":
        return _walk_result(steps, scope)
    values = {"cycle": scope.cycle, "now": Now(), "status": scope.ended.status, "text": scope.ended.text}
    if head not in values:
        raise FillError(f"no ${reference}")
    return values[head]


def _walk_term(term: Symbol, steps: List[str], scope: ActionScope) -> Any:
    for step in steps:
        if not step.isdigit():
            label = scope.labels[term]
            return label if step == "pose" else getattr(label, step)
        term = _argument(term, int(step))
    return term


def _argument(term: Symbol, number: int, top: bool = False) -> Symbol:
    arguments = term.arguments if term.type == SymbolType.Function else []
    if top and not arguments and number == 1:
        return term
    if number > len(arguments):
        raise FillError(f"{term} has no argument {number}")
    return arguments[number - 1]


def _walk_result(steps: List[str], scope: ActionScope) -> Any:
    value: Any = scope.ended.result
    for step in steps:
        try:
            value = value[int(step)] if step.isdigit() else getattr(value, step)
        except (AttributeError, IndexError, TypeError):
            raise FillError("the result has no {}".format(".".join(steps))) from None
    return value
