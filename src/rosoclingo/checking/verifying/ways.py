"""The states that were reached, the ways there, and ways that go round in circles."""

from typing import Dict, FrozenSet, Hashable, Iterable, Iterator, List, NamedTuple, Optional, Set, Tuple

from clingo import Symbol

from rosoclingo.checking.verifying.moves import Done, Move
from rosoclingo.checking.verifying.trial_core import CoreSnapshot
from rosoclingo.reasoning.keywords import Action


class Step(NamedTuple):
    """A move, and what the core made of it.

    Attributes:
        move: what came from outside.
        updates: the updates that were sent, as the solver took them.
        cycle: the one that it led to.
        chosen: the actions of that cycle, for who goes the same way.
        ends: how goals ended, in words.

    """

    move: Move
    updates: Tuple[str, ...] = ()
    cycle: int = 0
    chosen: FrozenSet[Symbol] = frozenset()
    ends: Tuple[str, ...] = ()


class Node:
    """A state of the core, with the shortest way there.

    Attributes:
        cost: events on the way.
        length: updates on the way.
        quiet: updates since the last event.
        awaited: the actions under way.
        goals: the goals that have not ended, as text.
        due: whether it goes on by itself.
        calm: whether nothing but goals came on the way, and no action failed.
        done: what was done on the way, and not undone.
        state: what equal nodes share from which on all goes as planned.
        answers: whether steps to come see how actions have ended.
        now: what is believed, less the returns, and the goals.
        onward: where it leads when all goes as planned, and by what.

    """

    def __init__(self, snapshot: CoreSnapshot, before: Optional["Node"], step: Optional[Step]) -> None:
        self.snapshot: Optional[CoreSnapshot] = snapshot
        self.before, self.step = before, step
        self.cost: int = 0 if before is None or step is None else before.cost + step.move.cost
        self.length: int = 0 if before is None or step is None else before.length + len(step.updates)
        self.quiet: int = 0 if before is None or step is None or step.move.cost else before.quiet + len(step.updates)
        self.awaited: Tuple[Action, ...] = ()
        self.goals: Tuple[str, ...] = ()
        self.due, self.calm = False, True
        self.done: Done = frozenset()
        self.answers = False
        self.state: Hashable = None
        self.now: Tuple[FrozenSet[Symbol], Hashable] = (frozenset(), None)
        self.onward: List[Tuple[Step, Node]] = []

    @property
    def way(self) -> List[Step]:
        """The steps from the start."""
        found: List[Step] = []
        node: Optional[Node] = self
        while node is not None and node.step is not None:
            found.append(node.step)
            node = node.before
        return found[::-1]


class Circle(NamedTuple):
    """A way that leads back to where it begins: ``steps`` from ``node`` on, all of which go as planned."""

    node: Node
    steps: Tuple[Step, ...]

    @property
    def acts(self) -> bool:
        """Whether something is done on the way."""
        return any(step.move.answers for step in self.steps)

    @property
    def length(self) -> int:
        """Updates to its beginning, and once round."""
        return self.node.length + sum(len(step.updates) for step in self.steps)


def circles(nodes: Iterable[Node]) -> Iterator[Circle]:
    """Yield circles on which goals are open, one at least where there is any from ``nodes``."""
    known: Set[Hashable] = set()
    for start in nodes:
        if start.state not in known and start.goals:
            yield from _from(start, known)


def _from(start: Node, known: Set[Hashable]) -> Iterator[Circle]:
    """Yield circles that are met on the ways from a node; a search in depth, without recursion."""
    path: Dict[Hashable, int] = {start.state: 0}
    steps: List[Step] = []
    branches = [iter(start.onward)]
    nodes = [start]
    known.add(start.state)
    while branches:
        following = next(branches[-1], None)
        if following is None:
            branches.pop()
            path.pop(nodes.pop().state)
            if steps:
                steps.pop()
            continue
        step, node = following
        place = path.get(node.state)
        if place is not None:
            yield Circle(nodes[place], (*steps[place:], step))
        elif node.state not in known and node.goals:
            known.add(node.state)
            path[node.state] = len(nodes)
            nodes.append(node)
            steps.append(step)
            branches.append(iter(node.onward))
