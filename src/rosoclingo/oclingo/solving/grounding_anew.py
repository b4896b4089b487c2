"""A grounding that is made anew from the state of a stream."""

from typing import Callable, Dict, FrozenSet, Iterable, Iterator, List, Set

import clingo

from rosoclingo.oclingo.errors import DroppedError
from rosoclingo.oclingo.program.action_rules import is_dated_action
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.updates import Statement
from rosoclingo.oclingo.solving.grounding import Grounding
from rosoclingo.oclingo.solving.stream_log import cycle_of
from rosoclingo.oclingo.solving.stream_state import FOREVER, StreamState

BLOCK = 64
"""Steps that are grounded at once."""

CLOSED_BLOCK = 16
"""So many of those whose cycles are closed: what was done in them is known to the next ones."""


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

    Of steps whose cycles are closed little more is ground than what has become of them. But for these nothing is
    searched in between, so that clingo sees all rules together: loops over several steps and several rules
    for one head are what they are in a program of one piece. Atoms that are ``coming`` are known as externals,
    and facts that are ``doubted`` were told where a search says so; where it ``foresees``, answers come with the
    returns that may be told.
    Raises DroppedError where ``dropped``, which is asked before each block of steps, says so.
    """
    facts = state.facts_without(doubted)
    open_atoms = dict.fromkeys([*state.open_atoms, *coming])
    grounding = Grounding(program, open_atoms, facts, shortest, state.past, doubted, foresees)
    start = grounding.horizon + 1
    settles = shortest and program.heads_apart and not (doubted or state.cyclic)
    known = _last_known(state, start) if settles else start - 1
    commitments = _Commitments(state)
    for last in block_ends(state, start, BLOCK if shortest or program.steps_apart else 1, known):
        if dropped():
            raise DroppedError("a stop came while the program was ground anew; what was asked for was dropped")
        first = grounding.horizon + 1
        grounding.ground_to(last)
        if last <= known and not grounding.conflicting:
            commitments.tell(grounding, first, last)
            grounding.simplify()
    _tell(grounding, state, commitments.told, set(open_atoms) & facts)
    return grounding


def _tell(grounding: Grounding, state: StreamState, told: Set[Statement], given: Set[clingo.Symbol]) -> None:
    """Put in force what ``state`` holds, but for the statements ``told`` already and the atoms ``given`` as facts."""
    for atom in state.forgotten:
        grounding.atoms.close(atom)
    for cycle, executed in state.closed_cycles.items():
        grounding.close_cycle(cycle, executed)
    for statement in state.permanent:
        if statement.head not in given and statement not in told:  # a rule for what is given as a fact says no more
            grounding.add(statement, FOREVER)
    for entry in state.lapsing:
        grounding.add(entry.statement, entry.lifetime)
    for cycle in sorted(state.closed_cycles)[:-1]:
        grounding.close_returns(cycle)


def block_ends(state: StreamState, first: int, block: int, known: int) -> Iterator[int]:
    """Yield the last steps of the blocks from ``first`` to the horizon; one ends where steps may be retired.

    Blocks of steps up to the one ``known`` are short.
    """
    while first <= state.horizon:
        last = min(first + block - 1, state.horizon)
        if first <= known:
            last = min(last, known, first + CLOSED_BLOCK - 1)
        if first < state.keep_from <= last:
            last = state.keep_from - 1
        yield last
        first = last + 1


def _last_known(state: StreamState, first: int) -> int:
    """Return the last step from ``first`` on up to which all cycles are closed, the one before where none is."""
    last = first - 1
    while last + 1 in state.closed_cycles:
        last += 1
    return last


class _Commitments:
    """What closed cycles are committed to.

    Attributes:
        told: the statements of it that a grounding was told.

    """

    def __init__(self, state: StreamState) -> None:
        self._closed = state.closed_cycles
        self._of: Dict[int, List[Statement]] = {}
        for statement in state.permanent:
            if statement.is_commitment and is_dated_action(statement.body[0].atom):
                self._of.setdefault(cycle_of(statement.body[0].atom), []).append(statement)
        self.told: Set[Statement] = set()

    def tell(self, grounding: Grounding, first: int, last: int) -> None:
        """Tell ``grounding`` what was done in the cycles ``first`` to ``last``, and what was not."""
        for cycle in range(first, last + 1):
            grounding.close_cycle(cycle, self._closed[cycle])
            for statement in self._of.get(cycle, ()):
                grounding.add(statement, FOREVER)
                self.told.add(statement)
