"""What to do about observations that leave the program without an answer: the fewest are taken otherwise or withheld.

What was done was done, so an observation that says it can't have been is wrong, or is dated wrong: a sensor that tells
of a blocked door late speaks of the cycle that it knows. Such a fact is taken for the present where it makes sense
there, else withheld. Newer facts are doubted before older ones, and other facts before returns. A failure
is withheld together with the commitment to its action, which then counts as not done, if that leaves an answer.
"""

from dataclasses import replace
from typing import Dict, FrozenSet, Iterator, List, NamedTuple, Optional, Sequence, Tuple

from clingo import Symbol

from rosoclingo.oclingo import SolveOutcome, SolverError, SolveResult, Statement, StreamUpdate
from rosoclingo.oclingo.progression.updates import Withdraw
from rosoclingo.planning.minimal_sets import Oracle, UndecidedError, Witness, find_diagnosis, remember, yes_or_no
from rosoclingo.reasoning.input_feeder import Batch, Clock
from rosoclingo.reasoning.keywords import CANCEL, REQUEST, Action, is_keyword, name_of
from rosoclingo.reasoning.observations import Observation
from rosoclingo.reasoning.recovery import Question, first_found, is_answerable
from rosoclingo.reasoning.stream_planner import Planner


class Case(NamedTuple):
    """An update without an answer: ``batch`` as it was ``taken``; ``executed`` are the latest actions, oldest first.

    ``question`` names the goals, and the older observations. ``clock`` dates facts.
    """

    batch: Batch
    taken: StreamUpdate
    executed: Tuple[Action, ...]
    question: Question
    clock: Clock

    @property
    def step(self) -> int:
        """The cycle that the update starts."""
        return self.question.step - 1


class Change(NamedTuple):
    """An observation that was ``taken_as`` another fact, or withheld; ``against`` tells what was done that it denies.

    ``sure`` tells that it does; otherwise time was over before the observations that do were known. The actions of a
    withheld observation count as not done.
    """

    observation: Observation
    taken_as: Optional[Symbol]
    against: Tuple[Action, ...] = ()
    sure: bool = True

    def __str__(self) -> str:
        one = self.observation
        done = " and ".join(f"{action.interface_name}({name_of(action.parameter)})" for action in self.against)
        was = (
            f"{done} {'was' if len(self.against) == 1 else 'were'} done in cycle {self.against[0].cycle}"
            if done
            else ""
        )
        origin = f" from interface {one.origin}" if one.origin else ""
        denied = f"that {was}" if was else "what was done and told before"
        now = f"taken for cycle {self.taken_as.arguments[-1]}" if self.taken_as is not None else "withheld"
        now += "".join(f", {action.atom} counts as not done" for action in one.actions)
        return f"{one.sent}{origin} {'contradicts' if self.sure else 'may contradict'} {denied}: {now}"


class Mend(NamedTuple):
    """A way on: the ``result`` of another update in place of the one without an answer on ``planner``; what changed."""

    planner: Planner
    result: SolveResult
    changes: Tuple[Change, ...]


def mend(planner: Planner, case: Case) -> Optional[Mend]:
    """Find the observations to take otherwise; None where there is no answer whatever is withheld.

    Raises UndecidedError where that is not found out in time.
    """
    return _Mender(planner, case).mend()


class _Mender:
    def __init__(self, planner: Planner, case: Case) -> None:
        self._planner = planner
        self._case = case
        self._look = case.question.watch()
        self._fed = frozenset(one.atom for one in case.batch.facts)

    def mend(self) -> Optional[Mend]:
        """Doubt more and more observations until there is an answer."""
        return first_found(self._pools(), lambda pool: self._least(pool) if self._answers(pool) else None)

    def _pools(self) -> Iterator[Tuple[Observation, ...]]:
        """Yield the observations to doubt, newest first: late facts, this update's, earlier ones, returns.

        Returns of failures come with their actions first, then alone.
        """
        new = tuple(reversed(self._case.batch.facts))
        old = tuple(one for one in self._case.question.observations if one.atom not in self._fed)
        facts = tuple(one for one in new if not one.is_return)
        earlier = (*facts, *(one for one in old if not one.is_return))
        pools = [tuple(one for one in facts if self._is_late(one)), facts, earlier]
        pools.append((*earlier, *(one for one in (*new, *old) if one.is_return)))
        pools.append(tuple(one._replace(actions=()) if one.is_return else one for one in pools[-1]))
        pools.append((*pools[-1], *map(self._cancellation, self._cancellations())))
        for number, pool in enumerate(pools):
            if pool and pool not in pools[:number]:
                yield pool

    def _is_late(self, one: Observation) -> bool:
        cycle = self._case.clock.cycle_of(one.atom)
        return cycle is not None and cycle < self._case.step

    def _cancellations(self) -> List[Symbol]:
        heads = [item.head for item in self._case.taken.items if isinstance(item, Statement) and item.head is not None]
        requests = [head for head in heads if is_keyword(head, REQUEST)]
        return [head for head in requests if is_keyword(head.arguments[0], CANCEL)]

    def _cancellation(self, atom: Symbol) -> Observation:
        return Observation(atom, self._case.step)

    def _least(self, pool: Tuple[Observation, ...]) -> Mend:
        """Doubt as little as can be of what is enough."""
        known: List[Witness[Observation]] = [Witness(True, frozenset()), Witness(False, frozenset(pool))]

        def met(kept: FrozenSet[Observation]) -> bool:
            """Tell whether there is an answer though some of the pool are kept."""
            if self._look() is not None:
                raise UndecidedError
            return self._answers([one for one in pool if one not in kept])

        try:
            found = self._fewest(pool, remember(yes_or_no(met), known))
        except UndecidedError:
            found = []
        self._look = self._case.question.watch()
        doubted = [one for one in reversed(pool) if one in found or not found]
        moved = self._move(doubted)
        if found:
            changes = tuple(Change(one, moved.get(one), self._against(one, doubted, moved)) for one in doubted)
        else:
            changes = tuple(Change(one, moved.get(one), sure=False) for one in doubted)
        update = self._without(doubted, moved)
        try:
            planner, result = self._planner.instead(update)
        except SolverError:
            raise UndecidedError from None
        return Mend(planner, result, changes)

    @staticmethod
    def _fewest(pool: Tuple[Observation, ...], oracle: Oracle[Observation]) -> List[Observation]:
        """Find the fewest to doubt: all that can't be alone, and of the others a choice."""
        alone = [one for one in pool if not oracle(frozenset([one])).satisfiable]
        others = [one for one in pool if one not in alone]
        return [*alone, *(find_diagnosis(others, oracle) or {})]

    def _move(self, doubted: Sequence[Observation]) -> Dict[Observation, Symbol]:
        """Take what is late for the present where that leaves an answer, all of it or one by one."""
        clock, step = self._case.clock, self._case.step
        late = [one for one in doubted if self._is_late(one) and not one.is_return]
        here = {one: clock.at_present(one.atom, step) for one in late}
        fitting = {one: atom for one, atom in here.items() if atom != one.atom}
        if not fitting or self._tried(doubted, fitting):
            return fitting
        moved: Dict[Observation, Symbol] = {}
        for one, atom in fitting.items():
            if len(fitting) > 1 and self._look() is None and self._tried(doubted, {**moved, one: atom}):
                moved[one] = atom
        return moved

    def _tried(self, doubted: Sequence[Observation], moved: Dict[Observation, Symbol]) -> bool:
        try:
            return self._answers(doubted, moved)
        except UndecidedError:
            return False

    def _against(
        self, one: Observation, doubted: Sequence[Observation], moved: Dict[Observation, Symbol]
    ) -> Tuple[Action, ...]:
        """Find the first cycle what was done in which can't be if ``one`` is so, and its actions."""
        cycle = self._case.clock.cycle_of(one.atom) or 0
        done = [action for action in self._case.executed if action.cycle >= cycle - 1]
        cycles = sorted({action.cycle for action in done})
        others = [other for other in doubted if other is not one]

        def denies(number: int) -> bool:
            """Tell whether what was done in the first of the cycles can't be."""
            if self._look() is not None:
                raise UndecidedError
            last = cycles[number - 1] if number else 0
            undone = frozenset(action.atom for action in done if action.cycle > last)
            return not self._answers(others, moved, undone)

        try:
            if not cycles or denies(0):
                return ()
            low, high = 0, len(cycles)
            while high - low > 1:
                middle = (low + high) // 2
                low, high = (low, middle) if denies(middle) else (middle, high)
        except UndecidedError:
            return ()
        return tuple(action for action in done if action.cycle == cycles[high - 1])

    def _answers(
        self,
        doubted: Sequence[Observation],
        moved: Optional[Dict[Observation, Symbol]] = None,
        undone: FrozenSet[Symbol] = frozenset(),
    ) -> bool:
        """Whether there is an answer, if need be without goals, with observations otherwise, and actions undone."""
        try:
            planner, result = self._planner.instead(self._without(doubted, moved or {}), undone)
        except SolverError:
            raise UndecidedError from None
        if result.outcome is SolveOutcome.SATISFIABLE:
            return True
        if is_answerable(planner, self._case.question):
            return True
        if result.outcome is SolveOutcome.INTERRUPTED:
            raise UndecidedError
        return False

    def _without(self, doubted: Sequence[Observation], moved: Dict[Observation, Symbol]) -> StreamUpdate:
        """The update with some observations otherwise; those of before are withdrawn."""
        atoms = frozenset().union(*(one.facts for one in doubted))
        update = self._case.taken
        present = update.heads | update.committed
        old = dict.fromkeys(atom for one in doubted for atom in sorted(one.facts) if atom not in present)
        kept = update.less(atoms)
        new = [Statement(atom) for atom in dict.fromkeys(moved.values()) if atom not in present - atoms]
        return replace(kept, items=(*map(Withdraw, old), *kept.items, *new))
