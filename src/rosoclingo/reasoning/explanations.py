"""Reasons in words: why a goal is given up, by ``_explain(What,Text,C)``, and a fact refused, by ``_refuse/3``."""

from functools import lru_cache
from typing import Callable, Dict, FrozenSet, Iterable, Iterator, List, NamedTuple, Optional, Sequence, Tuple, TypeVar

from clingo import Symbol, SymbolType

from rosoclingo.planning.explaining.questions import Stream
from rosoclingo.reasoning.goals import Goal
from rosoclingo.reasoning.input_feeder import requests_of
from rosoclingo.reasoning.keywords import EXPLAIN, REFUSE, is_keyword, name_of
from rosoclingo.reasoning.observations import Observation


def text_of(term: Symbol) -> str:
    """A term as text: the content of a string, the pieces of a tuple joined, else the term as it is written."""
    if term.type is SymbolType.Function and not term.name:
        return "".join(text_of(piece) for piece in term.arguments)
    return name_of(term)


class Explanations:
    """All explanations of an answer; ``faults`` holds what was none."""

    def __init__(self, answer: FrozenSet[Symbol] = frozenset()) -> None:
        self.faults: List[str] = []
        self._texts: Dict[Symbol, Tuple[int, str]] = {}
        for atom in sorted(atom for atom in answer if is_keyword(atom, EXPLAIN)):
            self._enter(atom)

    def of(self, what: Symbol) -> Optional[str]:
        """What is said of a goal, by its identifier, or of an observation; of several the one of the latest cycle."""
        return self._texts[what][1] if what in self._texts else None

    def _enter(self, atom: Symbol) -> None:
        if len(atom.arguments) != 3 or atom.arguments[2].type is not SymbolType.Number:
            self.faults.append(f"'{atom}' is no explanation: write _explain(What,Text,C)")
            return
        what, text, cycle = atom.arguments
        if what not in self._texts or self._texts[what][0] <= cycle.number:
            self._texts[what] = cycle.number, text_of(text)


T = TypeVar("T")


class UnmetGoal(NamedTuple):
    """``goal`` and the goals ``together`` cannot be met after ``observations``.

    ``sure`` tells that they could be with any of the observations left out; otherwise that was not found out in time.
    ``note`` is a remark on the observations.
    """

    goal: Goal
    together: Tuple[Goal, ...] = ()
    observations: Tuple[Observation, ...] = ()
    sure: bool = True
    note: str = ""

    def text(self, explanations: Explanations, why: str) -> str:
        """The one in words, the program's where it has some; ``why`` is told where nothing else is known."""
        others = _joined(self.together, str)
        seen = _joined(self.observations, lambda one: explanations.of(one.atom) or str(one))
        reason = explanations.of(self.goal.identifier) or ("" if seen or others else why)
        perhaps = "" if self.sure else "perhaps "
        parts = [
            f"{self.goal} cannot be met",
            f" together with {others}" if others else "",
            f": {reason}" if reason else "",
            f" {perhaps}since {seen}" if seen else "",
            f", {self.note}" if self.note else "",
        ]
        return "".join(parts)


def streams_of(unmet: Sequence[UnmetGoal], stream: Stream) -> Iterator[Tuple[UnmetGoal, Stream]]:
    """Yield each of the goals with the stream that tells why it is given up: less the others that are, for themselves.

    ``stream`` is the one that has no plan for all.
    """
    for one in unmet:
        others = (other.goal for other in unmet if other.goal is not one.goal and other.goal not in one.together)
        facts = requests_of(others)
        yield one, stream._replace(log=stream.log.withdraw(facts), update=stream.update.less(facts))


def _joined(things: Sequence[T], words: Callable[[T], str]) -> str:
    texts: List[str] = list(dict.fromkeys(words(thing) for thing in things))
    return " and ".join(texts)


def refusals(answer: FrozenSet[Symbol], facts: Iterable[Observation]) -> Iterator[Tuple[str, str]]:
    """Yield why no heed is taken of some of the ``facts`` of an update, and who told them, given its answer."""
    texts = _read(answer)
    for fact in facts if texts else ():
        if fact.atom in texts:
            yield (
                f"'{fact.sent}' from '{fact.origin}' is ignored: {text_of(texts[fact.atom])}",
                fact.origin,
            )


@lru_cache(maxsize=2)  # the same answer comes again and again while things go as planned
def _read(answer: FrozenSet[Symbol]) -> Dict[Symbol, Symbol]:
    """The texts of what is refused."""
    refused = (atom.arguments for atom in answer if is_keyword(atom, REFUSE) and len(atom.arguments) == 3)
    return {fact: text for fact, text, _ in refused}
