"""Defects of a program, each with the stream that shows it."""

from typing import Any, Dict, FrozenSet, List, NamedTuple, Optional, Set, Tuple

from rosoclingo.checking.verifying.scope import DefectKind
from rosoclingo.checking.verifying.ways import Step
from rosoclingo.planning.explaining.questions import Stream
from rosoclingo.planning.explaining.why_not import WhyNot

_WORDS = {
    DefectKind.NO_ANSWER: "the program has no answer after this, {}: the core could only doubt what it was told",
    DefectKind.FORBIDDEN: "what must never be: {}",
    DefectKind.REPEATED: "{} goes out though it was done for the same goal, which was only sent again: its return "
    "said so, and nothing has happened that may have undone it",
    DefectKind.FAILURE_AS_SUCCESS: "a failure is taken for success: the program goes on after {} as if it had been "
    "done",
    DefectKind.NEVER_ENDED: "a goal is never ended, though all goes as planned: {}",
    DefectKind.PUT_OFF: "the plan is put off for ever: cycle follows on cycle without an action, with the goal {} open",
    DefectKind.MALFORMED: "the plan holds what is no action: {}",
}


class Defect(NamedTuple):
    """A defect, and the way on which it shows.

    Attributes:
        kind: its kind.
        way: the steps that lead there.
        subject: what it is about.
        cost: the number of events on the way.
        about: the interface that it is about, if any.
        circular: whether the way ends in a state that it has met before.
        broken: the update without an answer, and its history.
        why: which rules exclude an answer, if that is known.

    """

    kind: DefectKind
    way: Tuple[Step, ...]
    subject: str
    cost: int
    about: str = ""
    circular: bool = False
    broken: Optional[Stream] = None
    why: Optional[WhyNot] = None

    @property
    def length(self) -> int:
        """The number of updates on the way."""
        return sum(len(step.updates) for step in self.way)

    @property
    def words(self) -> str:
        """The defect in words."""
        return _WORDS[self.kind].format(self.subject)

    @property
    def stream(self) -> str:
        """The updates, as an online progression."""
        return "".join(update for step in self.way for update in step.updates)

    @property
    def story(self) -> List[str]:
        """The events and ends of goals in words."""
        found: List[str] = []
        updates = 0
        for step in self.way:
            place = f"before update {updates + 1}"
            found += [f"{place}: {one.kind} {one.text}" for one in step.move.happenings]
            found += [f"{place}: {one.action.atom} fails: {one.text}" for one in step.move.failures]
            updates += len(step.updates)
            found += [f"with update {updates}: {end}" for end in step.ends]
        return found

    def lines(self) -> List[str]:
        """Return the defect for people, with its stream."""
        found = [f"{self.kind.value}: {self.words}", *(f"  {one}" for one in self.story)]
        found += [f"  {one}" for one in self.why.text().splitlines()] if self.why is not None else []
        return [*found, "", *(f"% {one}" for one in (self.words, *self.story)), *self.stream.splitlines()]

    def to_message(self) -> Dict[str, Any]:
        """Return the defect as a value for JSON."""
        about = {"kind": self.kind.value, "words": self.words, "events": self.cost, "updates": self.length}
        return {**about, "story": self.story, "stream": self.stream}


class Defects:
    """The defects found, the one with the shortest way for each kind and interface; ``skipped`` kinds are left out."""

    def __init__(self, skipped: FrozenSet[DefectKind] = frozenset()) -> None:
        self._skipped = skipped
        self._found: Dict[Tuple[DefectKind, str], Defect] = {}
        self._usual: Set[str] = set()

    def add(self, defect: Defect) -> None:
        """Add a defect."""
        known = self._found.get((defect.kind, defect.about))
        better = known is None or (defect.cost, defect.length) < (known.cost, known.length)
        if better and defect.kind not in self._skipped:
            self._found[defect.kind, defect.about] = defect

    def excuse(self, interface: str) -> None:
        """Note that an interface repeats actions in runs without faults."""
        self._usual.add(interface)

    def of(self, cost: int) -> List[Defect]:
        """Return the defects of at most ``cost`` events, the shortest of each kind, in this order."""
        best: Dict[DefectKind, Defect] = {}
        for one in sorted(self._found.values(), key=lambda one: (one.cost, one.length, one.kind.value)):
            if one.cost <= cost and not (one.kind is DefectKind.REPEATED and one.about in self._usual):
                best.setdefault(one.kind, one)
        return list(best.values())
