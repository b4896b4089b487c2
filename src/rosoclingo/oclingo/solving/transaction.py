"""Taking one update: what it changes in the state and in the grounding of the incremental solver.

A transaction works on a copy of the state; a failure discards the copy. While
the grounding fits the state it is changed in place; where a change can't be made in place (an open external that a
grounded step could see, a loop over several steps) it is dropped and rebuilt.
"""

from typing import Callable, FrozenSet, Iterator, List, Optional

import clingo

from rosoclingo.oclingo.program.parts import GUARD
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.signatures import Dependencies, statement_edges
from rosoclingo.oclingo.program.update_reader import closed_cycles, with_failures
from rosoclingo.oclingo.progression.lifetimes import FOREVER, UPDATE, Lifetime, Term, lifetime_of
from rosoclingo.oclingo.progression.parser import strings_apart
from rosoclingo.oclingo.progression.terms import signature_of
from rosoclingo.oclingo.progression.updates import (
    Anew,
    Assert,
    Cumulative,
    Forget,
    Retract,
    Section,
    Statement,
    StreamUpdate,
    Volatile,
)
from rosoclingo.oclingo.solving.reactive_grounding import ReactiveGrounding, build_grounding
from rosoclingo.oclingo.solving.results import NOT_EXTERNAL, unused_fact
from rosoclingo.oclingo.solving.stream_state import Lapsing, StreamState


class Transaction:
    """One entry on its way into a stream's state.

    Attributes:
        state: the state as it will be; the caller keeps it if all goes well.
        grounding: the grounding that fits :attr:`state`, None if it has to be rebuilt.
        warnings: what was ignored.

    """

    def __init__(
        self,
        program: ReactiveProgram,
        state: StreamState,
        grounding: Optional[ReactiveGrounding],
        limit: Optional[int] = None,
        dropped: Callable[[], bool] = lambda: False,
    ) -> None:
        """Work on ``state``, which nobody else has, and ``grounding``; no step beyond ``limit`` is ground.

        ``dropped`` ends a rebuild of the grounding.
        """
        self.program, self.state, self.grounding = program, state, grounding
        self._limit, self._dropped = limit, dropped
        self.warnings: List[str] = []
        self._dependencies: Optional[Dependencies] = None  # between atoms, including this update
        self._update = StreamUpdate()
        self._forgets: Optional[List[Forget]] = None  # applied after the update's statements

    def begin(self, update: Optional[StreamUpdate], halt: Callable[[], bool]) -> bool:
        """Ground up to the update's step and add its statements; False where ``halt`` stopped it on the way."""
        self._forgets = []
        if update is None:
            complete = self._ground_to(max(self.state.horizon, self.state.step), halt)
        else:
            update = with_failures(self.program, strings_apart(update), self.state.permanent)
            self._look_back(update)
            complete = self._take(update, halt)
        forgets, self._forgets = self._forgets, None
        for one in forgets:
            self._forget(one)
        return complete

    def _take(self, update: StreamUpdate, halt: Callable[[], bool]) -> bool:
        state, self._update = self.state, update
        self._lapse(lambda lifetime: lifetime == UPDATE)
        if update.step is not None:
            state.step = update.step
            state.bound = None if update.bound is None else update.step + update.bound
        self._open_heads(update)
        complete = self._ground_to(max(state.horizon, state.step), halt)
        self._standing().atoms.end_definitions()
        self._take_items(update)
        return complete

    def _look_back(self, update: StreamUpdate) -> None:
        """Do what an update says of the past, before anything else of it."""
        if any(isinstance(item, Anew) for item in update.items):
            self.grounding, self.state = None, StreamState(forgets_done=self.program.first_step - 1)
        if update.withdrawn:
            self.grounding, self.state = None, self.state.less(update.withdrawn)
        for cycle, executed in closed_cycles(update, self.program.first_step, self.state.step).items():
            self._close_cycle(cycle, executed)

    def _close_cycle(self, cycle: int, executed: FrozenSet[clingo.Symbol]) -> None:
        self.state.closed_cycles[cycle] = executed
        if self.grounding is not None:
            self.grounding.close_cycle(cycle, executed)

    def ready(self) -> ReactiveGrounding:
        """Return a grounding of the state, rebuilt if there is none or loops require it."""
        if self.grounding is None or self.state.cyclic:
            self.grounding = self._build()
        return self.grounding

    @property
    def last_horizon(self) -> Optional[int]:
        """The greatest horizon to search, by the bound of the stream and the limit of the solver; None for none."""
        return min((end for end in (self.state.bound, self._limit) if end is not None), default=None)

    def grow(self) -> None:
        """Ground one more step."""
        self._advance(self._standing(), self.state.horizon + 1)

    def _open_heads(self, update: StreamUpdate) -> None:
        """Make new atoms of open signatures known; what has been grounded and could have seen one is given up."""
        known = set(self.state.open_atoms)
        heads = dict.fromkeys(statement.head for _, statement in update.sections())
        fresh = [
            head for head in heads if head is not None and head not in known and self.program.is_open_signature(head)
        ]
        self.state.open_atoms.extend(fresh)
        if self.grounding is not None:
            new = [atom for atom in fresh if not self.grounding.atoms.knows(atom)]
            if self.program.may_see(new, self.program.first_step, self.grounding.horizon):
                self.grounding = None
            elif new:
                self.grounding.declare(new)

    def _ground_to(self, horizon: int, halt: Callable[[], bool]) -> bool:
        grounding = self._standing()
        while self.state.horizon < horizon:
            if halt():
                return False
            self._advance(grounding, self.state.horizon + 1)
        return True

    def _advance(self, grounding: ReactiveGrounding, horizon: int) -> None:
        """Ground up to ``horizon``, with all that falls due there."""
        self.state.horizon = horizon
        grounding.ground_to(horizon)
        self._fall_due(grounding)

    def _fall_due(self, grounding: ReactiveGrounding) -> None:
        state = self.state
        horizon = state.horizon
        self._lapse(lambda lifetime: isinstance(lifetime, int) and lifetime < horizon)
        for entry in [
            one
            for one in state.waiting
            if one.statement.head is not None and grounding.atoms.is_open(one.statement.head)
        ]:
            state.waiting.remove(entry)
            self._put(entry.statement, entry.lifetime)
        while state.forgets_done < horizon:
            state.forgets_done += 1
            for step in self.program.forgotten_at(state.forgets_done):
                if step < state.forgets_done:  # what a step declares itself it cannot forget
                    self._forget(Forget(step, step))

    def _lapse(self, ends: Callable[[Lifetime], bool]) -> bool:
        """End the lapsing and waiting statements whose lifetime ``ends``; tell whether there were any."""
        state = self.state
        over = [entry.lifetime for entry in state.lapsing + state.waiting if ends(entry.lifetime)]
        if over:
            state.lapsing = [entry for entry in state.lapsing if entry.lifetime not in over]
            state.waiting = [entry for entry in state.waiting if entry.lifetime not in over]
        if self.grounding is not None:
            self.grounding.lapse(dict.fromkeys(over))
        return bool(over)

    def _take_items(self, update: StreamUpdate) -> None:
        section: Section = Cumulative()
        for item in update.items:
            if isinstance(item, (Cumulative, Volatile, Assert)):
                section = item
            elif isinstance(item, Statement):
                self._take_statement(item, lifetime_of(section, self.state.step))
            elif isinstance(item, Forget):
                self._forget(item)
            elif isinstance(item, Retract):
                self._retract(item.term)

    def _take_statement(self, statement: Statement, lifetime: Lifetime) -> None:
        if (isinstance(lifetime, int) and lifetime < self.state.horizon) or statement.is_tautology:
            return  # its window has passed, or it says nothing, and does not define its head
        grounding, head = self._standing(), statement.head
        if head is None or grounding.atoms.is_open(head):
            self._put(statement, lifetime)
        elif self._is_new(head, grounding):
            self._put(statement, lifetime)
            self._remark(statement)
        elif not statement.body and grounding.atoms.is_true(head):
            return  # said before
        elif grounding.conflicting and signature_of(head) in self.program.external_signatures:
            # clingo grounds no further; a new grounding decides
            self.state.waiting.append(Lapsing(statement, lifetime))
        elif head not in self.state.forgotten and not grounding.atoms.knows(head) and self._may_come(head):
            self.state.waiting.append(Lapsing(statement, lifetime))
        else:
            self.warnings.append(NOT_EXTERNAL.format(head))

    def _standing(self) -> ReactiveGrounding:
        """Return the grounding, not rebuilt for loops: the rules of an update are added together."""
        if self.grounding is None:
            self.grounding = self._build()
        return self.grounding

    def _is_new(self, atom: clingo.Symbol, grounding: ReactiveGrounding) -> bool:
        """Whether the program has no word of ``atom``, so that an update may define it freely."""
        signature = signature_of(atom)
        known = self.program.signatures | self.program.open_signatures
        strange = signature not in known or '"' in str(atom)  # see strings_apart
        return strange and not grounding.atoms.knows(atom) and not grounding.atoms.is_closed(atom)

    def _remark(self, statement: Statement) -> None:
        """Tell, once, of a fact that neither the program nor a rule of the stream has any use for."""
        assert statement.head is not None
        name = str(signature_of(statement.head))
        if statement.body or name in self.state.told:
            return
        self.state.told.add(name)
        entries = [entry.statement for entry in self.state.lapsing]
        rules = [*self.state.permanent, *entries, *(one for _, one in self._update.sections())]
        text = unused_fact(self.program, statement.head, rules)
        self.warnings += [] if text is None else [text]

    def _may_come(self, atom: clingo.Symbol) -> bool:
        return self.program.may_declare(atom, self.state.horizon + 1)

    def _put(self, statement: Statement, lifetime: Lifetime) -> None:
        """Put a statement in force whose head may be defined."""
        self._watch_loops(statement)
        self._standing().add(statement, lifetime)
        if lifetime == FOREVER:
            self.state.permanent.append(statement)
        else:
            self.state.lapsing.append(Lapsing(statement, lifetime))

    def _watch_loops(self, statement: Statement) -> None:
        if statement.head is None or not statement.body:
            return
        if self._dependencies is None:
            self._dependencies = self.program.dependencies.copy()
            for one in self.state.rules():
                self._dependencies.add(*statement_edges(one))
        heads, bodies = statement_edges(statement)
        self.state.cyclic = self.state.cyclic or any(self._dependencies.reaches(head, bodies) for head in heads)
        self._dependencies.add(heads, bodies)

    def _forget(self, item: Forget) -> None:
        """Close the undefined externals of steps; within an update after its statements."""
        if self._forgets is not None:
            self._forgets.append(item)
            return
        grounding = self._standing()
        defined = {entry.statement.head for entry in self.state.lapsing}
        for atom in grounding.declared_between(item.first, item.last):
            if atom not in defined and atom.name != GUARD:
                grounding.atoms.close(atom)
                self.state.forgotten.add(atom)

    def _retract(self, term: clingo.Symbol) -> None:
        if not self._lapse(lambda lifetime: lifetime == Term(term)):
            self.warnings.append(f"Term {term} has not been asserted. The retraction is ignored.")

    def _build(self) -> ReactiveGrounding:
        """Reground the program and add all statements of the state."""
        self.grounding = build_grounding(self.program, self.state, self._dropped)
        self._fall_due(self.grounding)
        return self.grounding

    def remarks(self) -> Iterator[str]:
        """Yield new remarks of clingo on the grounding."""
        told = self.state.told
        if self.grounding is None or not self.grounding.messages.said:
            return
        for one in self.grounding.messages.new_remarks(self.program.parameter_at):
            if str(one) not in told and str(one) not in self.program.warnings:
                told.add(str(one))
                yield str(one)
