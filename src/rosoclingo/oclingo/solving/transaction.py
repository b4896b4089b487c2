"""Taking one update: what it changes in the stream's state and in the grounding, all or nothing.

A transaction works on a copy of the state. While the grounding fits the state it is changed in place; where a change
can't be made in place (an open external that a grounded step could see, a loop over several steps) it is dropped and
made anew.
"""

from dataclasses import dataclass
from typing import Callable, Dict, FrozenSet, List, Optional, Set

import clingo

from rosoclingo.oclingo.errors import SolverError
from rosoclingo.oclingo.program.action_rules import is_action_of
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.remarks import likely
from rosoclingo.oclingo.program.signatures import Dependencies, signature_of, statement_edges
from rosoclingo.oclingo.progression.strings import holds_string_apart
from rosoclingo.oclingo.progression.updates import (
    Anew,
    Assert,
    Closed,
    Cumulative,
    Forget,
    Over,
    Retract,
    Statement,
    StreamUpdate,
    Volatile,
)
from rosoclingo.oclingo.solving.compaction import first_step, is_due, is_too_late, retire
from rosoclingo.oclingo.solving.grounding import Engine, build_engine
from rosoclingo.oclingo.solving.stream_state import FOREVER, UPDATE, Entry, Lifetime, StreamState, Term, lifetime_of

_NOT_EXTERNAL = "Head {} has not been declared external. The entire rule will be ignored."
_STRANGE = "No rule and no #external of the program mentions {}: it takes it, but nothing depends on it{}."
_TOO_LATE = "Head {} comes too late: what concerns steps before {} is over. The entire rule will be ignored."


@dataclass
class Setting:
    """What all transactions of a solver share.

    Attributes:
        program: the reactive logic program.
        horizon_limit: the last step that may be grounded, None for no limit.
        shortest: whether answers are searched from step k on (see ``ReactiveSolver``).

    """

    program: ReactiveProgram
    horizon_limit: Optional[int]
    shortest: bool


class Transaction:
    """One update on its way into a stream's state.

    Attributes:
        state: the state as it will be; the caller keeps it if all goes well.
        engine: the grounding that fits :attr:`state`, None where it has to be made anew.
        warnings: what was ignored.
        touched: True once the engine that was given no longer fits the old state.

    """

    def __init__(
        self,
        setting: Setting,
        state: StreamState,
        engine: Optional[Engine],
        dropped: Optional[Callable[[], bool]] = None,
    ) -> None:
        self.program, self.state, self.engine = setting.program, state, engine
        self._dropped = dropped or (lambda: False)
        self.warnings: List[str] = []
        self.touched = False
        self._limit = setting.horizon_limit
        self._shortest = setting.shortest
        self._guards: Dict[Lifetime, int] = {}
        self._given: Set[clingo.Symbol] = set()  # facts of this update that the grounding knows already
        self._dependencies: Optional[Dependencies] = None  # who depends on whom, this update included
        self._update = StreamUpdate()
        self._forgets: Optional[List[Forget]] = None  # what is forgotten after the update's statements

    def begin(self, update: Optional[StreamUpdate], halt: Callable[[], bool]) -> bool:
        """Ground up to the update's step and add its statements; False where ``halt`` stopped it on the way."""
        if update is not None:
            self._look_back(update)
        state = self.state
        step = state.step if update is None or update.step is None else update.step
        self._check_limit(max(state.horizon, step))
        self.touched = True
        if update is not None:
            self._update = update
            self.warnings.extend(update.warnings)
            self._lapse([entry for entry in state.lapsing + state.waiting if entry.lifetime == UPDATE])
            self._retire(along=False)
            if update.step is not None:
                state.step = update.step
                state.bound = None if update.bound is None else update.step + update.bound
            self._open_heads(update)
        self._forgets = []
        complete = self._ground_to(max(state.horizon, step), halt)
        if update is not None:
            self._standing().atoms.end_definitions()
            self._take_items(update)
        forgets, self._forgets = self._forgets, None
        for one in forgets:
            self._forget(one)
        return complete

    def _look_back(self, update: StreamUpdate) -> None:
        """Do what an update says of the past, before anything else of it."""
        if any(isinstance(item, Anew) for item in update.items):
            self.touched, self.engine = True, None
            self.state = StreamState(step=1, horizon=1, forgets_done=self.program.first_step - 1)
        if update.withdrawn:
            self.touched, self.engine = True, None
            self.state = self.state.less(update.withdrawn)
        for item in update.items:
            if isinstance(item, Closed):
                last = self.state.step if update.step is None else update.step
                for cycle in range(max(item.first, self.program.first_step), min(item.last, last) + 1):
                    self.close_cycle(cycle, frozenset(filter(is_action_of(cycle), update.committed)))
            elif isinstance(item, Over) and self._shortest:
                self.state.keep_from = max(self.state.keep_from, item.step)

    def close_cycle(self, cycle: int, executed: FrozenSet[clingo.Symbol]) -> None:
        """Fix the actions of ``cycle`` to ``executed``; returns of the cycle closed before it are complete by now."""
        self.touched = True
        before = max(self.state.closed_cycles, default=None)
        self.state.closed_cycles[cycle] = executed
        if self.engine is not None:
            self.engine.close_cycle(cycle, executed)
            if before is not None:
                self.engine.close_returns(before)

    def ready(self) -> Engine:
        """Return a grounding that fits the state, made anew where there is none or where loops ask for it."""
        if self.engine is None or self.state.cyclic:
            self.engine = self._build()
        self.engine.settle(min(self.state.step, self.state.horizon) if self._shortest else self.state.horizon)
        return self.engine

    @property
    def hopeless(self) -> bool:
        """Whether clingo knows already that nothing can make the program satisfiable any more."""
        return self.engine is not None and self.engine.conflicting

    def may_grow(self) -> bool:
        """Whether the bound and the limit of the horizon allow another step."""
        return self.last_horizon(self.state.horizon + 1) > self.state.horizon

    def last_horizon(self, most: Optional[int] = None) -> int:
        """Return the least of bound, limit and ``most``; the present horizon where there is none."""
        ends = [end for end in (self.state.bound, self._limit, most) if end is not None]
        return min(ends, default=self.state.horizon)

    def grow(self, steps: int = 1) -> None:
        """Ground ``steps`` more steps at once, or fewer where bound or limit come first."""
        self.grow_to(self.last_horizon(self.state.horizon + steps))

    def grow_to(self, horizon: int) -> None:
        """Ground up to ``horizon``, beyond the bound as well: an answer may lie where it was ground to before."""
        self._advance(self._standing(), horizon)

    def _check_limit(self, horizon: int) -> None:
        if self._limit is not None and horizon > self._limit:
            mend = "raise the limit or send a lower step"
            raise SolverError(f"step {horizon} is beyond the horizon limit {self._limit}; {mend}")

    def _open_heads(self, update: StreamUpdate) -> None:
        """Make new atoms of open signatures known; what has been grounded and could have seen one is given up."""
        known = set(self.state.open_atoms)
        fresh: Dict[clingo.Symbol, bool] = {}
        for section, statement in update.sections():
            head = statement.head
            if head is None or head in known or is_too_late(self.program, self.state, head):
                continue
            if self.program.is_open_signature(head):
                fresh[head] = fresh.get(head, False) or (not statement.body and isinstance(section, Cumulative))
        if not fresh:
            return
        self.state.open_atoms.extend(fresh)
        if self.engine is not None:
            new = [atom for atom in fresh if not self.engine.atoms.knows(atom)]
            first = first_step(self.program, self.state)
            if any(self.program.may_see(atom, first, self.engine.horizon) for atom in new):
                self._retire(along=True)
                self.engine = None
            elif new:
                self._given = {atom for atom in new if fresh[atom]}
                self.engine.declare(new, self._given)

    def _retire(self, along: bool) -> None:
        """Let go of the steps that are over, if there are enough: the program is then ground anew without them."""
        if self.engine is not None and is_due(self.program, self.state, self.engine, along):
            self.engine = None if retire(self.program, self.state, self.engine) else self.engine

    def _ground_to(self, horizon: int, halt: Callable[[], bool]) -> bool:
        self.state.horizon = max(self.state.horizon, self.program.first_step)
        engine = self._standing()
        while self.state.horizon < horizon:
            if halt():
                return False
            self._advance(engine, horizon if self._shortest else self.state.horizon + 1)
        return True

    def _advance(self, engine: Engine, horizon: int) -> None:
        """Ground up to ``horizon``, with all that falls due there."""
        self.state.horizon = horizon
        engine.ground_to(horizon)
        self._fall_due(engine)

    def _fall_due(self, engine: Engine) -> None:
        state = self.state
        horizon = state.horizon
        self._lapse([e for e in state.lapsing + state.waiting if isinstance(e.lifetime, int) and e.lifetime < horizon])
        for entry in [
            one for one in state.waiting if one.statement.head is not None and engine.atoms.is_open(one.statement.head)
        ]:
            state.waiting.remove(entry)
            self._put(entry.statement, entry.lifetime)
        while state.forgets_done < horizon:
            state.forgets_done += 1
            for step in self.program.forgotten_at(state.forgets_done):
                if step < state.forgets_done:  # what a step declares itself it cannot forget
                    self._forget(Forget(step, step))

    def _lapse(self, entries: List[Entry]) -> None:
        """End the given lapsing or waiting statements."""
        if not entries:
            return
        gone = {id(entry) for entry in entries}
        self.state.lapsing = [entry for entry in self.state.lapsing if id(entry) not in gone]
        self.state.waiting = [entry for entry in self.state.waiting if id(entry) not in gone]
        guards = sorted({entry.guard for entry in entries if entry.guard is not None})
        if self.engine is not None:
            self.engine.release(guards)

    def _take_items(self, update: StreamUpdate) -> None:
        section: object = Cumulative()
        for item in update.items:
            if isinstance(item, (Cumulative, Volatile, Assert)):
                section = item
            elif isinstance(item, Statement):
                self._take_statement(item, lifetime_of(section, self.state.step))  # type: ignore[arg-type]
            elif isinstance(item, Forget):
                self._forget(item)
            elif isinstance(item, Retract):
                self._retract(item.term)

    def _take_statement(self, statement: Statement, lifetime: Lifetime) -> None:
        if isinstance(lifetime, int) and lifetime < self.state.horizon:
            return  # its window has passed
        engine = self._standing()
        head = statement.head
        if head in self._given and not statement.body and lifetime == FOREVER:
            self.state.permanent.append(statement)
        elif head is None or engine.atoms.is_open(head):
            self._put(statement, lifetime)
        elif self._is_new(head, engine):
            self._put(statement, lifetime)
            self._remark(statement)
        elif not statement.body and engine.atoms.is_true(head):
            return  # said before
        elif engine.conflicting and signature_of(head) in self.program.external_signatures:
            self._wait(statement, lifetime)  # clingo grounds no further; a grounding made anew will tell
        elif is_too_late(self.program, self.state, head):
            self.warnings.append(_TOO_LATE.format(head, first_step(self.program, self.state)))
        elif head in self.state.forgotten or engine.atoms.knows(head) or not self._may_come(head):
            self.warnings.append(_NOT_EXTERNAL.format(head))
        else:
            self._wait(statement, lifetime)

    def _standing(self) -> Engine:
        """Return the engine without making it anew for loops: within an update all rules come together."""
        if self.engine is None:
            self.engine = self._build()
        return self.engine

    def _is_new(self, atom: clingo.Symbol, engine: Engine) -> bool:
        """Whether the program has no word of ``atom``, so that an update may define it freely."""
        signature = signature_of(atom)
        known = self.program.signatures | self.program.open_signatures
        strange = signature not in known or holds_string_apart(atom)
        return strange and not engine.atoms.knows(atom) and not engine.atoms.is_closed(atom)

    def _remark(self, statement: Statement) -> None:
        """Tell, once, of a fact that neither the program nor a rule of the stream has any use for."""
        assert statement.head is not None
        signature = signature_of(statement.head)
        contrary = signature._replace(positive=not signature.positive)
        if statement.body or {signature, contrary} & self.program.signatures or str(signature) in self.program.told:
            return
        self.program.told.add(str(signature))
        entries = [entry.statement for entry in self.state.lapsing]
        rules = [*self.state.permanent, *entries, *(one for _, one in self._update.sections())]
        if not any(signature_of(one.atom) in (signature, contrary) for rule in rules for one in rule.body):
            meant = likely(signature, self.program.external_signatures)
            self.warnings.append(_STRANGE.format(signature, "" if meant is None else f" (is {meant} meant?)"))

    def _may_come(self, atom: clingo.Symbol) -> bool:
        return self.program.may_declare(atom, self.state.horizon + 1)

    def _wait(self, statement: Statement, lifetime: Lifetime) -> None:
        self.state.waiting.append(Entry(statement, lifetime))

    def _put(self, statement: Statement, lifetime: Lifetime) -> None:
        """Put a statement in force whose head may be defined."""
        self._watch_loops(statement)
        engine = self._standing()
        if lifetime == FOREVER:
            engine.atoms.add(statement, None)
            self.state.permanent.append(statement)
            return
        if lifetime not in self._guards:
            self._guards[lifetime] = engine.new_guard()
        engine.atoms.add(statement, self._guards[lifetime])
        self.state.lapsing.append(Entry(statement, lifetime, self._guards[lifetime]))

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
        """Close what is still undefined of steps, within an update once its statements have been taken."""
        if self._forgets is not None:
            self._forgets.append(item)
            return
        engine = self._standing()
        defined = {entry.statement.head for entry in self.state.lapsing}
        for atom in engine.declared_between(item.first, item.last):
            if atom not in defined:
                engine.atoms.close(atom)
                self.state.forgotten.add(atom)

    def _retract(self, term: clingo.Symbol) -> None:
        entries = [one for one in self.state.lapsing + self.state.waiting if one.lifetime == Term(term)]
        if not entries:
            self.warnings.append(f"Term {term} has not been asserted. The retraction is ignored.")
        self._lapse(entries)
        self._guards.pop(Term(term), None)

    def _build(self) -> Engine:
        """Ground the program anew and put in force all that the state holds."""
        self.engine, self._guards = build_engine(self.program, self.state, self._shortest, self._dropped)
        self._fall_due(self.engine)
        return self.engine
