"""The states that a search has reached, the runs that lead there, and circular runs."""

from typing import Dict, FrozenSet, Hashable, Iterable, Iterator, List, NamedTuple, Optional, Set, Tuple

from clingo import Symbol

from rosoclingo.checking.verifying.moves import Achievements, Move
from rosoclingo.checking.verifying.trial_core import CoreSnapshot
from rosoclingo.reasoning.keywords import Action


class Step(NamedTuple):
    """A move and its effect.

    Attributes:
        move: the events.
        updates: the updates that the core sent.
        cycle: the next cycle.
        chosen: the actions of that cycle.
        ends: the goals that ended, with their outcomes, in words.

    """

    move: Move
    updates: Tuple[str, ...] = ()
    cycle: int = 0
    chosen: FrozenSet[Symbol] = frozenset()
    ends: Tuple[str, ...] = ()


NO_STEP = Step(Move())


class StateNode:
    """A state of the core, with the shortest run that leads there.

    Attributes:
        snapshot: the state of the core; None once it is not needed any more.
        before: the state before the last step; None at the start.
        last: the last step of the run.
        cost: the number of events of the run.
        length: the number of updates of the run.
        quiet: the number of updates since the last event.
        awaited: the running actions.
        goals: the live goals, as text.
        due: whether the core continues without an event.
        calm: whether the run has no events except goals.
        done: the achievements of the run.
        state: the key that equal states share while no event occurs.
        answers: whether later steps can see returns.
        now: the belief without returns, and the goals.
        onward: the successors without an event.

    """

    def __init__(
        self, snapshot: Optional[CoreSnapshot], before: Optional["StateNode"] = None, last: Step = NO_STEP
    ) -> None:
        self.snapshot, self.before, self.last = snapshot, before, last
        self.cost = self.length = self.quiet = 0
        if before is not None:
            self.cost, self.length = before.cost + last.move.cost, before.length + len(last.updates)
            self.quiet = 0 if last.move.cost else before.quiet + len(last.updates)
        self.awaited: Tuple[Action, ...] = ()
        self.goals: Tuple[str, ...] = ()
        self.due, self.calm = False, True
        self.done: Achievements = frozenset()
        self.answers = False
        self.state: Hashable = None
        self.now: Tuple[FrozenSet[Symbol], Hashable] = (frozenset(), None)
        self.onward: List[Tuple[Step, StateNode]] = []

    @property
    def way(self) -> Tuple[Step, ...]:
        """The steps from the start."""
        found: List[Step] = []
        node: Optional[StateNode] = self
        while node is not None and node.before is not None:
            found.append(node.last)
            node = node.before
        return tuple(found[::-1])


class Circle(NamedTuple):
    """A run without events that returns to its first state: ``steps`` from ``node`` on."""

    node: StateNode
    steps: Tuple[Step, ...]

    @property
    def starves(self) -> bool:
        """Whether an action runs all the time and never returns, which no interface does."""
        ended = {one.action.name for step in self.steps for one in step.move.answers}
        return any(one.name not in ended for one in self.node.awaited)

    @property
    def acts(self) -> bool:
        """Whether the run executes actions."""
        return any(step.move.answers for step in self.steps)


def circles(nodes: Iterable[StateNode]) -> Iterator[Circle]:
    """Yield circular runs with live goals that start in ``nodes``, at least one if there are any."""
    known: Set[Hashable] = set()
    for start in nodes:
        if start.state not in known and start.goals:
            yield from _circles_from(start, known)


def _circles_from(start: StateNode, known: Set[Hashable]) -> Iterator[Circle]:
    """Yield the circular runs that a depth-first search from ``start`` finds."""
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
