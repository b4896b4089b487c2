"""The incremental solver: it answers each stream update of a reactive logic program, as oClingo did.

Its behaviour is that of oClingo (2012), as observed on the original program, without its crashes: an update is accepted
or refused as a whole, and no input text can terminate the solver.
"""

import time
from dataclasses import replace
from typing import Callable, Optional, Tuple

from rosoclingo.oclingo.errors import StoppedError
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.parser import strings_as_constants
from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.oclingo.solving.reactive_grounding import ReactiveGrounding
from rosoclingo.oclingo.solving.results import NOT_EXTERNAL, Answer, SolveOutcome, SolveResult, unused_facts
from rosoclingo.oclingo.solving.stream_solver import check_horizon_limit
from rosoclingo.oclingo.solving.stream_state import StreamState

Stopped = Callable[[], bool]

BLOCK = 64
"""Number of steps that regrounding grounds in one call."""

_OUTCOMES = {True: SolveOutcome.SATISFIABLE, False: SolveOutcome.UNSATISFIABLE, None: SolveOutcome.INTERRUPTED}


class ReactiveSolver:
    """Solves a reactive logic program under a stream of updates, at the last grounded step.

    Not thread-safe. The ``stopped`` callables are polled every few milliseconds of wall time while clingo searches, and
    before each new step is grounded; ``dropped`` is polled while grounding.

    Attributes:
        state: the state of the stream, from which everything else is derived.

    """

    def __init__(self, program: ReactiveProgram, models: int = 1, horizon_limit: Optional[int] = None) -> None:
        """Create a solver.

        Args:
            program: the reactive logic program.
            models: the number of answers to compute for an update, 0 for all.
            horizon_limit: the last step to ground.

        """
        self.program = program
        self.models = models
        self.state = StreamState.initial(program)
        self._limit = horizon_limit
        self._grounding: Optional[ReactiveGrounding] = None
        self._reported = set(program.warnings)  # each warning is reported once

    @property
    def horizon(self) -> int:
        """N, the last grounded step."""
        return self.state.horizon

    @property
    def reached(self) -> int:
        """The last grounded step during a search; the horizon between two searches."""
        return self.horizon if self._grounding is None else max(self.horizon, self._grounding.horizon)

    @property
    def step(self) -> int:
        """k, the step of the last update."""
        return self.state.step

    def solve(self, stopped: Optional[Stopped] = None) -> SolveResult:
        """Search without an update; before the first update, at horizon 1."""
        return self._run(None, stopped)

    def update(self, update: StreamUpdate, stopped: Optional[Stopped] = None) -> SolveResult:
        """Accept ``update`` and search for answers, growing the horizon until there is one or the bound is reached.

        ``stopped`` ends the search; the update stays accepted. Raises SolverError if the update is refused, and
        StoppedError if ``stopped`` returns true while the program is regrounded; the state is then unchanged.
        """
        result = self._run(update, stopped)
        return replace(result, warnings=update.warnings + result.warnings)

    def reapply(self, update: Optional[StreamUpdate], horizon: int) -> None:
        """Accept, without a search, an update that was accepted before and led to ``horizon``."""
        self.state = self._with_update(update).with_growth(horizon, self.program)

    def _with_update(self, update: Optional[StreamUpdate]) -> StreamState:
        return self.state.with_update(None if update is None else strings_as_constants(update), self.program)

    def _run(self, update: Optional[StreamUpdate], stopped: Optional[Stopped]) -> SolveResult:
        check_horizon_limit(update, self.horizon, self._limit)
        try:
            return self._search(self._with_update(update), stopped or (lambda: False))
        except BaseException:
            self._grounding = None  # the change can be incomplete
            raise

    def _search(self, state: StreamState, stopped: Stopped) -> SolveResult:
        start, began, seconds = time.perf_counter(), time.process_time(), 0.0
        last = min((end for end in (state.bound, self._limit) if end is not None), default=None)
        satisfiable: Optional[bool] = None
        answers: Tuple[Answer, ...] = ()
        permanent = False
        grounding = self._ground(state, stopped)
        ignored = grounding.follow(state) if grounding.horizon == state.horizon else []
        before = set(map(id, self.state.items))
        warnings = [NOT_EXTERNAL.format(one.statement.head) for one in ignored if id(one) not in before]
        while grounding.horizon == state.horizon and not stopped():
            asked = time.perf_counter()
            satisfiable, answers = grounding.search(self.models, stopped)
            seconds += time.perf_counter() - asked
            permanent = satisfiable is False and grounding.is_conflicting
            if satisfiable is not False or permanent or (last is not None and state.horizon >= last):
                break
            satisfiable = None  # not known until the next horizon is searched
            if not stopped():
                state = state.with_growth(state.horizon + 1, self.program)
                grounding = self._ground(state, stopped)
                grounding.follow(state)
        if grounding.horizon < state.horizon:  # stopped before the step of the update was grounded
            state = state.with_growth(grounding.horizon, self.program)
        self.state = state
        horizon = max(state.horizon, last or state.horizon) if permanent else state.horizon
        spent = {"solve": seconds, "ground": time.perf_counter() - start - seconds}
        spent["needed"] = time.process_time() - began
        found = dict.fromkeys([*unused_facts(self.program, state), *grounding.new_remarks()])
        warnings += [text for text in found if text not in self._reported]
        self._reported.update(found)
        all_warnings = (*state.warnings, *warnings)
        return SolveResult(_OUTCOMES[satisfiable], answers, horizon, state.step, all_warnings, permanent, spent)

    def _ground(self, state: StreamState, stopped: Stopped) -> ReactiveGrounding:
        """Return a grounding that can follow ``state``, up to its horizon unless ``stopped``; raises StoppedError."""
        grounding = self._grounding
        if grounding is None or not grounding.can_follow(state):
            grounding = ReactiveGrounding(self.program, state)
        else:
            grounding.open_heads(state)
        self._grounding, accepted = grounding, min(self.horizon, state.horizon)
        while grounding.horizon < state.horizon:
            if grounding.horizon >= accepted and stopped():
                break
            block = BLOCK if grounding.horizon + 1 < accepted and self.program.steps_apart else 1
            grounding.ground_to(min(grounding.horizon + block, max(accepted, grounding.horizon + 1)))
            if grounding.horizon < accepted and stopped():
                raise StoppedError
        return grounding
