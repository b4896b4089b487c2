"""Valid values of a robot's files and programs that are probably mistakes."""

import math
from typing import AbstractSet, Any, Iterable, Iterator, Mapping, Sequence

from clingo.ast import ASTType

from rosoclingo.checking.lint.actions import PlacedName
from rosoclingo.interfaces.answers import REASONS
from rosoclingo.interfaces.checking.yaml_places import YamlFile
from rosoclingo.interfaces.config import InterfaceSpec
from rosoclingo.interfaces.templates import texts_in
from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.program.likeness import likely_word
from rosoclingo.oclingo.program.parts import Occurrence
from rosoclingo.oclingo.program.survey import Survey, term_text
from rosoclingo.oclingo.progression.terms import Signature
from rosoclingo.runs.drawing import DRAWS, drawing_fault
from rosoclingo.runs.topic_atoms import atom_in

_SLASH = "/"
_FRAMES = ("frame_id", "child_frame_id")


# ---- labels ---------------------------------------------------------------------------------------------------------


def label_values(file: YamlFile) -> Iterator[Fault]:
    """Yield the frames with a leading slash, and the yaws that look like degrees."""
    for key, place in file.data.items() if isinstance(file.data, dict) else ():
        if isinstance(place, dict):
            yield from _slash(file, f"{key}.frame", place.get("frame"))
            yield from _degrees(file, f"{key}.yaw", place.get("yaw"))
        elif isinstance(place, list) and len(place) > 2:
            yield from _degrees(file, f"{key}[2]", place[2])


def frame_values(file: YamlFile, specs: Mapping[str, InterfaceSpec]) -> Iterator[Fault]:
    """Yield the frames with a leading slash in goals of interfaces."""
    for key, spec in specs.items():
        for path, text in texts_in(spec.goal):
            if path.rpartition(".")[2] in _FRAMES:
                yield from _slash(file, f"{key}.goal{path}", text)


def _slash(file: YamlFile, path: str, frame: Any) -> Iterator[Fault]:
    if isinstance(frame, str) and frame.startswith(_SLASH):
        bare = frame.lstrip(_SLASH)
        message = f"{path}: tf2 refuses a frame with a leading slash; goals are sent with {bare} (write {bare})"
        yield file.fault(message, "label-value")


def _degrees(file: YamlFile, path: str, yaw: Any) -> Iterator[Fault]:
    """Yield a fault if a yaw is more than a full turn."""
    if isinstance(yaw, (int, float)) and not isinstance(yaw, bool) and 2 * math.pi + 0.01 < abs(yaw) < math.inf:
        remedy = f"did you mean degrees? write {math.radians(yaw):.4g}"
        yield file.fault(f"{path}: {yaw:g} radians is more than a full turn ({remedy})", "label-value")


# ---- reasons --------------------------------------------------------------------------------------------------------


def reasons_of(specs: Iterable[InterfaceSpec]) -> AbstractSet[str]:
    """Return the values, as text, that these interfaces can return for any parameter of an action."""
    rules = [rule for one in specs for rule in one.rules]
    return {*REASONS} | {str(rule.returns) for rule in rules if "$" not in str(rule.returns)}


def labels_like_reasons(labels: Sequence[PlacedName], reasons: AbstractSet[str]) -> Iterator[Fault]:
    """Yield the labels that equal a failure reason."""
    for one in labels:
        if one.name in reasons:
            message = f"the label {one.name} has the name of a failure reason"
            remedy = f"rename it: _return(A,{one.name},C) would mean success and failure"
            yield one.fault("like-reason", message, remedy)


# ---- drawings -------------------------------------------------------------------------------------------------------


def idle_drawings(survey: Survey) -> Iterator[Fault]:
    """Yield the ``_draws`` facts that draw nothing."""
    shown = [one.term for _, one, _ in survey.statements if one.ast_type == ASTType.ShowTerm]
    functions = (one for one in shown if one.ast_type == ASTType.Function)
    names = {one.name for one in (*survey.known, *survey.silenced, *functions)}
    for arity in (2, 3):
        for place in survey.defining.get(Signature(DRAWS, arity), ()):
            yield from _idle_drawing(place, names)


def _idle_drawing(place: Occurrence, names: AbstractSet[str]) -> Iterator[Fault]:
    text = term_text(place.term)
    atom = None if getattr(place.statement, "body", ()) else atom_in(str(place.term))
    if atom is None:
        yield place.fault("idle-drawing", f"{text} draws nothing: {DRAWS} is read from ground facts", "write a fact")
        return
    fault, name = drawing_fault(atom), str(atom.arguments[0])
    if fault:
        yield place.fault("idle-drawing", f"{text} draws nothing", fault)
    elif name not in names:
        message = f"{text} draws nothing: there is no predicate {name}"
        yield place.fault("idle-drawing", message, likely_word(name, names) or "name a predicate of the program")
