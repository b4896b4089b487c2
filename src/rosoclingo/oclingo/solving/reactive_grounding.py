"""The grounding of the incremental solver, which is updated in place."""

from typing import Callable, Dict, FrozenSet, Iterable, List, Optional, Tuple

import clingo

from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.lifetimes import FOREVER
from rosoclingo.oclingo.solving.clasp_search import SearchLimits
from rosoclingo.oclingo.solving.cycles import ActionIndex
from rosoclingo.oclingo.solving.definitions import HOLDS
from rosoclingo.oclingo.solving.results import Answer, refusing
from rosoclingo.oclingo.solving.stepwise_grounding import StepwiseGrounding
from rosoclingo.oclingo.solving.stream_state import StateItem, StreamState, TimedStatement


class ReactiveGrounding(StepwiseGrounding):
    """A grounding that follows the state of a stream; each search has the last grounded step as its horizon."""

    def __init__(self, program: ReactiveProgram, state: StreamState) -> None:
        """Ground base; heads of open signatures in ``state`` become externals or facts."""
        super().__init__(program, reopens=True)
        self._actions = ActionIndex(self._control, self._session)
        self._items: Dict[int, StateItem] = {}  # the applied items of the state, by identity
        self._guards: Dict[int, int] = {}  # identity of a lapsing statement -> its guard literal
        self._closed: Dict[int, FrozenSet[clingo.Symbol]] = {}  # closed cycle -> its executed actions
        self._windows: List[Tuple[int, range]] = []  # guards of volatile rules with the horizons at which they hold
        self._was_searched = False
        self._clasp = self._load()
        permanent = state.permanent_facts()
        self.open_facts = {one: permanent[one] for one in self._new_open(state) if one in permanent}
        self.open_heads(state)
        self._ground_base()

    # ---- Following the state -----------------------------------------------------------------------------------------

    def can_follow(self, state: StreamState) -> bool:
        """Return whether the grounding can be updated in place to ``state``.

        It cannot if its horizon is too high, a permanent item was removed, a grounded rule could match a new atom of an
        open signature, or a statement closes a loop: clingo detects loops only among rules that are added between two
        searches.
        """
        return (
            self.horizon <= state.horizon
            and all(isinstance(one, TimedStatement) and one.lifetime != FOREVER for one in self._removed(state))
            and self._closed.items() <= state.closed.items()
            and not self.program.can_see(self._new_open(state), self.program.first_step, self.horizon)
            and not (self._was_searched and state.closes_loops(self.program))
        )

    def open_heads(self, state: StreamState) -> None:
        """Declare new heads of open signatures as externals or facts, visible to the steps grounded later."""
        self._open(self._new_open(state))

    def follow(self, state: StreamState) -> List[TimedStatement]:
        """Apply the new items of ``state`` and release removed ones; return the ignored statements.

        The grounding must have reached the horizon of ``state``.
        """
        for one in self._removed(state):
            del self._items[id(one)]
            if id(one) in self._guards:
                self._session.release(self._guards.pop(id(one)))
        for cycle in state.closed.keys() - self._closed.keys():
            self._closed[cycle] = state.closed[cycle]
            self._actions.close_cycle(cycle, state.closed[cycle])
        self.deferred = [one for one in self.deferred if id(one) in self._items]
        self._accept_deferred()
        new = [one for one in state.items if id(one) not in self._items]
        self._items.update((id(one), one) for one in new)
        return self._apply(new)

    def _removed(self, state: StreamState) -> List[StateItem]:
        """Return the applied items that ``state`` no longer contains."""
        present = set(map(id, state.items))
        return [item for key, item in self._items.items() if key not in present]

    def _add(self, entry: TimedStatement) -> None:
        guards = [] if entry.lifetime == FOREVER else [self._session.new_external(HOLDS)]
        self._guards.update((id(entry), guard) for guard in guards)
        self.definitions.add(entry, guards)

    def _limit(self, guard: int, first: int, last: int) -> None:
        self._windows.append((guard, range(first, last + 1)))

    def _mentions(self, atom: clingo.Symbol) -> bool:
        return '"' not in str(atom) and super()._mentions(atom)  # see strings_as_constants

    # ---- Searching ---------------------------------------------------------------------------------------------------

    def search(self, models: int, stopped: Callable[[], bool]) -> Tuple[Optional[bool], Tuple[Answer, ...]]:
        """Search for up to ``models`` answers (0: all) at the horizon, until ``stopped`` returns true.

        Returns whether there is an answer (None after a stop), and the answers. If the program optimizes, these are
        optimal.
        """
        self._was_searched = True
        self._actions.forbid_late()
        self._session.close()
        for guard, horizons in self._windows:
            self._control.assign_external(guard, self.horizon in horizons)
        self._windows = [one for one in self._windows if one[1].stop > self.horizon]
        answers: List[Answer] = []
        hidden = self._hidden

        def keep(model: clingo.Model) -> None:
            """Record a model as an answer; if the program optimizes, only a proven optimum."""
            if not model.cost or model.optimality_proven:
                answers.append(frozenset(model.symbols(shown=True)) - hidden)

        limits = SearchLimits(models, None, best=True, advised=True)
        with refusing(self.messages, self.program):
            result, _ = self._clasp.run(limits, (), keep, stopped, with_core=False)
        if result.interrupted or result.unknown:
            return None, ()
        return bool(result.satisfiable or answers), tuple(answers)

    def new_remarks(self) -> Iterable[str]:
        """Return the messages that clingo logged about the program since the last call."""
        return map(str, self.messages.new_remarks(self.program.parameter_at)) if self.messages.received else ()
