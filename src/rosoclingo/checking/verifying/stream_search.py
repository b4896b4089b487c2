"""Explores all runs of a core with a program, those with the fewest events first, and collects defects.

The cost of a run is its number of events: goals, cancels, facts and failures. Successful returns cost nothing, so each
run is followed to its end. Of several runs to equal states, the search continues only the first.
"""

import heapq
from itertools import count
from typing import Dict, FrozenSet, Hashable, Iterator, List, NamedTuple, Optional, Tuple

from clingo import Symbol, SymbolType

from rosoclingo.checking.verifying.beliefs import Belief, Beliefs
from rosoclingo.checking.verifying.defects import Defect, Defects
from rosoclingo.checking.verifying.moves import GOAL, Achievement, Move, Moves, Repertory, achievements_after, thing_of
from rosoclingo.checking.verifying.scope import DefectKind, VerifyLimits
from rosoclingo.checking.verifying.shared_solver import Choices, HaltedError, SharedSolver, Streams
from rosoclingo.checking.verifying.state_graph import StateNode, Step, circles
from rosoclingo.checking.verifying.trial_core import BrokenError, TrialCore
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.planning.question import Stop
from rosoclingo.reasoning.events import GoalChanged
from rosoclingo.reasoning.explanations import text_of
from rosoclingo.reasoning.keywords import NEVER, cancellation, request
from rosoclingo.reasoning.settings import CoreSettings

PATIENCE = 3
"""Greatest number of updates without an event while a goal is live, in multiples of the longest plan."""


class VerifyProgress(NamedTuple):
    """The progress of a search.

    Attributes:
        proven: the number of events up to which all runs were explored; -1 for none.
        states: the number of different states.
        moves: the number of moves.

    """

    proven: int
    states: int
    moves: int


class StreamSearch:
    """A search for runs that show a defect.

    Attributes:
        defects: the defects found, that with the shortest run of each kind, ordered by length.

    """

    def __init__(
        self,
        program: ReactiveProgram,
        repertory: Repertory,
        limits: VerifyLimits,
        halt: Stop,
        skipped: FrozenSet[DefectKind],
    ) -> None:
        """Prepare a search; ``halt`` ends it, and so does the first depth with a defect that is not ``skipped``."""
        self._program, self._limits, self._halt = program, limits, halt
        self._beliefs, self._late = Beliefs(program), limits.late if repertory.facts else 0
        requests = [request(one, 1) for one in repertory.goals]
        cancels = [cancellation(one.arguments[-1], 1) for one in repertory.goals]
        self._streams = Streams(program, [*repertory.facts, *requests, *cancels], halt, limits.all_plans)
        self._things = {one.arguments[-1] for one in repertory.goals}
        self._moves = Moves(program, repertory, limits)
        self._settings = CoreSettings(horizon_limit=limits.steps, search_timeout=0.0)
        self._met: Dict[Hashable, StateNode] = {}
        self._waiting: List[List[Tuple[int, int, StateNode]]] = [[] for _ in range(limits.events + 1)]
        self._found = Defects(skipped)
        self._count, self._made = count(), 0
        self._twins: List[Tuple[StateNode, StateNode]] = []  # successors of a state, after success and after failure
        self.defects: List[Defect] = []

    def run(self) -> VerifyProgress:
        """Explore runs until a depth has a defect, all runs are explored, or the search is stopped."""
        proven = -1
        try:
            self._begin()
            for cost in range(self._limits.events + 1):
                while self._waiting[cost]:
                    self._expand(heapq.heappop(self._waiting[cost])[-1])
                self._note_circles(cost)
                self._note_hidden_failures(cost)
                self.defects = self._found.shortest(cost)
                if self.defects:
                    break
                proven = cost
        except HaltedError:
            self.defects = self._found.shortest(self._limits.events)
        return VerifyProgress(proven, len(set(self._met.values())), self._made)

    def _begin(self) -> None:
        while self._streams.learn(self._moves.returns(self._streams.actions())):
            pass  # returns can make further actions possible
        core = self._core_at(None)
        core.start()
        if core.solver.found is None:
            step = Step(Move(), (str(core.solver.log.update),))
            self._found.add(Defect(DefectKind.NO_ANSWER, (step,), "even before the first event", 0))
            return
        node = StateNode(core.snapshot())
        self._complete(node, core)
        self._enter(node, self._key(node, core, self._late))

    def _core_at(self, node: Optional[StateNode]) -> TrialCore:
        snapshot = None if node is None else node.snapshot
        return TrialCore(self._program, lambda: SharedSolver(self._streams), self._settings, snapshot)

    def _expand(self, node: StateNode) -> None:
        """Make all moves of a node."""
        core, goals = self._core_at(node), ", ".join(node.goals)
        endless = bool(goals) and node.quiet > PATIENCE * self._limits.steps
        if endless or (goals and not (node.awaited or node.due)):
            self._add(DefectKind.NEVER_ENDED, node, goals, circular=endless)
        left = self._limits.events - node.cost
        moves = self._moves.moves(node.awaited, core.live_goals, core.next_step, node.due, left)
        successes: List[StateNode] = []
        for move in () if endless else moves:
            if self._halt():
                raise HaltedError
            for after in self._successors(node, move):
                if move.cost == 0:
                    successes.append(after)
                elif not move.arrivals and len(move.failures) == 1:
                    self._twins += [(one, after) for one in successes if one.last.move.ends_as(move)]
        node.snapshot = None  # no longer needed

    def _successors(self, node: StateNode, move: Move) -> Iterator[StateNode]:
        """Make a move; yield a node for each answer that the solver can give."""
        choices: Optional[Choices] = Choices()
        while choices is not None:
            self._streams.choices = choices
            self._made += 1
            core = self._core_at(node)
            try:
                core.make(move)
            except BrokenError as broken:
                self._note_broken(node, move, core, broken)
            else:
                if core.updates:
                    yield self._successor(node, move, core)
            choices = self._streams.choices.following()

    def _successor(self, node: StateNode, move: Move, core: TrialCore) -> StateNode:
        changes = [one for one in core.events if isinstance(one, GoalChanged)]
        ends = tuple(f"{one.key} {one.outcome.name.lower()}" for one in changes if one.outcome is not None)
        actions = core.solver.found.actions if core.solver.found is not None else frozenset()
        step = Step(move, core.updates, core.cycle, actions, ends)
        after = StateNode(core.snapshot(), node, step)
        self._complete(after, core)
        self._note_forbidden(after, core)
        late = 0 if after.cost >= self._limits.events else self._late
        key = self._key(after, core, late)
        known = self._met.get(key)
        if known is None:
            self._enter(after, key)
        if move.cost == 0:
            node.onward.append((step, known or after))
        return after

    def _complete(self, node: StateNode, core: TrialCore) -> None:
        node.awaited, node.due = core.awaited, core.due
        node.goals = tuple(str(one) for one in core.live_goals)
        if node.before is not None:
            move = node.last.move
            node.done = achievements_after(node.before.done, move, self._things)
            sent = all(one.kind == GOAL for one in move.arrivals)
            node.calm = node.before.calm and sent and not move.failures
        belief = self._belief(core, 0)
        others = belief.without_answers
        node.now, node.answers = (others, _goals_of(core)), others != belief.atoms
        node.state = self._key(node, core, 0)

    def _enter(self, node: StateNode, key: Hashable) -> None:
        """Let a search continue from a node, which stands for all states with its keys."""
        for one in (key, node.state):
            self._met.setdefault(one, node)
        heapq.heappush(self._waiting[node.cost], (node.length, next(self._count), node))

    def _key(self, node: StateNode, core: TrialCore, late: int) -> Hashable:
        """Return the key of equal states, for facts that are at most ``late`` steps late."""
        awaited = tuple(one._replace(cycle=0) for one in node.awaited)
        return late, self._belief(core, late), _goals_of(core), node.done, awaited

    def _belief(self, core: TrialCore, late: int) -> Belief:
        found = core.solver.found
        assert found is not None
        return self._beliefs.belief(found.atoms, core.solver.snapshot, late)

    # -- defects

    def _add(self, kind: DefectKind, node: StateNode, subject: str, about: str = "", circular: bool = False) -> None:
        self._found.add(Defect(kind, node.way, subject, node.cost, about, circular))

    def _note_broken(self, node: StateNode, move: Move, core: TrialCore, broken: BrokenError) -> None:
        last = str(broken.stream.update)
        step = Step(move, core.updates if last in core.updates else (*core.updates, last))
        text = "with or without its goals"
        if broken.withheld:
            text = "even if its goals are cancelled, only if they are never sent"
        stream = broken.stream if broken.kind is DefectKind.NO_ANSWER else None
        cost = node.cost + move.cost
        self._found.add(Defect(broken.kind, (*node.way, step), text, cost, broken=stream))

    def _note_forbidden(self, node: StateNode, core: TrialCore) -> None:
        found = core.solver.found
        never = [] if found is None else [one for one in found.atoms if _is_forbidden(one, core.solver.snapshot.step)]
        if never:
            self._add(DefectKind.FORBIDDEN, node, text_of(min(never, key=str).arguments[0]))
        for fault in core.plan.faults:
            self._add(DefectKind.MALFORMED, node, fault)
        for one in node.awaited:
            if Achievement(one.interface, thing_of(one.parameter, self._things), resent=True) in node.done:
                self._add(DefectKind.REPEATED, node, str(one.atom), str(one.interface))
                if node.calm:
                    self._found.excuse(str(one.interface))

    def _note_hidden_failures(self, cost: int) -> None:
        """Note the failures after which the program continues as after success in the same state."""
        for success, failure in self._twins:
            if failure.cost <= cost and _are_alike(success, failure):
                self._add(DefectKind.FAILURE_AS_SUCCESS, failure, failure.last.move.failures[0].text)

    def _note_circles(self, cost: int) -> None:
        nodes = [one for one in set(self._met.values()) if one.cost <= cost]
        for circle in circles(sorted(nodes, key=lambda one: (one.cost, one.length))):
            if circle.starves:
                continue
            kind = DefectKind.NEVER_ENDED if circle.acts else DefectKind.PUT_OFF
            way, goals = (*circle.node.way, *circle.steps), ", ".join(circle.node.goals)
            self._found.add(Defect(kind, way, goals, circle.node.cost, circular=True))


def _is_forbidden(atom: Symbol, step: int) -> bool:
    """Return whether an atom is a ``_never(Text,C)`` of a cycle up to ``step``."""
    return atom.match(NEVER, 2) and atom.arguments[1].type is SymbolType.Number and atom.arguments[1].number <= step


def _goals_of(core: TrialCore) -> Hashable:
    """Return the state of the goals; past cycles of requests do not matter."""
    ahead = [None if one.request_cycle is None else one.request_cycle - core.next_step for one in core.live_goals]
    goals = (
        (one.term, one.state, one.known, one.refused, None if cycle is None else max(cycle, -1))
        for one, cycle in zip(core.live_goals, ahead)
    )
    return tuple(goals), core.pending, core.due


def _are_alike(success: StateNode, failure: StateNode) -> bool:
    """Return whether beliefs after failure and success are equal, or a goal succeeded and nothing is left to do.

    If later steps can see returns, the next states have to be equal as well.
    """
    ends = failure.last.ends if len(failure.last.move.answers) == 1 else ()
    finished = not (failure.goals or failure.awaited or failure.due)
    if finished and success.last.ends == ends and any(end.endswith("succeeded") for end in ends):
        return True
    if success.now != failure.now:
        return False
    matters = success.answers or failure.answers
    return not matters or any(one.now == other.now for _, one in success.onward for _, other in failure.onward)
