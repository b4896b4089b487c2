"""Explanations of the program: ``_explain/3`` for unmet goals, and ``_refuse/3`` for refused facts."""

from typing import (
    Callable,
    Dict,
    FrozenSet,
    Iterable,
    Iterator,
    List,
    Mapping,
    NamedTuple,
    Sequence,
    Tuple,
    TypeVar,
)

from clingo import Symbol, SymbolType

from rosoclingo.planning.explaining.questions import Stream
from rosoclingo.reasoning.goals import Goal
from rosoclingo.reasoning.input_feeder import requests_of
from rosoclingo.reasoning.keywords import EXPLAIN, REFUSE, atoms_of, name_of
from rosoclingo.reasoning.observations import Observation


def text_of(term: Symbol) -> str:
    """Return the text of a term: the content of a string, the joined pieces of a tuple, or the term itself."""
    if term.type is SymbolType.Function and not term.name:
        return "".join(text_of(piece) for piece in term.arguments)
    return name_of(term)


def explanations_in(answer: FrozenSet[Symbol]) -> Tuple[Dict[Symbol, str], List[str]]:
    """Return the latest explanations of goals (by identifier) and observations, and messages about malformed ones."""
    found: List[Symbol] = []
    faults: List[str] = []
    for atom in sorted(atoms_of(answer, EXPLAIN)):
        if len(atom.arguments) == 3 and atom.arguments[2].type is SymbolType.Number:
            found.append(atom)
        else:
            faults.append(f"'{atom}' is not an explanation: write _explain(What,Text,C)")
    latest = (one.arguments for one in sorted(found, key=lambda one: one.arguments[2]))
    return {what: text_of(text) for what, text, _ in latest}, faults


T = TypeVar("T")


class UnmetGoal(NamedTuple):
    """``goal`` and the goals ``together`` cannot be met after ``observations``.

    ``sure`` is true if they could be met without any one of the observations, and false if this was not decided in
    time. ``note`` is a remark on the observations.
    """

    goal: Goal
    together: Tuple[Goal, ...] = ()
    observations: Tuple[Observation, ...] = ()
    sure: bool = True
    note: str = ""

    def text(self, explanations: Mapping[Symbol, str], why: str) -> str:
        """Return the reason as text, with the program's explanations; ``why`` is used if there is no other."""
        others = _joined(self.together, str)
        seen = _joined(self.observations, lambda one: explanations.get(one.atom) or str(one))
        reason = explanations.get(self.goal.identifier) or ("" if seen or others else why)
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
    """Yield each unmet goal with a stream that explains it: without the goals that are unmet for other reasons.

    ``stream`` is the original stream, without a plan for all goals.
    """
    for one in unmet:
        others = (other.goal for other in unmet if other.goal is not one.goal and other.goal not in one.together)
        facts = requests_of(others)
        yield one, stream._replace(log=stream.log.withdraw(facts), update=stream.update.without_facts(facts))


def _joined(things: Sequence[T], words: Callable[[T], str]) -> str:
    texts: List[str] = list(dict.fromkeys(words(thing) for thing in things))
    return " and ".join(texts)


def refusals(answer: FrozenSet[Symbol], facts: Iterable[Observation]) -> Iterator[Tuple[str, str]]:
    """Yield a message and the origin for each fact of an update that the program refuses in its answer."""
    refused = (atom.arguments for atom in atoms_of(answer, REFUSE) if len(atom.arguments) == 3)
    texts = {fact: text for fact, text, _ in refused}
    for fact in facts if texts else ():
        if fact.atom in texts:
            yield f"'{fact.sent}' from '{fact.origin}' is ignored: {text_of(texts[fact.atom])}", fact.origin
