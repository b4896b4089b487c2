"""Repair: redate or withhold as few observations as possible if an update leaves the program without an answer.

Executed actions are certain. An observation that contradicts them is wrong, or its date is: a sensor that reports a
blocked door late names an earlier cycle. Such a fact is redated to the present if that leaves an answer, else withheld.
Newer facts are withheld before older ones, and other facts before returns. A failure is withheld together with the
commitment to its action if that leaves an answer; the action then counts as not done.
"""

from typing import Collection, Dict, FrozenSet, Iterator, List, NamedTuple, Optional, Sequence, Set, Tuple

from clingo import Symbol

from rosoclingo.oclingo import SolverError, SolveResult
from rosoclingo.planning.minimal_sets import UndecidedError, Witness, find_diagnosis, find_mus, remember, yes_or_no
from rosoclingo.planning.question import Reply
from rosoclingo.reasoning.hypotheses import Hypotheses, Impasse, Way, facts_of, first_found
from rosoclingo.reasoning.keywords import CANCEL, REQUEST, Action, is_keyword, name_of
from rosoclingo.reasoning.observations import Observation
from rosoclingo.reasoning.stream_planner import Planner

_NOTHING: FrozenSet[Symbol] = frozenset()


class Change(NamedTuple):
    """An observation that was redated or withheld.

    Attributes:
        observation: the observation.
        redated: the fact in its place, None if it was withheld.
        against: the executed actions that it contradicts.
        sure: whether it certainly contradicts the history; False if this was not decided in time.

    """

    observation: Observation
    redated: Optional[Symbol]
    against: Tuple[Action, ...] = ()
    sure: bool = True

    def __str__(self) -> str:
        one = self.observation
        done = " and ".join(f"{action.interface_name}({name_of(action.parameter)})" for action in self.against)
        done = f"{done} {'was' if len(self.against) == 1 else 'were'} done in cycle"
        denied = f"that {done} {self.against[0].cycle}" if self.against else "the history"
        origin = f" from interface {one.origin}" if one.origin else ""
        now = f"redated to cycle {self.redated.arguments[-1]}" if self.redated is not None else "withheld"
        now += "".join(f", {action.atom} counts as not done" for action in one.actions)
        return f"{one.sent}{origin} {'contradicts' if self.sure else 'possibly contradicts'} {denied}: {now}"


Repair = Tuple[Planner, SolveResult, Tuple[Change, ...]]
"""The planner with the repaired update, its result, and the changes of observations."""


def repair(planner: Planner, impasse: Impasse) -> Optional[Repair]:
    """Find the observations to redate or withhold; None if there is no answer even without all of them.

    Raises UndecidedError if this was not decided in time.
    """
    finder = _Finder(planner, impasse)
    return first_found(finder.pools(), finder.repair)


class _Finder:
    def __init__(self, planner: Planner, impasse: Impasse) -> None:
        self._planner, self._impasse, self._step = planner, impasse, impasse.step - 1
        self._look = impasse.watch()
        observed = [one for pool in self.pools() for one in pool]
        self._known = facts_of(observed).union(action.atom for action in impasse.executed)
        present = (impasse.clock.at_present(one.atom, self._step) for one in observed if self._is_late(one))
        further = sorted(frozenset(present) - self._known)
        ways = [way for way in Way if way is Way.KEPT or impasse.goals]  # a search without goals is easier
        self._hypotheses = [Hypotheses(planner, impasse, way, self._known, further) for way in ways]

    def pools(self) -> Iterator[Tuple[Observation, ...]]:
        """Yield growing sets of candidates, each newest first: late facts, new facts, earlier facts, returns.

        Failure returns are first withheld together with their actions, then alone. The last set adds the
        cancellations of the update.
        """
        new = tuple(reversed(self._impasse.facts))
        fed = frozenset(one.atom for one in new)
        old = tuple(one for one in self._impasse.observations if one.atom not in fed)
        facts = tuple(one for one in new if not one.is_return)
        earlier = (*facts, *(one for one in old if not one.is_return))
        every = (*earlier, *(one for one in (*new, *old) if one.is_return))
        alone = tuple(one._replace(actions=()) if one.is_return else one for one in every)
        heads = sorted(one for one in self._planner.last_update.heads if one is not None)
        requests = (one for one in heads if is_keyword(one, REQUEST))
        cancels = (Observation(one, self._step) for one in requests if is_keyword(one.arguments[0], CANCEL))
        pools = [tuple(one for one in facts if self._is_late(one)), facts, earlier, every, alone, (*alone, *cancels)]
        for number, pool in enumerate(pools):
            if pool and pool not in pools[:number]:
                yield pool

    def _is_late(self, one: Observation) -> bool:
        cycle = None if one.is_return else self._impasse.clock.cycle_of(one.atom)
        return cycle is not None and cycle < self._step

    def repair(self, pool: Tuple[Observation, ...]) -> Optional[Repair]:
        """Redate or withhold as few observations of a pool as possible; None if withholding all is not enough."""
        if not self._answers(pool).satisfiable:
            return None
        known: List[Witness[Observation]] = [Witness(True, frozenset()), Witness(False, frozenset(pool))]

        def oracle(kept: FrozenSet[Observation]) -> Witness[Observation]:
            """Return whether there is an answer with the observations ``kept`` of the pool."""
            reply = self._ask([one for one in pool if one not in kept])
            core = frozenset(one for one in kept if one.facts & reply.core)
            return Witness(bool(reply.satisfiable), kept if reply.satisfiable else core or kept)

        try:
            found = find_diagnosis(pool, remember(oracle, known))
        except UndecidedError:
            found = None
        self._look = self._impasse.watch()
        doubted = [one for one in reversed(pool) if found is None or one in found]
        moved = self._move(doubted)
        against = {one: self._against(one, doubted, moved) for one in found or ()}
        changes = (Change(one, moved.get(one), against.get(one, ()), found is not None) for one in doubted)
        try:
            planner, result = self._planner.corrected(facts_of(doubted), moved.values())
        except SolverError:
            raise UndecidedError from None
        return planner, result, tuple(changes)

    def _move(self, doubted: Sequence[Observation]) -> Dict[Observation, Symbol]:
        """Redate late facts to the present if that leaves an answer; return them with their new facts."""
        moved: Dict[Observation, Symbol] = {}
        for one in doubted:
            here = self._impasse.clock.at_present(one.atom, self._step) if self._is_late(one) else one.atom
            if here != one.atom and self._fits(doubted, {**moved, one: here}):
                moved[one] = here
        return moved

    def _fits(self, doubted: Sequence[Observation], moved: Dict[Observation, Symbol]) -> bool:
        try:
            return bool(self._ask(doubted, moved).satisfiable)
        except UndecidedError:
            return False

    def _against(
        self, one: Observation, doubted: Sequence[Observation], moved: Dict[Observation, Symbol]
    ) -> Tuple[Action, ...]:
        """Return the contradicted actions of the first cycle that ``one`` contradicts; none if undecided."""
        cycle = self._impasse.clock.cycle_of(one.atom) or 0
        done = [action for action in self._impasse.executed if action.cycle >= cycle - 1]
        others = [other for other in doubted if other is not one]

        def possible(kept: FrozenSet[Action]) -> bool:
            """Return whether an answer exists if only the actions ``kept`` were executed."""
            undone = frozenset(action.atom for action in done if action not in kept)
            return bool(self._ask(others, moved, undone).satisfiable)

        known: List[Witness[Action]] = [Witness(False, frozenset(done))]
        found = find_mus(done, remember(yes_or_no(possible), known))  # without cores, the MUS has the earliest actions
        cycles = [action.cycle for action in found.items if found.minimal]
        return tuple(action for action in found.items if action.cycle in cycles[-1:])

    def _ask(
        self,
        doubted: Collection[Observation],
        moved: Optional[Dict[Observation, Symbol]] = None,
        undone: FrozenSet[Symbol] = _NOTHING,
    ) -> Reply:
        """Call :meth:`_answers` if there is time left, else raise UndecidedError."""
        if self._look() is not None:
            raise UndecidedError
        return self._answers(doubted, moved, undone)

    def _answers(
        self,
        doubted: Collection[Observation],
        moved: Optional[Dict[Observation, Symbol]] = None,
        undone: FrozenSet[Symbol] = _NOTHING,
    ) -> Reply:
        """Return whether there is an answer, with or without goals; raises UndecidedError.

        The ``doubted`` observations are withheld, except for those ``moved`` to another cycle. The actions ``undone``
        count as not done.
        """
        facts = (self._known - facts_of(doubted) - undone).union((moved or {}).values())
        core: Set[Symbol] = set()

        def answers(one: Hypotheses) -> Optional[Reply]:
            """Return the reply if there is an answer, else None."""
            reply = one.ask((), facts)
            core.update(reply.core)
            return reply if reply.satisfiable else None

        return first_found(self._hypotheses, answers) or Reply(False, core=frozenset(core))
