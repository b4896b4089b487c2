"""Building a grounding anew from a stream's state."""

from typing import Dict, Iterator, Tuple

from rosoclingo.oclingo.engine import Engine
from rosoclingo.oclingo.program import ReactiveProgram
from rosoclingo.oclingo.state import Lifetime, StreamState

BLOCK = 64
"""Steps that are grounded at once."""


def _block_ends(state: StreamState, first: int, block: int) -> Iterator[int]:
    """Yield the last steps of the blocks from ``first`` to the horizon; one ends where steps may be retired."""
    while first <= state.horizon:
        last = min(first + block - 1, state.horizon)
        if first < state.keep_from <= last:
            last = state.keep_from - 1
        yield last
        first = last + 1


def build_engine(program: ReactiveProgram, state: StreamState, shortest: bool) -> Tuple[Engine, Dict[Lifetime, int]]:
    """Ground ``program`` up to the state's horizon and put in force all that ``state`` holds.

    Returns the engine and the guards of what will lapse. Nothing is searched in between, so that clingo sees all rules
    together: loops over several steps and several rules for one head are what they are in a program of one piece.
    """
    facts = {one.head for one in state.permanent if one.head is not None and not one.body}
    guards: Dict[Lifetime, int] = {}
    engine = Engine(program, state.open_atoms, facts, shortest, state.past)
    for last in _block_ends(state, engine.horizon + 1, BLOCK if shortest else 1):
        engine.ground_to(last)
    for atom in state.forgotten:
        engine.atoms.close(atom)
    for cycle, executed in state.closed_cycles.items():
        engine.close_cycle(cycle, executed)
    given = set(state.open_atoms) & facts
    for statement in state.permanent:
        if statement.body or statement.head not in given:
            engine.atoms.add(statement, None)
    for entry in state.lapsing:
        if entry.lifetime not in guards:
            guards[entry.lifetime] = engine.new_guard()
        entry.guard = guards[entry.lifetime]
        engine.atoms.add(entry.statement, entry.guard)
    for cycle in sorted(state.closed_cycles)[:-1]:
        engine.close_returns(cycle)
    engine.atoms.end_definitions()
    return engine, guards
