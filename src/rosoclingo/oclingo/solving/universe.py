"""One grounding for all streams over some facts: which were told, and what was done, each search says anew.

Searches are made under assumptions, so that nothing is ground twice, whatever stream is asked about.
"""

from typing import Callable, Dict, FrozenSet, Iterable, List, Mapping, NamedTuple, Optional, Sequence, Tuple

import clingo

from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.terms import Signature
from rosoclingo.oclingo.progression.updates import Statement
from rosoclingo.oclingo.solving.clasp_search import Limits
from rosoclingo.oclingo.solving.grounding import BLOCK, Grounding
from rosoclingo.oclingo.solving.stream_state import FOREVER

CONFLICTS = 20000
"""Conflicts of a search between two looks at the stop request."""

Read = Callable[[clingo.Model], FrozenSet[clingo.Symbol]]

TimeOf = Callable[[clingo.Symbol], Optional[int]]


class Found(NamedTuple):
    """An answer: the actions of the present step, what is shown, its horizon, and what was read of the model."""

    actions: FrozenSet[clingo.Symbol]
    shown: FrozenSet[clingo.Symbol]
    horizon: int
    read: Tuple[FrozenSet[clingo.Symbol], ...]


class StoppedError(Exception):
    """A search was stopped before it came to a result."""


class Universe(Grounding):
    """Base and the steps up to ``last`` of a program, for streams of any of ``facts``; for shortest plans."""

    def __init__(self, program: ReactiveProgram, facts: Iterable[clingo.Symbol], last: int) -> None:
        """Ground all of it; raises RuntimeError as clingo does."""
        known = list(dict.fromkeys(facts))
        opened = [one for one in known if program.is_open_signature(one)]
        super().__init__(program, opened, set(), shortest=True, doubted=frozenset(known))
        while self.horizon < last:
            self.ground_to(min(last, self.horizon + BLOCK))
        self.facts = frozenset(one for one in known if self.atoms.is_open(one))
        for one in sorted(self.facts):
            self.add(Statement(one), FOREVER)
        self.atoms.end_definitions()
        assert self._doubts is not None or not known
        self._literals: Dict[clingo.Symbol, int] = dict(self._doubts.told) if self._doubts else {}
        self._ranges: Dict[Tuple[int, int], List[int]] = {}

    def assumed(
        self,
        told: FrozenSet[clingo.Symbol],
        closed: Mapping[int, FrozenSet[clingo.Symbol]],
        demanded: Iterable[clingo.Symbol],
    ) -> List[int]:
        """Return the assumptions that just these facts were ``told``, and that what is ``demanded`` is true.

        In ``closed`` cycles just these actions were done.
        """
        found = [literal if fact in told else -literal for fact, literal in self._literals.items()]
        for cycle, done in closed.items():
            for atom, literal in self._actions.of_cycle(cycle):
                found.append(literal if atom in done else -literal)
        for atom in demanded:
            known = self._control.symbolic_atoms[atom]
            found += [known.literal] if known is not None else self._never()
        return found

    def _never(self) -> List[int]:
        literal = self._session.new_external()
        return [literal, -literal]

    def horizon_in(self, assumed: Sequence[int], first: int, last: int, halt: Callable[[], bool]) -> Optional[int]:
        """Return the horizon, from ``first`` to ``last``, of an answer; None where there is none."""
        horizons: List[int] = []
        self._solve(
            assumed, first, last, halt, lambda model: horizons.append(self._ends.horizon_of(model, first, last))
        )
        return horizons[0] if horizons else None

    def answers(
        self,
        assumed: Sequence[int],
        horizon: int,
        step: int,
        most: int,
        reads: Sequence[Read],
        halt: Callable[[], bool],
    ) -> List[Found]:
        """Return answers of a horizon, at most ``most``, whose actions of ``step`` differ.

        Each comes with what ``reads`` have read of its model.
        """
        found: List[Found] = []
        actions = self._actions.of_cycle(step)

        def keep(model: clingo.Model) -> None:
            """Take an answer, and forbid others with the same actions now."""
            done = frozenset(atom for atom, literal in actions if model.is_true(literal))
            shown = frozenset(model.symbols(shown=True)) - self._hidden - self._ends.names
            found.append(Found(done, shown, horizon, tuple(read(model) for read in reads)))
            if most > 1:
                clause = [-literal if atom in done else literal for atom, literal in actions]
                model.context.add_clause(clause)

        self._solve(assumed, horizon, horizon, halt, keep, most)
        return sorted(found, key=lambda one: sorted(one.actions))

    def _solve(
        self,
        assumed: Sequence[int],
        first: int,
        last: int,
        halt: Callable[[], bool],
        keep: Callable[[clingo.Model], None],
        most: int = 1,
    ) -> None:
        self._session.close()
        assumptions = [*assumed, *self._range(first, last)]
        limits = Limits(most, CONFLICTS, best=False, advised=True)
        found = 0

        def count(model: clingo.Model) -> None:
            """Note that there is an answer."""
            nonlocal found
            found += 1
            keep(model)

        while True:
            result = self._clasp.run_in_place(limits, assumptions, count)
            if not result.unknown or found:
                return
            if halt():
                raise StoppedError

    def _range(self, first: int, last: int) -> List[int]:
        """Return the assumptions by which the horizon lies in first..last; to ask clingo anew takes long."""
        if (first, last) not in self._ranges:
            self._ranges[first, last] = self._ends.range(first, last)
            self._session.close()
        return self._ranges[first, last]

    def atoms_by_time(self, time_of: TimeOf) -> Dict[int, List[Tuple[clingo.Symbol, int]]]:
        """Return the atoms of which ``time_of`` tells a time, with their literals, by that."""
        found: Dict[int, List[Tuple[clingo.Symbol, int]]] = {}
        for one in self._control.symbolic_atoms:
            time = time_of(one.symbol) if one.literal else None
            if time is not None:
                found.setdefault(time, []).append((one.symbol, one.literal))
        return found

    def timeless(self, time_of: TimeOf) -> List[Tuple[clingo.Symbol, int]]:
        """Return the atoms that steps define, or that are told, of which ``time_of`` tells no time."""
        defined = self.program.external_signatures | self.program.step_signatures
        known = (one for each in defined for one in self._control.symbolic_atoms.by_signature(*each))
        return [(one.symbol, one.literal) for one in known if one.literal and time_of(one.symbol) is None]

    def of(self, signature: Signature) -> List[Tuple[clingo.Symbol, int]]:
        """Return the atoms of a predicate, with their literals."""
        known = self._control.symbolic_atoms.by_signature(*signature)
        return [(one.symbol, one.literal) for one in known if one.literal]
