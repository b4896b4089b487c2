"""What was found wrong with a program, and the stream that shows it."""

from typing import Any, Dict, FrozenSet, List, NamedTuple, Optional, Set, Tuple

from rosoclingo.checking.verifying.scope import Kind
from rosoclingo.checking.verifying.ways import Step
from rosoclingo.planning.explaining.questions import Stream

_WORDS = {
    Kind.NO_ANSWER: "the program has no answer after this, {}: the core could only doubt what it was told",
    Kind.FORBIDDEN: "what must never be: {}",
    Kind.REPEATED: "{} goes out though it was done for the same goal, which was only sent again: its return "
    "said so, and nothing has happened that may have undone it",
    Kind.FAILURE_AS_SUCCESS: "a failure is taken for success: the program goes on after {} as if it had been done",
    Kind.NEVER_ENDED: "a goal is never ended, though all goes as planned: {}",
    Kind.PUT_OFF: "the plan is put off for ever: cycle follows on cycle without an action, with the goal {} open",
    Kind.MALFORMED: "the plan holds what is no action: {}",
}


class Finding(NamedTuple):
    """Something wrong, and the way on which it shows.

    Attributes:
        kind: what it is.
        way: the steps that lead there.
        subject: what it is about.
        cost: the events on the way.
        about: the interface that it is about, where one is.
        circular: whether it goes on so for ever, as the way ends where it was before.
        broken: the update that has no answer, and its history.

    """

    kind: Kind
    way: Tuple[Step, ...]
    subject: str
    cost: int
    about: str = ""
    circular: bool = False
    broken: Optional[Stream] = None

    @property
    def length(self) -> int:
        """How many updates there are on the way."""
        return sum(len(step.updates) for step in self.way)

    @property
    def words(self) -> str:
        """What is wrong."""
        return _WORDS[self.kind].format(self.subject)

    @property
    def stream(self) -> str:
        """The updates, as an online progression."""
        return "".join(update for step in self.way for update in step.updates)

    @property
    def story(self) -> List[str]:
        """What happens, step by step, in words; what goes as planned is left out."""
        found: List[str] = []
        updates = 0
        for step in self.way:
            place = f"before update {updates + 1}"
            found += [f"{place}: {_told(one.kind, one.text)}" for one in step.move.happenings]
            found += [f"{place}: {one.action.atom} fails: {one.text}" for one in step.move.failures]
            updates += len(step.updates)
            found += [f"with update {updates}: {end}" for end in step.ends]
        return found

    def to_message(self) -> Dict[str, Any]:
        """Return it as a plain value that JSON knows."""
        told = {"kind": self.kind.value, "words": self.words, "events": self.cost, "updates": self.length}
        return {**told, "story": self.story, "stream": self.stream}


def _told(kind: str, text: str) -> str:
    return {"ask": f"goal {text}", "cancel": f"cancel of {text}", "tell": f"fact {text}"}[kind]


class Suspicion:
    """Keeps the shortest way for each kind of finding, but those that are ``skipped``."""

    def __init__(self, skipped: FrozenSet[Kind] = frozenset()) -> None:
        self._skipped = skipped
        self._found: Dict[Tuple[Kind, str], Finding] = {}
        self._usual: Set[str] = set()  # interfaces that do the same again where nothing has gone wrong

    def add(self, finding: Finding) -> None:
        """Note a finding."""
        if finding.kind in self._skipped:
            return
        key = finding.kind, finding.about
        known = self._found.get(key)
        if known is None or (finding.cost, finding.length) < (known.cost, known.length):
            self._found[key] = finding

    def add_repeated(self, finding: Finding, calm: bool) -> None:
        """Note an action that is done again; where all was calm, it is the way of that interface."""
        if calm:
            self._usual.add(finding.about)
        else:
            self.add(finding)

    def of(self, cost: int) -> List[Finding]:
        """Return the findings of at most so many events, the shortest of each kind, and of these the shortest first."""
        best: Dict[Kind, Finding] = {}
        for one in sorted(self._found.values(), key=lambda one: (one.cost, one.length, one.kind.value)):
            if one.cost <= cost and not (one.kind is Kind.REPEATED and one.about in self._usual):
                best.setdefault(one.kind, one)
        return list(best.values())
