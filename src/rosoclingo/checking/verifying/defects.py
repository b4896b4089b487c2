"""Defects of a program, each with the stream that shows it."""

from typing import Any, Dict, FrozenSet, List, NamedTuple, Optional, Set, Tuple

from rosoclingo.checking.verifying.scope import DefectKind
from rosoclingo.checking.verifying.state_graph import Step
from rosoclingo.planning.explaining.questions import Stream
from rosoclingo.planning.explaining.why_not import WhyNot

_WORDS = {
    DefectKind.NO_ANSWER: "the program has no answer after this, {}: the core could only withhold facts",
    DefectKind.FORBIDDEN: "a forbidden state occurs: {}",
    DefectKind.REPEATED: "{} is executed again when its goal is sent again, although it succeeded and nothing can have "
    "undone it",
    DefectKind.FAILURE_AS_SUCCESS: "a failure is treated as success: after {} the program continues as if the action "
    "had succeeded",
    DefectKind.NEVER_ENDED: "a goal never ends, although all actions succeed: {}",
    DefectKind.PUT_OFF: "the plan is deferred forever: cycles pass without an action while the goal {} is open",
    DefectKind.MALFORMED: "the plan contains an invalid action: {}",
}


class Defect(NamedTuple):
    """A defect, and the run that shows it.

    Attributes:
        kind: its kind.
        way: the steps of the run.
        subject: the goals, action or state concerned.
        cost: the number of events of the run.
        about: the interface concerned, if any.
        circular: whether the run returns to an earlier state.
        broken: the update without an answer, and its history.
        why: the rules that exclude an answer, if known.

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
        """The number of updates of the run."""
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
            found += [f"{place}: {one.kind} {one.term}" for one in step.move.arrivals]
            found += [f"{place}: {one.action.atom} fails: {one.text}" for one in step.move.failures]
            updates += len(step.updates)
            found += [f"with update {updates}: {end}" for end in step.ends]
        return found

    def lines(self) -> List[str]:
        """Return the defect as text lines, with its stream."""
        found = [f"{self.kind.value}: {self.words}", *(f"  {one}" for one in self.story)]
        found += [f"  {one}" for one in self.why.text().splitlines()] if self.why is not None else []
        return [*found, "", *(f"% {one}" for one in (self.words, *self.story)), *self.stream.splitlines()]

    def to_message(self) -> Dict[str, Any]:
        """Return the defect as a value for JSON."""
        about = {"kind": self.kind.value, "words": self.words, "events": self.cost, "updates": self.length}
        return {**about, "story": self.story, "stream": self.stream}


class Defects:
    """Collects the defect with the shortest run for each kind and interface; ``skipped`` kinds are ignored."""

    def __init__(self, skipped: FrozenSet[DefectKind]) -> None:
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
        """Ignore repeated actions of an interface, as they also occur in runs without failures."""
        self._usual.add(interface)

    def shortest(self, cost: int) -> List[Defect]:
        """Return the shortest defect of each kind with at most ``cost`` events, ordered by length."""
        best: Dict[DefectKind, Defect] = {}
        for one in sorted(self._found.values(), key=lambda one: (one.cost, one.length, one.kind.value)):
            if one.cost <= cost and not (one.kind is DefectKind.REPEATED and one.about in self._usual):
                best.setdefault(one.kind, one)
        return list(best.values())
