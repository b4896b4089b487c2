"""States that were reached, the ways there, and circular ways."""

from typing import Dict, FrozenSet, Hashable, Iterable, Iterator, List, NamedTuple, Optional, Set, Tuple

from clingo import Symbol

from rosoclingo.checking.verifying.moves import Done, Move
from rosoclingo.checking.verifying.trial_core import CoreSnapshot
from rosoclingo.reasoning.keywords import Action


class Step(NamedTuple):
    """A move and its effect.

    Attributes:
        move: the events.
        updates: the updates that the core sent.
        cycle: the next cycle.
        chosen: the actions of that cycle.
        ends: how goals ended, in words.

    """

    move: Move
    updates: Tuple[str, ...] = ()
    cycle: int = 0
    chosen: FrozenSet[Symbol] = frozenset()
    ends: Tuple[str, ...] = ()


class StateNode:
    """A state of the core, with the shortest way there.

    Attributes:
        cost: the number of events on the way.
        length: the number of updates on the way.
        quiet: the number of updates since the last event.
        awaited: the running actions.
        goals: the live goals, as text.
        due: whether the core continues without an event.
        calm: whether only goals came on the way, and no action failed.
        done: the deeds on the way.
        state: the key that equal states share as long as no event comes.
        answers: whether later steps see how actions ended.
        now: the belief without returns, and the goals.
        onward: the successors without an event.

    """

    def __init__(
        self, snapshot: Optional[CoreSnapshot], before: Optional["StateNode"] = None, step: Optional[Step] = None
    ) -> None:
        self.snapshot, self.before, self.step = snapshot, before, step
        self.cost = self.length = self.quiet = 0
        if before is not None and step is not None:
            self.cost, self.length = before.cost + step.move.cost, before.length + len(step.updates)
            self.quiet = 0 if step.move.cost else before.quiet + len(step.updates)
        self.awaited: Tuple[Action, ...] = ()
        self.goals: Tuple[str, ...] = ()
        self.due, self.calm = False, True
        self.done: Done = frozenset()
        self.answers = False
        self.state: Hashable = None
        self.now: Tuple[FrozenSet[Symbol], Hashable] = (frozenset(), None)
        self.onward: List[Tuple[Step, StateNode]] = []

    @property
    def way(self) -> Tuple[Step, ...]:
        """The steps from the start."""
        found: List[Step] = []
        node: Optional[StateNode] = self
        while node is not None and node.step is not None:
            found.append(node.step)
            node = node.before
        return tuple(found[::-1])


class Circle(NamedTuple):
    """A way without events that ends in the state in which it begins: ``steps`` from ``node`` on."""

    node: StateNode
    steps: Tuple[Step, ...]

    @property
    def acts(self) -> bool:
        """Whether actions are executed on the way."""
        return any(step.move.answers for step in self.steps)


def circles(nodes: Iterable[StateNode]) -> Iterator[Circle]:
    """Yield circles on which goals are live, at least one if there is any from ``nodes``."""
    known: Set[Hashable] = set()
    for start in nodes:
        if start.state not in known and start.goals:
            yield from _circles_from(start, known)


def _circles_from(start: StateNode, known: Set[Hashable]) -> Iterator[Circle]:
    """Yield the circles that a depth-first search from ``start`` meets."""
    known.add(start.state)
    path: Dict[Hashable, int] = {start.state: 0}
    nodes, steps, branches = [start], [], [iter(start.onward)]  # type: List[StateNode], List[Step], List[Iterator]
    while branches:
        step, node = next(branches[-1], (None, None))
        if step is None or node is None:
            branches.pop()
            path.pop(nodes.pop().state)
            del steps[-1:]
        elif node.state in path:
            place = path[node.state]
            yield Circle(nodes[place], (*steps[place:], step))
        elif node.state not in known and node.goals:
            known.add(node.state)
            path[node.state] = len(nodes)
            nodes.append(node)
            steps.append(step)
            branches.append(iter(node.onward))
