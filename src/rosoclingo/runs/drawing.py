"""The program's drawings on the map: ``_draws(shut,blocked,"shut").`` among its facts.

The fact names a predicate, whose atoms are drawn: the shown atoms that hold now (the topic ``~state``), and the
facts in the program's texts. Arguments that are labels determine the place; the other arguments replace ``{}`` in the
text.
"""

from enum import Enum
from typing import AbstractSet, Dict, Iterable, List, NamedTuple, Optional, Sequence, Tuple

from clingo import Symbol, SymbolType

from rosoclingo.reasoning.keywords import NOW, name_of
from rosoclingo.runs.program_facts import facts_of
from rosoclingo.runs.recorded_run import RunProgram
from rosoclingo.runs.topic_atoms import atom_in

#: ``_draws(Predicate,Kind)`` and ``_draws(Predicate,Kind,Text)``.
DRAWS = "_draws"

_PLACE = "{}"


class DrawingKind(Enum):
    """The kinds of drawings, with their names in programs."""

    WAY = "way"  # a line between two labels
    OPEN = "open"  # a passable way
    BLOCKED = "blocked"  # a way with a bar across
    THING = "thing"  # a box at a label
    CARRIED = "carried"  # a box on the robot
    MARK = "mark"  # a text at a label
    ROBOT = "robot"  # the robot at a label, if there is no pose; its text is the name of one of several robots


#: The number of labels among the arguments of an atom.
LABELS = {
    DrawingKind.WAY: 2,
    DrawingKind.OPEN: 2,
    DrawingKind.BLOCKED: 2,
    DrawingKind.THING: 1,
    DrawingKind.CARRIED: 0,
    DrawingKind.MARK: 1,
    DrawingKind.ROBOT: 1,
}

#: Kinds whose default text is that of the other arguments, or the predicate.
_NAMED = (DrawingKind.THING, DrawingKind.CARRIED, DrawingKind.MARK, DrawingKind.ROBOT)


class Drawing(NamedTuple):
    """A drawing on the map: its kind, its labels and its text."""

    kind: DrawingKind
    labels: Tuple[str, ...]
    text: str


class Drawings:
    """The drawings of atoms; ``styles`` maps predicates to kind and text, ``facts`` are facts of the program.

    Facts of a predicate always hold, unless its atoms depend on the time: then they are its initial state.

    Attributes:
        faults: messages about invalid declarations.

    """

    def __init__(
        self,
        styles: Optional[Dict[str, Tuple[DrawingKind, str]]] = None,
        facts: Iterable[Symbol] = (),
        faults: Sequence[str] = (),
    ) -> None:
        self._styles = dict(styles or {})
        self._facts = list(facts)
        self.faults = tuple(faults)

    def of(self, atoms: Sequence[str], labels: AbstractSet[str]) -> List[Drawing]:
        """Return the drawings while ``atoms`` hold, each once, without atoms that cannot be drawn."""
        texts = [text for text in atoms if text.partition("(")[0] in self._styles]
        present = [atom for atom in map(atom_in, texts) if atom is not None]
        timed = {atom.name for atom in present if NOW in atom.arguments}
        self._facts = [fact for fact in self._facts if fact.name not in timed]
        drawn = [self._drawing(atom, labels) for atom in (*self._facts, *present)]
        return list(dict.fromkeys(one for one in drawn if one is not None))

    def _drawing(self, atom: Symbol, labels: AbstractSet[str]) -> Optional[Drawing]:
        kind, text = self._styles[atom.name]
        arguments = [one for one in atom.arguments if one != NOW]
        places = [str(one) for one in arguments if str(one) in labels]
        if len(places) < LABELS[kind]:
            return None
        words = " ".join(name_of(one) for one in arguments if str(one) not in labels)
        if text or kind not in _NAMED:
            text = text.replace(_PLACE, words)
        else:
            text = words or ("" if kind is DrawingKind.ROBOT else atom.name)
        return Drawing(kind, tuple(places[: LABELS[kind]]), text.strip())


def drawings_of(program: RunProgram) -> Drawings:
    """Return the drawings that a program's texts declare, with the faults of its declarations."""
    styles: Dict[str, Tuple[DrawingKind, str]] = {}
    faults = []
    for fact in facts_of(program, {DRAWS}):
        fault = drawing_fault(fact)
        if fault:
            faults.append(f"{fact} draws nothing: {fault}")
        else:
            name, kind, *text = fact.arguments
            styles[name_of(name)] = DrawingKind(str(kind)), text[0].string if text else ""
    return Drawings(styles, facts_of(program, set(styles)) if styles else (), faults)


def drawing_fault(fact: Symbol) -> str:
    """Return the fault of a declaration and how to fix it; empty for a valid declaration."""
    if len(fact.arguments) not in (2, 3):
        return f"write {DRAWS}(Predicate,Kind) or {DRAWS}(Predicate,Kind,Text)"
    kinds = [one.value for one in DrawingKind]
    if str(fact.arguments[1]) not in kinds:
        return f"{fact.arguments[1]} is not a kind: write one of {', '.join(kinds)}"
    if len(fact.arguments) == 3 and fact.arguments[2].type is not SymbolType.String:
        return f'the text has to be a string, write "{fact.arguments[2]}"'
    return ""
