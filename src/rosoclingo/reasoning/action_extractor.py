"""The action extractor of Fig. 4: it reads the task plan out of an answer."""

from functools import lru_cache
from typing import FrozenSet, List, NamedTuple, Tuple

from clingo import Symbol

from rosoclingo.reasoning.keywords import ACTION_LIB, Action, KeywordError, action_of, is_keyword


class TaskPlan(NamedTuple):
    """The actions of an answer by cycle, and what was wrong with it.

    Of the past it holds what the solver still knows; what was done is told from the core's own record of it.
    """

    actions: Tuple[Action, ...] = ()
    faults: Tuple[str, ...] = ()

    def at(self, cycle: int) -> Tuple[Action, ...]:
        """The actions of a cycle."""
        return tuple(action for action in self.actions if action.cycle == cycle)

    def after(self, cycle: int) -> Tuple[Action, ...]:
        """The actions later than a cycle."""
        return tuple(action for action in self.actions if action.cycle > cycle)

    def steps_after(self, cycle: int) -> int:
        """How many cycles after ``cycle`` it goes on."""
        return max(0, self.actions[-1].cycle - cycle) if self.actions else 0

    def remaining(self, cycle: int) -> Tuple[Action, ...]:
        """The actions of a cycle and later."""
        return tuple(action for action in self.actions if action.cycle >= cycle)


@lru_cache(maxsize=2)  # the same answer comes again and again while things go as planned
def extract_plan(answer: FrozenSet[Symbol]) -> TaskPlan:
    """The task plan of an answer; ``_action_lib`` atoms of another form are left out and told as faults."""
    actions: List[Action] = []
    faults: List[str] = []
    for atom in answer:
        if is_keyword(atom, ACTION_LIB):
            try:
                actions.append(action_of(atom))
            except KeywordError as error:
                faults.append(f"{error}; it is ignored")
    return TaskPlan(tuple(sorted(actions, key=_order)), tuple(sorted(faults)))


def _order(action: Action) -> Tuple[int, str]:
    return action.cycle, str(action.atom)
