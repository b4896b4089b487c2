"""The planner of the core: it closes past cycles, bounds the lookahead, and backtracks to earlier histories.

The state of a planner is its history, which is immutable. A second planner can therefore continue from any prefix of
it, without effect on the first one.
"""

from contextlib import suppress
from dataclasses import replace
from typing import Callable, FrozenSet, Iterable, List, Mapping, NamedTuple, Optional, Sequence, Tuple, TypeVar

from clingo import Symbol

from rosoclingo.oclingo import (
    DroppedError,
    SolveOutcome,
    SolverError,
    SolveResult,
    Statement,
    StreamUpdate,
    Volatile,
    commitment,
)
from rosoclingo.oclingo.progression.updates import CloseCycles, Expire, Item, Reset, Withdraw
from rosoclingo.planning.explaining.questions import Stream
from rosoclingo.planning.history import AcceptedUpdate, History
from rosoclingo.planning.planning_solver import PlanningSolver
from rosoclingo.planning.question import Reply
from rosoclingo.reasoning.input_feeder import Batch
from rosoclingo.reasoning.keywords import Action

T = TypeVar("T")

#: Makes a new solver.
SolverFactory = Callable[[], PlanningSolver]


#: Number of recent cycles without compaction, so that their observations can be named as reasons.
RECENT = 10

#: Number of cycles after which older ones are compacted even if a request was open then.
LONG_AGO = 150

#: Number of cycles that a reset solver closes in one update.
MANY_STEPS = 100


class Halt(NamedTuple):
    """The reason why a search must end.

    ``disturbed`` is true if an arrival has changed the question, so that the result is useless. Otherwise the search
    has taken too long.
    """

    why: str
    disturbed: bool = False


#: Running actions, each with whether the plan of the cycle contains it.
RunningActions = Mapping[Action, bool]

#: Called at the start of each search. The returned function is polled during the search.
SearchWatch = Callable[[], Callable[[], Optional[Halt]]]


def unwatched() -> Callable[[], Optional[Halt]]:
    """Never end a search."""
    return lambda: None


def steps_for(goals: int, alone: int, left: int = 0, fresh: int = 0) -> int:
    """Return the horizon bound for a number of goals, if the bound for one goal is ``alone``.

    Each further goal adds a tenth of ``alone``. The bound is far below the sum for all goals, because a proof that
    there is no plan has to cover all steps. Recovery makes sure that no goal is aborted because the bound is too low.

    If the current plan has steps ``left``, the bound also covers these, and a quarter of ``alone`` for each of the
    ``fresh`` goals and for failures. A plan that extends the current one is found soon. The bound is then rounded up to
    a multiple of ``alone``, so that it does not change with each step.
    """
    if goals <= 1:
        return alone
    more = left + (fresh + 1) * -(-alone // 4)
    return max(alone + (goals - 1) * -(-alone // 10), -(-more // alone) * alone if left else 0)


class DisturbedError(Exception):
    """An arrival has interrupted the search; ``accepted`` is true if the solver has accepted the update."""

    def __init__(self, why: str, accepted: bool) -> None:
        super().__init__(f"the search was interrupted: {why}")
        self.accepted = accepted


class Planner:
    """A planning solver with the conventions of the core. Its history determines all plans.

    Every search can raise DisturbedError. It raises DroppedError if it could be ended only by dropping the update.

    Attributes:
        lookahead: the maximum number of steps from the current cycle to the horizon; derived planners inherit it.
        running: returns the actions, of any cycle, that go on in the cycles that an update closes, each with whether
            the update commits to them; derived planners inherit it.
        ended_by: why the last search was ended, empty if it ended by itself.

    """

    def __init__(
        self,
        make_solver: SolverFactory,
        lookahead: int,
        watch: SearchWatch = unwatched,
        log: Optional[History] = None,
        running: Callable[[], RunningActions] = dict,
    ) -> None:
        """Plan from the start, or continue from ``log``."""
        self._make_solver = make_solver
        self.lookahead, self.running = lookahead, running
        self._watch = watch
        self._solver = make_solver()
        if log is not None:
            self._solver.restore(log)
        self.ended_by = ""

    @property
    def solver(self) -> PlanningSolver:
        """The underlying solver."""
        return self._solver

    @property
    def log(self) -> History:
        """The history of the solver."""
        return self._solver.log

    @property
    def last_update(self) -> StreamUpdate:
        """The last accepted update, with its bound and closed cycles; empty if there is none."""
        return self.log.update or StreamUpdate(self.log.step)

    @property
    def stream(self) -> Stream:
        """The last update and the history before it, for explanations."""
        return Stream(self.log.before_update or History(), self.last_update, self.lookahead)

    def ends_later(self, step: int) -> bool:
        """Return whether each answer ends later than at ``step``."""
        plan = self.log.plan
        return plan is not None and plan.shortest and plan.horizon > step

    def first_open(self, step: int, since: int = 0) -> int:
        """Return the first cycle for which facts can still be fed in the update of ``step``.

        ``since`` is the cycle of the oldest request that still matters. Cycles well before it are closed.
        """
        return max(self.log.keep_from, min(since, step - 1 - RECENT), step - 1 - LONG_AGO)

    def solve(self) -> SolveResult:
        """Solve before any update."""
        return self._search(StreamUpdate(1, self.lookahead))

    def update(self, update: StreamUpdate) -> SolveResult:
        """Feed an update with a step, and solve; raises SolverError, with nothing changed, if the solver refuses it.

        The cycles since the last update are closed: a plan has no other actions in them than those that this update
        commits to.
        """
        return self._search(self._whole(update, self.lookahead))

    def take(self, update: StreamUpdate) -> SolveResult:
        """Feed an update without lookahead; a missing answer counts as interrupted, because it proves nothing."""
        result = self._search(self._whole(update, 0))
        unknown = result.outcome is SolveOutcome.UNSATISFIABLE and not result.permanent
        return replace(result, outcome=SolveOutcome.INTERRUPTED) if unknown else result

    def solve_with(self, actions: Sequence[Action]) -> Optional[SolveResult]:
        """Return an answer whose plan contains these actions and ends with the last of them; None if there is none."""
        steps = max(action.cycle for action in actions) - self.log.step
        update = StreamUpdate(self.log.step, steps, (Volatile(), *(commitment(action.atom) for action in actions)))
        try:
            result = self.restarted()._search(update)
        except SolverError:
            return None
        return result if result.outcome is SolveOutcome.SATISFIABLE else None

    def inquire(
        self, update: StreamUpdate, assumable: FrozenSet[Symbol], disabled: FrozenSet[Symbol], steps: int
    ) -> Reply:
        """Return whether there would be a plan of at most ``steps`` after ``update`` without the facts ``disabled``.

        The history does not change. The ``disabled`` facts are a subset of the ``assumable`` ones. The grounding is
        reused if only the disabled facts and the steps change.
        """
        whole = self._whole(update, steps)
        return self._watched(
            lambda stopped: self._solver.inquire(whole, assumable, disabled, stopped),
            lambda reply: reply.satisfiable is None,
        )

    def can_begin_with(self, action: Symbol, steps: int) -> bool:
        """Return whether a plan of ``steps`` steps after this one can contain ``action``; True if undecided."""
        update = StreamUpdate(self._solver.step, steps, (Volatile(), commitment(action)))
        return self._search(update).outcome is not SolveOutcome.UNSATISFIABLE

    def improve(self, stopped: Callable[[], bool]) -> Optional[SolveResult]:
        """Return a shorter plan with the same past and present; None if there is none or ``stopped`` comes first."""
        try:
            return self._solver.improve(stopped)
        except SolverError:  # the history is unchanged
            return None

    def compact(self, stopped: Callable[[], bool]) -> None:
        """Replace a long history by a checkpoint, so that workers can load it quickly, unless ``stopped``."""
        with suppress(SolverError):  # the history is unchanged
            self._solver.compact(stopped)

    def prepare(
        self, updates: Sequence[StreamUpdate], lookahead: int, running: Optional[RunningActions] = None
    ) -> bool:
        """Prefetch the answer to the last of ``updates``, without waiting; return whether the prefetch has begun.

        The current plan must be a plan for all other updates. ``lookahead`` applies to all of them. ``running`` are
        the actions that go on, by default those that run now.
        """
        running = self.running() if running is None else running
        log, whole = self.log, []  # type: History, List[StreamUpdate]
        for update in updates:
            whole.append(_whole(log, update, lookahead, running))
            log = log.with_entries(AcceptedUpdate(whole[-1], log.horizon))
        return self._solver.prefetch(whole[-1], whole[:-1])

    def has_prepared(self, update: StreamUpdate, watch: Optional[SearchWatch] = None) -> bool:
        """Return whether the answer to ``update``, as the next update, was prefetched; wait until ``watch`` ends."""
        whole = self._whole(update, self.lookahead)
        if watch is None:
            return self._solver.has_prefetched(whole)
        look = watch()
        return self._solver.has_prefetched(whole, lambda: look() is not None)

    def predicts(self, update: StreamUpdate) -> bool:
        """Return whether ``update``, as the next update, needs no search."""
        return self._solver.predicts(self._whole(update, self.lookahead))

    def why_none(self, result: SolveResult) -> str:
        """Return why the last search, with this ``result``, found no plan."""
        if result.outcome is SolveOutcome.INTERRUPTED:
            return "no plan was found before the search was ended" + (f": {self.ended_by}" if self.ended_by else "")
        return f"there is no plan of at most {self.lookahead} steps"

    def restarted(self, without: FrozenSet[Symbol] = frozenset()) -> "Planner":
        """Return another planner with the same history, except for the facts ``without``, and with a short horizon."""
        before, last = self.log.before_update, self.last_update
        if before is None:
            return self.with_log(self.log.withdraw(without))
        entry = AcceptedUpdate(last.without_facts(without), last.step or before.step)
        return self.with_log(before.withdraw(without).with_entries(entry))

    def with_log(self, log: History) -> "Planner":
        """Return another planner with the history ``log``."""
        return Planner(self._make_solver, self.lookahead, self._watch, log, self.running)

    def before_update(self) -> "Planner":
        """Return another planner without the last update."""
        return self.with_log(self.log.before_update or History())

    def replace_update(self, update: StreamUpdate) -> Tuple["Planner", SolveResult]:
        """Return another planner with ``update`` in place of the last one, and its result."""
        planner = self.before_update()
        return planner, planner.update(update)

    def corrected(self, gone: FrozenSet[Symbol], new: Iterable[Symbol] = ()) -> Tuple["Planner", SolveResult]:
        """Return another planner whose last update has ``new`` facts in place of ``gone`` ones, and its result.

        The update withdraws the ``gone`` facts that earlier updates stated.
        """
        update = self.last_update
        present = update.heads | update.committed
        stated = (Statement(one) for one in dict.fromkeys(new) if one not in present - gone)
        items = (*map(Withdraw, sorted(gone - present)), *update.without_facts(gone).items, *stated)
        return self.replace_update(replace(update, items=items))

    def reset(self, step: int) -> Tuple["Planner", List[StreamUpdate], SolveResult]:
        """Return a planner that starts at ``step`` without a history, the updates that it was fed, and the result."""
        planner = self.with_log(History())
        stops = [*range(MANY_STEPS, step, MANY_STEPS), step]
        fed: List[StreamUpdate] = []
        for last, now in zip([0, *stops], stops):
            past = (CloseCycles(last, now - 1), Expire(now - RECENT)) if now > 1 else ()
            going_on = dict.fromkeys(self.running(), False) if now == step else {}
            items = _with_running(past if last else (Reset(), *past), [now - 1], going_on)
            result = planner.update(StreamUpdate(now, items=tuple(items)))
            fed.append(planner.last_update)
        return planner, fed, result

    def _whole(self, update: StreamUpdate, lookahead: int) -> StreamUpdate:
        return _whole(self.log, update, lookahead, self.running())

    def _search(self, update: StreamUpdate) -> SolveResult:
        return self._watched(
            lambda stopped: self._solver.update(update, stopped),
            lambda result: result.outcome is SolveOutcome.INTERRUPTED,
        )

    def _watched(self, ask: Callable[[Callable[[], bool]], T], is_undecided: Callable[[T], bool]) -> T:
        """Return the result of a search; record why it was stopped, or raise DisturbedError after an arrival."""
        look, halt = self._watch(), None  # type: Callable[[], Optional[Halt]], Optional[Halt]
        dropped: Optional[DroppedError] = None

        def stopped() -> bool:
            """Return whether the search must end; keeps the first reason."""
            nonlocal halt
            halt = halt or look()
            return halt is not None

        self.ended_by = ""
        try:
            result = ask(stopped)
        except DroppedError as error:
            dropped = error
        else:
            if not is_undecided(result):
                return result
        self.ended_by = halt.why if halt else ""
        if halt and halt.disturbed:
            raise DisturbedError(halt.why, accepted=dropped is None)
        if dropped is not None:
            raise dropped
        return result


def _whole(log: History, update: StreamUpdate, lookahead: int, running: RunningActions) -> StreamUpdate:
    """Return ``update`` with its bound and the cycles that it closes, without items that ``log`` already implies."""
    known = [item for item in update.items if isinstance(item, Expire) and item.step <= log.keep_from]
    items = tuple(item for item in update.items if item not in known)
    if update.step is not None and update.step > log.step and not any(isinstance(one, CloseCycles) for one in items):
        items = (CloseCycles(log.step, update.step - 1), *_with_running(items, range(log.step, update.step), running))
    return replace(update, bound=lookahead, items=items)


def _with_running(items: Sequence[Item], cycles: Iterable[int], running: RunningActions) -> Sequence[Item]:
    """Return ``items`` with the actions that go on in the closed ``cycles``, after the other commitments."""
    if not running:
        return items
    place = max((n for n, one in enumerate(items, 1) if not isinstance(one, Statement) or one.is_commitment), default=0)
    dated = [(action._replace(cycle=cycle), planned) for cycle in cycles for action, planned in running.items()]
    done = [commitment(action.atom) for action, planned in dated if planned]
    going_on = [Statement(action.running) for action, _ in dated]
    return (*items[:place], *(one for one in done if one not in items), *going_on, *items[place:])


def split_batch(planner: Planner, batch: Batch, result: SolveResult) -> Tuple[Planner, Batch, SolveResult]:
    """Return the planner to continue with after the ``result`` of a batch, the batch that it was fed, and its result.

    The messages of one origin take effect in successive cycles of one update, and all of these except the last are
    idle. A program that requires an action in each cycle has no answer then. Such a program is fed the first messages
    now, and the others in later updates.
    """
    if batch.first is None or result.outcome is not SolveOutcome.UNSATISFIABLE:
        return planner, batch, result
    try:
        _, idle = planner.replace_update(batch.without_present_facts)
        if idle.outcome is not SolveOutcome.UNSATISFIABLE:
            return planner, batch, result
        other, found = planner.replace_update(batch.first.update)
    except DisturbedError as disturbance:
        disturbance.accepted = True
        raise
    except SolverError:
        return planner, batch, result
    return other, batch.first, found
