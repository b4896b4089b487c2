"""Drives the pure core in tests: small programs, a journal, and returns on demand."""

import re
from collections import deque
from dataclasses import replace
from functools import partial
from typing import Any, Callable, Deque, List, Optional, Tuple, Type, TypeVar, Union

from shipped import DATA, shipped

from rosoclingo.oclingo import (
    ReactiveProgram,
    SolveOutcome,
    SolverError,
    SolveResult,
    StreamUpdate,
    parse_atom,
    parse_update,
)
from rosoclingo.planning.history import AcceptedUpdate, History
from rosoclingo.planning.planning_solver import PlanningSolver
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.reasoning.core import Core
from rosoclingo.reasoning.events import ActionsDispatched, Event, GoalChanged, GoalProgress, Problem, UpdateSent
from rosoclingo.reasoning.settings import CoreSettings
from rosoclingo.reasoning.stream_planner import Halt, SearchWatch, unwatched

#: One errand per goal ``do(What,Id)``; see the file.
ERRANDS = (DATA / "errands.lp").read_text()

#: Goals ``do(Id)``. The past is over: only open goals go from step to step, as in the shipped programs.
FORGETFUL = """
#external _request/2. #external _return/3.
#program cumulative(t).
open(I,t) :- _request(do(I),t).
open(I,t) :- open(I,t-1), not done(I,t-1).
{ _action_lib(quick,I,t) : open(I,t) }.
done(I,t) :- _action_lib(quick,I,t).
#program volatile(t).
:- open(I,t), not done(I,t).
"""


#: Solvers as those of the core's node with ``~plan: shortest``, and without time for better plans than the first.
shortest, first = PlanSolver, partial(PlanSolver, plan_time=0.0)


def soon(program: ReactiveProgram, plan_time: float = 1.0) -> PlanSolver:
    """Make a solver as the core's node does with ``~plan: soon``."""
    return PlanSolver(program, plan_time=plan_time)


#: Makers of solvers for either setting of ``~plan``.
PLANS = {"shortest": shortest, "soon": soon}


class DeferringSolver:
    """A solver whose plan always begins in the next cycle."""

    def __init__(self) -> None:
        self.log = History()

    def update(self, update: StreamUpdate, stopped: Any = None) -> SolveResult:
        """Answer with an action of the next cycle."""
        later = update.step + 1
        self.log = self.log.with_entries(AcceptedUpdate(update, later))
        plan = (frozenset([parse_atom(f"_action_lib(go,hall,{later})")]),)
        seconds = {"ground": 0.0, "solve": 0.0, "needed": 0.0}
        return SolveResult(SolveOutcome.SATISFIABLE, plan, later, update.step, statistics=seconds)

    def restore(self, log: History) -> None:
        """Continue from a history."""
        self.log = log


class Leaving:
    """A watch that ends the search of this ``number``, from 1: for an arrival, or for time if it is ``slow``."""

    def __init__(self, number: int = 0, slow: bool = False) -> None:
        self.number, self.slow = number, slow

    def __call__(self) -> Callable[[], Optional[Halt]]:
        self.number -= 1
        over = self.number == 0
        return lambda: Halt("the test", disturbed=not self.slow) if over else None


def halting(looks: int) -> SearchWatch:
    """Return a watch that ends each search after a number of polls."""

    def watch() -> Callable[[], Optional[Halt]]:
        left = iter([None] * looks)
        return lambda: next(left, Halt("the test"))

    return watch


_Kind = TypeVar("_Kind", bound=Event)


class Journal:
    """An observer that keeps the latest ``size`` events, oldest first."""

    def __init__(self, size: int = 10000) -> None:
        self._events: Deque[Event] = deque(maxlen=size)

    def __call__(self, event: Event) -> None:
        """Record an event."""
        self._events.append(event)

    @property
    def events(self) -> Tuple[Event, ...]:
        """Return all recorded events."""
        return tuple(self._events)

    def of(self, kind: Type[_Kind]) -> List[_Kind]:
        """Return the events of one kind."""
        return [event for event in self._events if isinstance(event, kind)]

    @property
    def updates(self) -> List[str]:
        """Return the texts of all stream updates, as the paper prints them."""
        return [str(parse_update(event.stream).plain) for event in self.of(UpdateSent)]

    @property
    def stream(self) -> str:
        """Return an online progression that replays the run: all updates in the order of the solver."""
        return "".join(event.stream for event in self.of(UpdateSent))

    @property
    def actions(self) -> List[str]:
        """Return all dispatched actions, as atoms."""
        return [str(action.atom) for event in self.of(ActionsDispatched) for action in event.actions]

    @property
    def problems(self) -> List[str]:
        """Return all reported problems."""
        return [event.message for event in self.of(Problem)]

    def states_of(self, key: str) -> List[str]:
        """Return the states of a goal so far."""
        return [event.state.value for event in self.of(GoalChanged) if event.key == key]


class Driver:
    """A core with a journal; ``run`` advances it until it waits.

    ``solver`` makes each of its solvers; with ``start`` the core has begun, otherwise it waits for ``begin``. The
    journal keeps the latest ``events``.
    """

    def __init__(
        self,
        text: str = ERRANDS,
        settings: Optional[CoreSettings] = None,
        program: Optional[ReactiveProgram] = None,
        solver: Callable[[ReactiveProgram], PlanningSolver] = shortest,
        watch: SearchWatch = unwatched,
        watch_recovery: SearchWatch = unwatched,
        watch_joining: Optional[SearchWatch] = None,
        start: bool = True,
        events: int = 10000,
    ) -> None:
        self.program = program or ReactiveProgram.from_text(text)
        self.journal = Journal(events)
        settings = settings or CoreSettings(horizon_limit=8)
        watches = watch, watch_recovery, watch_joining
        self.core = Core(self.program, lambda: solver(self.program), self.journal, settings, *watches)
        self.now = 1.0
        if start:
            self.begin()

    def begin(self) -> "Driver":
        """Begin and advance the core."""
        self.core.start()
        return self.run()

    @classmethod
    def of_shipped(cls, *names: str) -> "Driver":
        """Return a driver of the program of shipped files, with the core's own settings."""
        return cls(settings=CoreSettings(), program=shipped(*names))

    def run(self) -> "Driver":
        """Advance until the core waits."""
        for _ in range(200):
            self.core.poll(self.now)
            if not self.core.advance(self.now):
                return self
        raise AssertionError("the core does not come to rest")

    def goal(self, key: str, text: str) -> "Driver":
        """Send a goal and advance the core."""
        self.core.add_goal(key, text)
        return self.run()

    def cancel(self, key: str) -> "Driver":
        """Send a cancel and advance the core."""
        self.core.cancel_goal(key)
        return self.run()

    def facts(self, *facts: str) -> "Driver":
        """Send an interface's message and advance the core."""
        self.core.receive("interface", facts)
        return self.run()

    def succeed(self) -> "Driver":
        """Return all actions under way with their parameters, and advance the core."""
        for action in self.core.awaited:
            self.core.receive("interface", [f"_return({action.interface},{action.parameter},{action.cycle})"])
        return self.run()

    def fail(self, reason: str) -> "Driver":
        """Fail the actions under way for a reason, and advance the core."""
        action = self.core.awaited[0]
        return self.facts(f"_return({action.interface},{reason},{action.cycle})")

    def until(self, interface: str) -> "Driver":
        """Let all actions succeed until an action of this interface is under way."""
        for _ in range(50):
            if any(action.interface_name == interface for action in self.core.awaited):
                return self
            self.succeed()
        raise AssertionError(f"{interface} is never under way")

    def finish(self) -> "Driver":
        """Let all actions succeed until none is under way."""
        for _ in range(200):
            if not self.core.awaited:
                return self
            self.succeed()
        raise AssertionError("the core does not come to rest")

    @property
    def awaited(self) -> List[str]:
        """Return the actions under way."""
        return [str(action.atom) for action in self.core.awaited]

    @property
    def problems(self) -> List[str]:
        """Return the problems that the core reported."""
        return self.journal.problems

    def states(self, key: str) -> List[str]:
        """Return the states of a goal so far."""
        return self.journal.states_of(key)

    def message(self, key: str) -> str:
        """Return the message with which a goal ended."""
        ends = [event for event in self.journal.of(GoalChanged) if event.key == key and event.outcome is not None]
        return ends[0].message

    def feedback(self, key: str) -> List[GoalProgress]:
        """Return the feedback about a goal."""
        return [event for event in self.journal.of(GoalProgress) if event.key == key]


class FaultyDriver(Driver):
    """A driver whose solvers fail for some updates.

    For an update ``fault`` returns the error that is raised instead of accepting it, SolveOutcome.INTERRUPTED for an
    accepted update without an answer in time, else None. ``watch`` can end a search. ``failed`` are the texts of the
    updates with a fault.
    """

    def __init__(self, text: str = ERRANDS, settings: Optional[CoreSettings] = None, **others: Any) -> None:
        self.watch, self.failed = Leaving(), []  # type: Leaving, List[str]
        super().__init__(text, settings, **{"solver": self._make, "watch": self.watch, **others})

    def fault(self, update: StreamUpdate) -> Union[SolverError, SolveOutcome, None]:
        """Return the fault of an update."""

    def end_search(self, number: str, slow: bool = False) -> None:
        """End the search of this number, counted from now on."""
        self.watch.number, self.watch.slow = int(number), slow

    def fail_for(
        self, fault: Union[Type[SolverError], SolveOutcome, None], *words: str, unless: str = "#nothing"
    ) -> "FaultyDriver":
        """Give later updates with one of the ``words``, or all, a fault, except those with ``unless``.

        Updates are texts such as ``search 2. _seen(sun).`` and, without a search, ``take 2. _seen(sun).``.
        """

        patterns = [".*".join(map(re.escape, word.split("..."))) for word in words or [""]]

        def found(update: StreamUpdate) -> Union[SolverError, SolveOutcome, None]:
            text = f"{'search' if update.bound else 'take'} {' '.join(str(update.plain).split()[1:-2])}"
            if fault is None or unless in str(update) or not any(re.search(one, text) for one in patterns):
                return None
            self.failed.append(text)
            return fault("no") if isinstance(fault, type) else fault

        self.fault = found  # type: ignore[assignment]
        return self

    def _make(self, program: ReactiveProgram) -> PlanSolver:
        driver = self

        class FaultySolver(PlanSolver):
            def update(self, update: StreamUpdate, stopped: Any = None) -> SolveResult:
                fault = driver.fault(update)
                if isinstance(fault, SolverError):
                    if stopped is not None:
                        stopped()
                    raise fault
                result = super().update(update, stopped)
                return result if fault is None else replace(result, outcome=fault, answers=())

        return FaultySolver(program)
