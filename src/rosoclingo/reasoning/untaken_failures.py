"""Failures that the program cannot handle: none of its rules looks at them, or they contradict it.

For such a program the action would count as done, so the goals that rest on it are aborted.
"""

from typing import Callable, Iterable, List, Sequence

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.oclingo.program.return_rules import may_heed
from rosoclingo.reasoning.keywords import return_of, success_of
from rosoclingo.reasoning.mending import Change
from rosoclingo.reasoning.observations import Observation, Untaken
from rosoclingo.reasoning.records import Record

#: Reasons why the program cannot handle a failure.
UNHEARD, CONTRADICTS = "which no rule of the program looks at", "which contradicts the program"


class UntakenFailures:
    """The failures that the program cannot handle.

    Attributes:
        open: the unsettled ones.

    """

    def __init__(self, program: ReactiveProgram) -> None:
        self._program = program
        self.open: List[Untaken] = []

    def note(self, failure: Observation) -> None:
        """Note a failure if the program does not declare such returns, or no rule can see it.

        A rule that looks at the action's return of success sees failures as well, by the absence of that return.
        """
        answer = return_of(failure.atom)
        atoms = [answer.atom, answer.failure, *map(success_of, failure.actions)]
        declared = self._program.may_define(failure.atom, self._program.first_step)
        if not declared or not may_heed(self._program.parts, self._program.values, atoms):
            self.open.append(Untaken(failure, UNHEARD))

    def note_warnings(self, failures: Iterable[Observation], warnings: Sequence[str]) -> None:
        """Note those ``failures`` of an update that the solver ignored, by its ``warnings``."""
        known = [one.failure.atom for one in self.open]
        for one in failures:
            if one.atom not in known and any(f"Head {one.atom} has not been declared" in text for text in warnings):
                self.open.append(Untaken(one, UNHEARD))

    def note_withheld(self, changes: Sequence[Change], seen: Iterable[Observation]) -> None:
        """Note failures, among the observations ``seen``, that are withheld."""
        actions = {one.atom: one.actions for one in seen if one.actions}
        for one, taken_as, *_ in changes:
            if taken_as is None and one.atom in actions:
                failure = one._replace(actions=actions[one.atom], cycle=return_of(one.atom).cycle)
                self.open.append(Untaken(failure, CONTRADICTS, undone=bool(one.actions)))

    def settle(self, failures: Iterable[Untaken], problem: Callable[[str], None]) -> None:
        """Forget all failures; report the outcome of those that no rule looks at."""
        self.open.clear()
        for one in failures:
            if one.why == UNHEARD:
                problem(f"{one.failure}, {UNHEARD}: it counts as {'not ' if one.undone else ''}done")

    def record(self) -> List[Record]:
        """Return the failures as plain values."""
        return [one.record() for one in self.open]

    def restore(self, record: Iterable[Record]) -> None:
        """Restore the failures of a record."""
        self.open = [Untaken.of_record(one) for one in record]
