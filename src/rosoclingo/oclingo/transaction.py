"""Taking one update: what it changes in the stream's state and in the grounding, all or nothing.

A transaction works on a copy of the state. While the grounding fits the state it is changed in place; where a change
can't be made in place (an open external that a grounded step could see, a loop over several steps) it is dropped and
made anew.
"""

from dataclasses import dataclass
from typing import Callable, Dict, FrozenSet, List, Optional, Set

import clingo

from rosoclingo.oclingo.building import build_engine
from rosoclingo.oclingo.engine import Engine
from rosoclingo.oclingo.errors import SolverError
from rosoclingo.oclingo.program import ReactiveProgram
from rosoclingo.oclingo.progression import Assert, Cumulative, Forget, Retract, Statement, StreamUpdate, Volatile
from rosoclingo.oclingo.retiring import first_step, is_due, is_too_late, retire
from rosoclingo.oclingo.signatures import Dependencies, Signature, signature_of
from rosoclingo.oclingo.state import FOREVER, UPDATE, Entry, Lifetime, StreamState, Term, lifetime_of
from rosoclingo.oclingo.strings import holds_string_apart

_NOT_EXTERNAL = "Head {} has not been declared external. The entire rule will be ignored."
_TOO_LATE = "Head {} comes too late: what concerns steps before {} is over. The entire rule will be ignored."


@dataclass
class Setting:
    """What all transactions of a solver share.

    Attributes:
        program: the reactive logic program.
        horizon_limit: the last step that may be grounded, None for no limit.
        dependencies: who depends on whom, updates included.
        shortest: whether answers are searched from step k on (see :class:`~rosoclingo.oclingo.solver.ReactiveSolver`).

    """

    program: ReactiveProgram
    horizon_limit: Optional[int]
    dependencies: Dependencies
    shortest: bool


class Transaction:
    """One update on its way into a stream's state.

    Attributes:
        state: the state as it will be; the caller keeps it if all goes well.
        engine: the grounding that fits :attr:`state`, None where it has to be made anew.
        warnings: what was ignored.
        touched: True once the engine that was given no longer fits the old state.

    """

    def __init__(self, setting: Setting, state: StreamState, engine: Optional[Engine]) -> None:
        self.program, self.state, self.engine = setting.program, state, engine
        self.warnings: List[str] = []
        self.touched = False
        self._limit = setting.horizon_limit
        self._dependencies = setting.dependencies
        self._shortest = setting.shortest
        self._guards: Dict[Lifetime, int] = {}
        self._given: Set[clingo.Symbol] = set()  # facts of this update that the grounding knows already

    def begin(self, update: Optional[StreamUpdate], halt: Callable[[], bool]) -> bool:
        """Ground up to the update's step and add its statements; False where ``halt`` stopped it on the way."""
        state = self.state
        step = state.step if update is None or update.step is None else update.step
        self._check_limit(max(state.horizon, step))
        self.touched = True
        if update is not None:
            self.warnings.extend(update.warnings)
            self._lapse([entry for entry in state.lapsing + state.waiting if entry.lifetime == UPDATE])
            self._retire(along=False)
            if update.step is not None:
                state.step = update.step
                state.bound = None if update.bound is None else update.step + update.bound
            self._open_heads(update)
        complete = self._ground_to(max(state.horizon, step), halt)
        if update is not None:
            self._standing().atoms.end_definitions()
            self._take_items(update)
        return complete

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

    def may_grow(self) -> bool:
        """Whether the bound and the limit of the horizon allow another step."""
        bound, horizon = self.state.bound, self.state.horizon
        return (bound is None or horizon < bound) and (self._limit is None or horizon < self._limit)

    def grow(self, steps: int = 1) -> None:
        """Ground ``steps`` more steps at once, or fewer where bound or limit come first."""
        ends = (end for end in (self.state.bound, self._limit) if end is not None)
        self._advance(self._standing(), min([self.state.horizon + steps, *ends]))

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
        elif head is None or engine.atoms.is_open(head) or self._is_new(head, engine):
            self._put(statement, lifetime)
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
        return (signature not in known or holds_string_apart(atom)) and not engine.atoms.knows(atom)

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
        head = signature_of(statement.head)
        bodies: Set[Signature] = {signature_of(one.atom) for one in statement.body if one.positive}
        self.state.cyclic = self.state.cyclic or self._dependencies.reaches(head, bodies)
        self._dependencies.add([head], bodies)

    def _forget(self, item: Forget) -> None:
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
        self.engine, self._guards = build_engine(self.program, self.state, self._shortest)
        self._fall_due(self.engine)
        return self.engine
