"""Places of the robot and of things from the program's beliefs, the topic ``~state``.

``_draws(Predicate,robot)``, ``thing`` and ``carried`` declare these atoms. Without such a declaration, atoms with
common names count: ``at(Place)`` and ``robot_at(Place)`` for the robot, ``at(Thing,Place)`` and
``thing_at(Thing,Place)`` for things, ``carries(Thing)``, ``carried(Thing)`` and ``holding(Thing)`` for things on the
robot.
"""

from typing import AbstractSet, Dict, Iterator, List, Mapping, NamedTuple, Sequence, Tuple

from clingo import Symbol

from rosoclingo.reasoning.keywords import NOW, name_of
from rosoclingo.runs.drawing import DrawingKind, Drawings
from rosoclingo.runs.topic_atoms import atom_in

#: The place of a thing on the robot, instead of a label.
CARRIED = "carried"

_ROBOTS, _THINGS, _CARRYING = ("at", "robot_at"), ("at", "thing_at"), ("carries", "carried", "holding")

#: The robot's name if it is an argument like a thing.
_ROBOT = "robot"


class Places(NamedTuple):
    """The robot's place, empty if it is unknown, the places of things (a label or CARRIED), and of several robots.

    A thing on one of several robots has the name of the robot as its place.
    """

    robot: str
    things: Dict[str, str]
    robots: Mapping[str, str] = {}


def believed_places(atoms: Sequence[str], drawings: Drawings, labels: AbstractSet[str]) -> Places:
    """Return the places of robot and things while ``atoms`` hold."""
    drawn = drawings.of(atoms, labels)
    robots = [one.labels[0] for one in drawn if one.kind is DrawingKind.ROBOT]
    names = {one.text: one.labels[0] for one in drawn if one.kind is DrawingKind.ROBOT and one.text}
    things = {one.text: one.labels[0] for one in drawn if one.kind is DrawingKind.THING}
    for one in drawn:
        if one.kind is DrawingKind.CARRIED:
            robot, _, thing = one.text.partition(" ")
            things.update({thing: robot} if robot in names and thing else {one.text: CARRIED})
    common = list(_common(atoms, labels))
    robots = robots or [place for thing, place in common if thing == _ROBOT]
    others = {thing: place for thing, place in common if thing != _ROBOT}
    return Places(robots[0] if robots and not names else "", things or others, names)


def _common(atoms: Sequence[str], labels: AbstractSet[str]) -> Iterator[Tuple[str, str]]:
    """Yield a thing, or the robot, and its place for each atom with a common name."""
    names = {*_ROBOTS, *_THINGS, *_CARRYING}
    found = (atom_in(text) for text in atoms if text.partition("(")[0] in names)
    for atom in (one for one in found if one is not None):
        words = _words(atom)
        if len(words) == 1 and atom.name in _ROBOTS:
            yield _ROBOT, words[0]
        elif len(words) == 1 and atom.name in _CARRYING:
            yield words[0], CARRIED
        elif len(words) == 2 and atom.name in (*_ROBOTS, *_THINGS):
            thing, place = words if words[1] in labels or words[0] not in labels else reversed(words)
            yield _ROBOT if atom.name == "robot_at" else thing, place


def _words(atom: Symbol) -> List[str]:
    return [name_of(one) for one in atom.arguments if one != NOW]
