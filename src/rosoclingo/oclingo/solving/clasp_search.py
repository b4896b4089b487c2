"""Interruptible searches of clasp in one control, each with its own limits."""

from typing import Any, Callable, List, NamedTuple, Optional, Sequence, Tuple

import clingo

from rosoclingo.oclingo.program.reactive_program import ReactiveProgram

POLL = 0.002
"""Seconds of wall time between two polls of the stop callback during a search."""

Assumed = Sequence[Any]
OnModel = Callable[[clingo.Model], None]


class SearchLimits(NamedTuple):
    """The limits of a search.

    Attributes:
        models: maximal number of answers, 0 for all.
        conflicts: maximal number of conflicts, None for no limit.
        best: whether to search for optimal answers, if the program optimizes.
        advised: whether ``#heuristic`` directives apply.

    """

    models: int
    conflicts: Optional[int]
    best: bool
    advised: bool


class ClaspSearch:
    """The searches of one control."""

    def __init__(self, control: clingo.Control, program: ReactiveProgram) -> None:
        """Create searches of ``control``, which has grounded ``program``."""
        self._control = control
        self._optimizes, self._advises = program.optimizes, program.advises
        self._limits: Optional[SearchLimits] = None  # of the last search

    def run(
        self, limits: SearchLimits, assumed: Assumed, on_model: OnModel, stopped: Callable[[], bool], with_core: bool
    ) -> Tuple[clingo.SolveResult, List[int]]:
        """Search within ``limits`` until ``stopped`` returns true; call ``on_model`` with each model.

        Returns the result and, if ``with_core`` is set and there is no answer, an unsat core of ``assumed``.
        """
        if limits != self._limits:  # new options make clasp prepare the solver again
            self._configure(limits)
        with self._control.solve(assumptions=assumed, on_model=on_model, async_=True) as handle:
            while not handle.wait(POLL):
                if stopped():
                    handle.cancel()
            result = handle.get()
            return result, handle.core() if with_core and result.satisfiable is False else []

    def _configure(self, limits: SearchLimits) -> None:
        self._limits = limits
        options: Any = self._control.configuration
        conflicts = "umax" if limits.conflicts is None else str(limits.conflicts)
        options.solve.models, options.solve.solve_limit = str(limits.models), f"{conflicts},umax"
        if self._optimizes:
            options.solve.opt_mode = "optN" if limits.best else "ignore"
        if self._advises:
            options.solver.heuristic = "Domain" if limits.advised else "Vsids,92"  # the second is clingo's default
