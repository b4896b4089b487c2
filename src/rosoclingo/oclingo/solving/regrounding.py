"""A grounding made anew, from all that a stream's state holds."""

from typing import Callable, FrozenSet, Iterable, Iterator

import clingo

from rosoclingo.oclingo.errors import DroppedError
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.solving.grounding import Grounding
from rosoclingo.oclingo.solving.stream_state import FOREVER, StreamState, with_their_failures

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


def build_grounding(
    program: ReactiveProgram,
    state: StreamState,
    shortest: bool,
    dropped: Callable[[], bool] = lambda: False,
    coming: Iterable[clingo.Symbol] = (),
    doubted: FrozenSet[clingo.Symbol] = frozenset(),
    foresees: bool = False,
) -> Grounding:
    """Ground ``program`` up to the state's horizon and put in force all that ``state`` holds.

    Nothing is searched in between, so that clingo sees all rules together: loops over several steps and several rules
    for one head are what they are in a program of one piece. Atoms that are ``coming`` are known as externals,
    and facts that are ``doubted`` were told where a search says so; where it ``foresees``, answers come with the
    returns that may be told.
    Raises DroppedError where ``dropped``, which is asked before each block of steps, says so.
    """
    facts = {one.head for one in state.permanent if one.head is not None and not one.body}
    facts -= with_their_failures(doubted)
    open_atoms = dict.fromkeys([*state.open_atoms, *coming])
    grounding = Grounding(program, open_atoms, facts, shortest, state.past, doubted, foresees)
    for last in _block_ends(state, grounding.horizon + 1, BLOCK if shortest or program.steps_apart else 1):
        if dropped():
            raise DroppedError("a stop came while the program was ground anew; what was asked for was dropped")
        grounding.ground_to(last)
    for atom in state.forgotten:
        grounding.atoms.close(atom)
    for cycle, executed in state.closed_cycles.items():
        grounding.close_cycle(cycle, executed)
    given = set(open_atoms) & facts
    for statement in state.permanent:
        if statement.head not in given:  # a rule for what is given as a fact says no more
            grounding.add(statement, FOREVER)
    for entry in state.lapsing:
        grounding.add(entry.statement, entry.lifetime)
    for cycle in sorted(state.closed_cycles)[:-1]:
        grounding.close_returns(cycle)
    return grounding
