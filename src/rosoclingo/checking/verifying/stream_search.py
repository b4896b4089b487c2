"""Goes all ways that a core can go with a program, those with the fewest events first, and notes what is wrong.

A way counts its events: goals, cancels, facts and failures. What goes as planned counts for nothing, so each way is
gone to its end. Of ways that lead to equal states the first is gone on with.
"""

import heapq
from itertools import count
from typing import Callable, Dict, FrozenSet, Hashable, Iterator, List, NamedTuple, Optional, Set, Tuple

from clingo import Symbol

from rosoclingo.checking.verifying.beliefs import Belief, Beliefs
from rosoclingo.checking.verifying.findings import Finding, Suspicion
from rosoclingo.checking.verifying.moves import Deed, Move, Moves, Repertory, done_after, thing_of
from rosoclingo.checking.verifying.scope import Kind, Limits
from rosoclingo.checking.verifying.shared_solver import Choices, SharedSolver, Streams
from rosoclingo.checking.verifying.trial_core import BrokenError, TrialCore
from rosoclingo.checking.verifying.ways import Node, Step, circles
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.planning.question import StoppedError
from rosoclingo.reasoning.events import GoalChanged
from rosoclingo.reasoning.explanations import text_of
from rosoclingo.reasoning.keywords import cancellation, request
from rosoclingo.reasoning.settings import CoreSettings

PATIENCE = 3
"""So many times as many updates as a plan may have steps a goal may take while all goes as planned."""


class Progress(NamedTuple):
    """How far a search has come.

    Attributes:
        proven: all ways of so many events were gone; -1 where not even those of none.
        states: how many different states were met.
        moves: how many moves were made.
        searches: how often the solver was asked.

    """

    proven: int
    states: int
    moves: int
    searches: int


class Search:
    """A search for ways on which a program fails.

    Attributes:
        findings: what was found, of each kind the shortest way, in the order of their lengths.

    """

    def __init__(
        self,
        program: ReactiveProgram,
        repertory: Repertory,
        limits: Limits,
        halt: Callable[[], bool] = lambda: False,
        skipped: FrozenSet[Kind] = frozenset(),
    ) -> None:
        """Prepare it; ``halt`` ends it. Findings of kinds that are ``skipped`` do not."""
        self._program, self._limits, self._halt = program, limits, halt
        self._beliefs = Beliefs(program, limits.late if repertory.facts else 0)
        known = list(first_facts(program, repertory))
        self._streams = Streams(program, known, self._beliefs.readers, halt, limits.all_plans)
        self._things = {one.arguments[-1] for one in repertory.goals}
        self._moves = Moves(program, repertory, limits)
        self._settings = CoreSettings(horizon_limit=limits.steps, search_timeout=0.0)
        self._met: Dict[Hashable, Node] = {}
        self._waiting: List[List[Tuple[int, int, Node]]] = [[] for _ in range(limits.events + 1)]
        self._suspicion = Suspicion(skipped)
        self._count, self._made = count(), 0
        self._twins: List[Tuple[Node, Node, Node, Move]] = []  # after success, after failure, before, and the failure
        self.findings: List[Finding] = []

    def run(self) -> Progress:
        """Go all ways until something is found, all are gone, or it is stopped."""
        proven = -1
        try:
            self._begin()
            for cost in range(self._limits.events + 1):
                self._go_ways_of(cost)
                self._look_for_circles(cost)
                self._look_for_failures(cost)
                self.findings = self._suspicion.of(cost)
                if self.findings:
                    break
                proven = cost
        except StoppedError:
            self.findings = self._suspicion.of(self._limits.events)
        return Progress(proven, len(set(self._met.values())), self._made, self._streams.searches)

    def _begin(self) -> None:
        self._learn_returns()
        core = TrialCore(self._program, self._make_solver, self._settings)
        core.start()
        node = Node(core.snapshot(), None, None)
        solver = core.solver
        assert isinstance(solver, SharedSolver)
        if solver.found is None:
            step = Step(Move(), (str(solver.log.update),))
            self._suspicion.add(Finding(Kind.NO_ANSWER, (step,), "before anything has happened", 0))
            return
        self._complete(node, core)
        self._enter(node, [self._key(node, core, late) for late in {0, self._beliefs.late}])

    def _learn_returns(self) -> None:
        """Know all returns of actions that the program may take, lest it be ground anew for each."""
        before = -1
        while before != len(self._streams.known):
            before = len(self._streams.known)
            self._streams.learn(self._moves.returns(self._streams.actions()))

    def _make_solver(self) -> SharedSolver:
        return SharedSolver(self._streams)

    def _go_ways_of(self, cost: int) -> None:
        while self._waiting[cost]:
            _, _, node = heapq.heappop(self._waiting[cost])
            self._go_on(node, cost)
            node.snapshot = None  # nobody comes back to it

    def _go_on(self, node: Node, cost: int) -> None:
        """Make all moves of a node."""
        core = self._core_at(node)
        if not (node.awaited or node.due) and node.goals:
            self._suspicion.add(Finding(Kind.NEVER_ENDED, tuple(node.way), ", ".join(node.goals), cost))
        if node.quiet > PATIENCE * self._limits.steps and node.goals:
            self._suspicion.add(Finding(Kind.NEVER_ENDED, tuple(node.way), ", ".join(node.goals), cost, circular=True))
            return
        left, done = self._limits.events - cost, []  # type: int, List[Node]
        for move in self._moves.of(node.awaited, core.live_goals, core.next_step, node.due, left):
            if self._halt():
                raise StoppedError
            for after in self._ways(node, move):
                if move.cost == 0:
                    done.append(after)
                elif not move.happenings and len(move.failures) == 1:
                    self._twins += [(one, after, node, move) for one in done]

    def _core_at(self, node: Node) -> TrialCore:
        return TrialCore(self._program, self._make_solver, self._settings, node.snapshot)

    def _ways(self, node: Node, move: Move) -> Iterator[Node]:
        """Make a move, with each of the answers that the solver may give."""
        choices: Optional[Choices] = Choices()
        while choices is not None:
            self._streams.choices = choices
            self._made += 1
            after = self._make(node, move)
            if after is not None:
                yield after
            choices = self._streams.choices.following()

    def _make(self, node: Node, move: Move) -> Optional[Node]:
        core = self._core_at(node)
        try:
            core.make(move)
        except BrokenError as broken:
            self._note_broken(node, move, core, broken)
            return None
        if not core.updates:  # nothing new was told
            return None
        ended = [one for one in core.events if isinstance(one, GoalChanged) and one.outcome is not None]
        solver = core.solver
        assert isinstance(solver, SharedSolver)
        actions = solver.found.actions if solver.found is not None else frozenset()
        ends = tuple(f"{one.term} {one.outcome.name.lower()}" for one in ended if one.outcome is not None)
        step = Step(move, tuple(one.stream for one in core.updates), core.cycle, actions, ends)
        following = Node(core.snapshot(), node, step)
        self._complete(following, core)
        self._note_forbidden(following, core, solver)
        late = 0 if following.cost >= self._limits.events else self._beliefs.late
        key = self._key(following, core, late)
        known = self._met.get(key)
        if known is None:
            self._enter(following, {key, self._key(following, core, 0)} if late else {key})
        if move.cost == 0:
            node.onward.append((step, known or following))
        return following

    def _complete(self, node: Node, core: TrialCore) -> None:
        node.awaited, node.due = core.awaited, core.due
        node.goals = tuple(str(one) for one in core.live_goals)
        if node.before is not None and node.step is not None:
            move = node.step.move
            node.done = done_after(node.before.done, move, self._things)
            asked = all(one.kind == "ask" for one in move.happenings)
            node.calm = node.before.calm and asked and not move.failures
        node.answers = self._belief(core, 0).has_answers
        node.state = self._key(node, core, 0)
        node.now = self._belief(core, 0).without_answers(), self._goals_of(core)

    def _enter(self, node: Node, keys: "Set[Hashable] | List[Hashable]") -> None:
        for key in keys:
            self._met.setdefault(key, node)
        heapq.heappush(self._waiting[node.cost], (node.length, next(self._count), node))

    # -- what makes states equal

    def _key(self, node: Node, core: TrialCore, late: int) -> Hashable:
        belief = self._belief(core, late)
        return late, belief, self._goals_of(core), node.done, tuple(one._replace(cycle=0) for one in node.awaited)

    def _belief(self, core: TrialCore, late: int) -> Belief:
        solver = core.solver
        assert isinstance(solver, SharedSolver)
        assert solver.found is not None
        return self._beliefs.of(solver.found.read[1 if late else 0], solver.snapshot, late)

    @staticmethod
    def _goals_of(core: TrialCore) -> Hashable:
        goals = [
            (one.term, one.state, one.known, one.refused, _ahead(one.request_cycle, core.next_step))
            for one in core.live_goals
        ]
        return tuple(goals), core.pending, core.due

    # -- what is wrong

    def _note_broken(self, node: Node, move: Move, core: TrialCore, broken: BrokenError) -> None:
        kind = Kind(broken.kind)
        sent = [one.stream for one in core.updates]
        last = str(broken.stream.update)
        step = Step(move, tuple(sent) if last in sent else (*sent, last))
        text = "with its goals or without them"
        if broken.withheld:
            text = "be its goals cancelled or not; there would be one had they never been asked for"
        stream = broken.stream if kind is Kind.NO_ANSWER else None
        self._suspicion.add(Finding(kind, (*node.way, step), text, node.cost + move.cost, broken=stream))

    def _note_forbidden(self, node: Node, core: TrialCore, solver: SharedSolver) -> None:
        cost, way = node.cost, tuple(node.way)
        if solver.found is not None and solver.found.read[2]:
            never = min(solver.found.read[2], key=str)
            self._suspicion.add(Finding(Kind.FORBIDDEN, way, text_of(never.arguments[0]), cost))
        for fault in core.plan.faults:
            self._suspicion.add(Finding(Kind.MALFORMED, way, fault, cost))
        for one in node.awaited:
            if Deed(one.interface, thing_of(one.parameter, self._things), again=True) in node.done:
                found = Finding(Kind.REPEATED, way, str(one.atom), cost, str(one.interface))
                self._suspicion.add_repeated(found, node.calm)

    def _look_for_failures(self, cost: int) -> None:
        """Find failures after which the program goes on as after success, all else being equal."""
        for success, failure, node, move in self._twins:
            if failure.cost > cost or not self._are_alike(success, failure):
                continue
            (answer,) = move.failures
            way = (*node.way, *((failure.step,) if failure.step is not None else ()))
            self._suspicion.add(Finding(Kind.FAILURE_AS_SUCCESS, way, answer.text, failure.cost))

    @staticmethod
    def _are_alike(success: Node, failure: Node) -> bool:
        """Tell whether as much is believed after a failure as after success, or all goals have ended in the same way.

        How actions have ended may still matter a step later.
        """
        if _end_alike(success, failure):
            return True
        if success.now != failure.now:
            return False
        matters = success.answers or failure.answers
        return not matters or any(one.now == other.now for _, one in success.onward for _, other in failure.onward)

    def _look_for_circles(self, cost: int) -> None:
        nodes = [one for one in set(self._met.values()) if one.cost <= cost]
        for circle in circles(sorted(nodes, key=lambda one: (one.cost, one.length))):
            kind = Kind.NEVER_ENDED if circle.acts else Kind.PUT_OFF
            way = (*circle.node.way, *circle.steps)
            self._suspicion.add(Finding(kind, way, ", ".join(circle.node.goals), circle.node.cost, circular=True))


def _ahead(cycle: Optional[int], step: int) -> Optional[int]:
    """Return how far a request's cycle lies ahead; how long ago one is does not matter."""
    return None if cycle is None else max(cycle - step, -1)


def _end_alike(success: Node, failure: Node) -> bool:
    """Tell whether a goal has succeeded, and nothing is left to do, after failure of the action as after success."""
    if success.step is None or failure.step is None or len(failure.step.move.answers) != 1:
        return False
    over = not (failure.goals or failure.awaited or failure.due)
    ends = failure.step.ends
    return over and success.step.ends == ends and any(end.endswith("succeeded") for end in ends)


def first_facts(program: ReactiveProgram, repertory: Repertory) -> Iterator[Symbol]:
    """Yield what may come, of cycle 1, but for returns."""
    yield from repertory.facts
    for goal in repertory.goals:
        yield request(goal, 1)
        yield cancellation(goal.arguments[-1], 1)
