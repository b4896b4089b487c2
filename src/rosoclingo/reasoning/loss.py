"""A goal that is given up, and why: what it is in conflict with."""

from typing import Callable, List, NamedTuple, Sequence, Tuple, TypeVar

from rosoclingo.reasoning.goals import Goal
from rosoclingo.reasoning.observations import Observation
from rosoclingo.reasoning.words import Explanations

T = TypeVar("T")


class Loss(NamedTuple):
    """``goal`` and the goals ``together`` cannot be met after ``observations``.

    ``sure`` tells that this is so, and would not be with any of them left out.
    """

    goal: Goal
    together: Tuple[Goal, ...] = ()
    observations: Tuple[Observation, ...] = ()
    sure: bool = True

    def text(self, explanations: Explanations, why: str) -> str:
        """The loss in words, the program's where it has some; ``why`` is told where nothing else is known."""
        others = _joined(self.together, lambda goal: f"goal {goal.identifier} ({goal.term})")
        seen = _joined(self.observations, lambda one: explanations.of(one.atom) or str(one))
        reason = explanations.of(self.goal.identifier) or ("" if seen or others else why)
        perhaps = "" if self.sure else "perhaps "
        parts = [
            f"goal {self.goal.identifier} {perhaps}cannot be met",
            f" together with {others}" if others else "",
            f": {reason}" if reason else "",
            f" {perhaps}since {seen}" if seen else "",
        ]
        return "".join(parts)


def _joined(things: Sequence[T], words: Callable[[T], str]) -> str:
    texts: List[str] = list(dict.fromkeys(words(thing) for thing in things))
    return " and ".join(texts)
