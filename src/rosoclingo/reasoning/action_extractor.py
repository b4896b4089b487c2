"""The action extractor of Fig. 4: it reads the task plan from an answer."""

from functools import lru_cache
from typing import FrozenSet, List, NamedTuple, Tuple

from clingo import Symbol

from rosoclingo.reasoning.keywords import ACTION_LIB, Action, KeywordError, action_of, atoms_of


class TaskPlan(NamedTuple):
    """The actions of an answer, ordered by cycle, and its malformed actions as texts.

    Compacted cycles are missing. The core has its own record of executed actions.
    """

    actions: Tuple[Action, ...] = ()
    faults: Tuple[str, ...] = ()

    def at(self, cycle: int) -> Tuple[Action, ...]:
        """The actions of a cycle."""
        return tuple(action for action in self.actions if action.cycle == cycle)

    def steps_after(self, cycle: int) -> int:
        """The number of cycles from ``cycle`` to the last action."""
        return max(0, self.actions[-1].cycle - cycle) if self.actions else 0

    def remaining(self, cycle: int) -> Tuple[Action, ...]:
        """The actions from a cycle on."""
        return tuple(action for action in self.actions if action.cycle >= cycle)


@lru_cache(maxsize=2)  # the answer stays the same while all actions succeed
def extract_plan(answer: FrozenSet[Symbol]) -> TaskPlan:
    """Return the task plan of an answer; malformed ``_action_lib`` atoms are reported as its faults."""
    actions: List[Action] = []
    faults: List[str] = []
    for atom in atoms_of(answer, ACTION_LIB):
        try:
            actions.append(action_of(atom))
        except KeywordError as error:
            faults.append(f"{error}; it is ignored")
    return TaskPlan(tuple(sorted(actions, key=lambda one: (one.cycle, str(one.atom)))), tuple(sorted(faults)))
