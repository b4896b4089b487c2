"""What a program wants to have drawn on the map: ``_draws(shut,blocked,"shut").`` among its facts.

The fact names a predicate. Its atoms are drawn: those that hold now, as far as the program shows them (the topic
``~state``), and its facts that stand in the program's texts. Where they are drawn follows from their arguments that are
labels; the other ones are put in place of ``{}`` in the text.
"""

from enum import Enum
from typing import AbstractSet, Dict, Iterable, List, NamedTuple, Optional, Sequence, Tuple

from clingo import Symbol, SymbolType

from rosoclingo.reasoning.keywords import NOW, name_of
from rosoclingo.runs.program_facts import facts_of
from rosoclingo.runs.recorded_run import RunProgram
from rosoclingo.runs.topic_atoms import atom_in

__all__ = ["DRAWS", "Drawing", "DrawingKind", "Drawings", "drawing_fault", "drawings_of"]

#: ``_draws(Predicate,Kind)`` and ``_draws(Predicate,Kind,Text)``.
DRAWS = "_draws"

_PLACE = "{}"


class DrawingKind(Enum):
    """How an atom is drawn; the name is the one in programs."""

    WAY = "way"  # a line between two labels
    OPEN = "open"  # the same, which can be gone
    BLOCKED = "blocked"  # the same, with a bar across
    THING = "thing"  # a box at a label
    CARRIED = "carried"  # a box on the robot
    MARK = "mark"  # words at a label
    ROBOT = "robot"  # the robot at a label, where nobody else knows where it is


#: How many labels an atom has to have for it.
LABELS = {
    DrawingKind.WAY: 2,
    DrawingKind.OPEN: 2,
    DrawingKind.BLOCKED: 2,
    DrawingKind.THING: 1,
    DrawingKind.CARRIED: 0,
    DrawingKind.MARK: 1,
    DrawingKind.ROBOT: 1,
}

#: Kinds that are nothing without words: the other arguments, or the predicate where there is none.
_NAMED = (DrawingKind.THING, DrawingKind.CARRIED, DrawingKind.MARK)


class Drawing(NamedTuple):
    """Something on the map: its kind, the labels at which it is, and words."""

    kind: DrawingKind
    labels: Tuple[str, ...]
    text: str


class Drawings:
    """The drawings of atoms; ``styles`` are kind and text by predicate, ``facts`` atoms that always hold.

    Attributes:
        faults: declarations that cannot be used, with the mend.

    """

    def __init__(
        self,
        styles: Optional[Dict[str, Tuple[DrawingKind, str]]] = None,
        facts: Iterable[Symbol] = (),
        faults: Sequence[str] = (),
    ) -> None:
        self._styles = dict(styles or {})
        self._facts = [str(one) for one in facts]
        self.faults = tuple(faults)

    def of(self, atoms: Sequence[str], labels: AbstractSet[str]) -> List[Drawing]:
        """Return the drawings while ``atoms`` hold, each once; atoms that cannot be drawn are left out."""
        texts = [text for text in (*self._facts, *atoms) if text.partition("(")[0] in self._styles]
        drawn = [self._drawing(atom, labels) for atom in map(atom_in, texts) if atom is not None]
        return list(dict.fromkeys(one for one in drawn if one is not None))

    def _drawing(self, atom: Symbol, labels: AbstractSet[str]) -> Optional[Drawing]:
        kind, text = self._styles[atom.name]
        arguments = [one for one in atom.arguments if one != NOW]
        places = [str(one) for one in arguments if str(one) in labels]
        if len(places) < LABELS[kind]:
            return None
        words = " ".join(name_of(one) for one in arguments if str(one) not in labels)
        text = text.replace(_PLACE, words) if text or kind not in _NAMED else words or atom.name
        return Drawing(kind, tuple(places[: LABELS[kind]]), text.strip())


def drawings_of(program: RunProgram) -> Drawings:
    """Return what a program's texts want to have drawn; what cannot be is among the faults."""
    styles: Dict[str, Tuple[DrawingKind, str]] = {}
    faults = []
    for fact in facts_of(program, {DRAWS}):
        fault = drawing_fault(fact)
        if fault:
            faults.append(f"{fact} has nothing drawn: {fault}")
        else:
            name, kind, *text = fact.arguments
            styles[name_of(name)] = DrawingKind(str(kind)), text[0].string if text else ""
    return Drawings(styles, facts_of(program, set(styles)) if styles else (), faults)


def drawing_fault(fact: Symbol) -> str:
    """Return what is wrong with a declaration, and the mend; empty where nothing is."""
    if len(fact.arguments) not in (2, 3):
        return f"write {DRAWS}(Predicate,Kind) or {DRAWS}(Predicate,Kind,Text)"
    kinds = [one.value for one in DrawingKind]
    if str(fact.arguments[1]) not in kinds:
        return f"{fact.arguments[1]} is no kind, write one of {', '.join(kinds)}"
    if len(fact.arguments) == 3 and fact.arguments[2].type is not SymbolType.String:
        return f'the text is a string, write "{fact.arguments[2]}"'
    return ""
