"""What is foreseen: an answer stays one when what it plans is done with success, where its rules do not ask for that.

Let M be an answer, and R the returns of success for actions of M that are to be told. If in every ground rule in
whose body one of R stands, under ``not`` or not, some other literal is false in M, then M and R together are an answer
of the program with R as facts: in both reducts the rules whose bodies M satisfies are the same. It needs no search.

There may be shorter ones then, if in another answer these rules come into play. That can't be where the false literal
is about an action of the same cycle: all answers have the actions that were executed in it, and no others.
"""

from typing import Callable, Collection, Dict, FrozenSet, Iterable, List, NamedTuple, Optional, Sequence, Set, Tuple

import clingo

from rosoclingo.oclingo.program.action_rules import RETURN
from rosoclingo.oclingo.progression.updates import Closed, Cumulative, Over, Statement, StreamUpdate
from rosoclingo.oclingo.solving.atom_table import StepRecorder
from rosoclingo.oclingo.solving.stream_log import Plan, cycle_of


class Mentions:
    """The bodies of ground rules in which externals stand, for externals that came before these rules.

    Attributes:
        watched: the externals' literals.

    """

    def __init__(self) -> None:
        self._bodies: Dict[int, List[Sequence[int]]] = {}
        self.watched: Set[int] = set()
        self._lost: Set[int] = set()  # what else they may bear on is not known

    def watch(self, external: int, is_new: bool) -> None:
        """Note in which bodies ``external`` stands from now on; where it ``is_new`` it has stood nowhere before."""
        if external not in self._bodies:
            self._bodies[external] = []
            self.watched.update((external, -external))
            if not is_new:
                self._lost.add(external)

    def note(self, body: Sequence[int]) -> None:
        """Note the literals of one rule's body."""
        for literal in self.watched.intersection(body):
            self._bodies[abs(literal)].append(body)

    def lose(self, literals: Iterable[int]) -> None:
        """Note that something else than the body of a rule asks for ``literals``."""
        self._lost.update(map(abs, self.watched.intersection(literals)))

    def of(self, external: int) -> Optional[List[Sequence[int]]]:
        """Return the bodies in which ``external`` stands; None where that is not all that may ask for it."""
        return None if external in self._lost else self._bodies.get(external)


class ForesightRecorder(StepRecorder):
    """Records the bodies in which externals stand as well.

    Attributes:
        mentions: these bodies.

    """

    def __init__(self) -> None:
        super().__init__()
        self.mentions = Mentions()

    def rule(self, choice: bool, head: Sequence[int], body: Sequence[int]) -> None:
        """Record a rule."""
        super().rule(choice, head, body)
        if not self.mentions.watched.isdisjoint(body):
            self.mentions.note(body)

    def weight_rule(self, choice: bool, head: Sequence[int], lower_bound: int, body: Sequence[Tuple[int, int]]) -> None:
        """Record a rule with a weighted body."""
        super().weight_rule(choice, head, lower_bound, body)
        self.mentions.lose(literal for literal, _ in body)

    def output_term(self, symbol: clingo.Symbol, condition: Sequence[int]) -> None:
        """Record what a term that is shown asks for."""
        self.mentions.lose(condition)

    def external(self, atom: int, value: clingo.TruthValue) -> None:
        """Record an external of some step."""
        if self._block is not None:
            self.mentions.watch(atom, self._is_new(atom))
        super().external(atom, value)

    def _is_new(self, atom: int) -> bool:
        """Whether no rule has had ``atom`` yet."""
        if atom in self._heads or atom in self._literals or -atom in self._literals:
            return False
        return not any(atom in atoms for atoms in self.atoms.values())


class Foreseen(NamedTuple):
    """The returns of success that may be told without a search.

    Attributes:
        returns: with them the answer stays one.
        certain: those of them with which no other answer comes in, either.

    """

    returns: FrozenSet[clingo.Symbol] = frozenset()
    certain: FrozenSet[clingo.Symbol] = frozenset()


def foresee(
    actions: Iterable[clingo.Symbol],
    literal_of: Callable[[clingo.Symbol], Optional[int]],
    mentions: Mentions,
    rivals: Callable[[int], Collection[int]],
    is_true: Callable[[int], bool],
) -> Foreseen:
    """Return what is foreseen of an answer with these ``actions``.

    ``literal_of`` has the literal of an external that may still be told, ``rivals`` those of the actions of a cycle,
    ``is_true`` tells of the answer.
    """
    returns: Set[clingo.Symbol] = set()
    certain: Set[clingo.Symbol] = set()
    for action in actions:
        told = success_of(action)
        literal = literal_of(told)
        bodies = None if literal is None else mentions.of(literal)
        if bodies is None:
            continue
        false = [[one for one in body if not (one in mentions.watched or is_true(one))] for body in bodies]
        if all(false):
            returns.add(told)
            ours = rivals(cycle_of(action)) if false else ()
            if all(any(abs(one) in ours for one in body) for body in false):
                certain.add(told)
    return Foreseen(frozenset(returns), frozenset(certain))


def success_of(action: clingo.Symbol) -> clingo.Symbol:
    """Return what the interface tells where ``action`` is done with success."""
    return clingo.Function(RETURN.name, action.arguments)


def goes_on(plan: Plan, foreseen: FrozenSet[clingo.Symbol], step: int, update: StreamUpdate) -> bool:
    """Whether ``update`` tells that what is planned for ``step`` was done, with success that is ``foreseen``.

    And nothing else, and that something is left to do. The answer that has the ``plan`` is one after the update then.
    """
    if update.step != step + 1 or plan.last_cycle <= step:
        return False
    due = {action for action in plan.actions if cycle_of(action) == step}
    known = foreseen.intersection(map(success_of, due))
    plain = all(_is_plain(item, known, step) for item in update.items)
    return plain and update.committed == due and Closed(step, step) in update.items


def _is_plain(item: object, known: FrozenSet[clingo.Symbol], step: int) -> bool:
    if isinstance(item, Statement):
        return item.is_commitment or (item.head in known and not item.body)
    return isinstance(item, (Cumulative, Over)) or item == Closed(step, step)
