"""Questions to clasp about what one control has ground, each with limits of its own, that can be stopped."""

from typing import Any, Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple

import clingo

from rosoclingo.oclingo.program.reactive_program import ReactiveProgram

POLL = 0.002
"""Seconds of wall time between two looks at the stop request while clasp searches."""

SMALL = 1000
"""Atoms of a program that is searched in place first, which spares a thread: most searches of it take less time."""

FEW_CONFLICTS = 100
"""Conflicts that such a search may take, a few milliseconds, as it hears of no stop."""

Assumed = Sequence[Any]
OnModel = Callable[[clingo.Model], None]


class Limits(NamedTuple):
    """How far a search goes.

    Attributes:
        models: answers to find at most, 0 for all.
        conflicts: those it may take at most, None for no limit.
        best: where the program optimizes: whether to look for the best answers; else any will do.
        advised: whether ``#heuristic`` counts.

    """

    models: int
    conflicts: Optional[int]
    best: bool
    advised: bool


class ClaspSearch:
    """The searches of one control."""

    def __init__(self, control: clingo.Control, program: ReactiveProgram) -> None:
        """Search what ``control`` has ground of ``program``."""
        self._control = control
        self._optimizes, self._advises = program.optimizes, program.advises
        self._options: Dict[str, str] = {}

    def run(
        self, limits: Limits, assumed: Assumed, keep: OnModel, stopped: Callable[[], bool], blames: bool
    ) -> Tuple[clingo.SolveResult, List[int]]:
        """Search within ``limits`` until ``stopped`` says so.

        Returns the result, with the literals of those ``assumed`` because of which there is no answer if it ``blames``.
        """
        few = FEW_CONFLICTS if limits.conflicts is None else min(limits.conflicts, FEW_CONFLICTS)
        if limits.models == 1 and not blames and not (self._optimizes and limits.best) and self._is_small():
            result = self.run_in_place(limits._replace(conflicts=few), assumed, keep)
            if not result.unknown or few == limits.conflicts:
                return result, []
        self._configure(limits)
        with self._control.solve(assumptions=assumed, on_model=keep, async_=True) as handle:
            while not handle.wait(POLL):
                if stopped():
                    handle.cancel()
            result = handle.get()
            return result, handle.core() if blames and result.satisfiable is False else []

    def run_in_place(self, limits: Limits, assumed: Assumed, keep: OnModel) -> clingo.SolveResult:
        """Search within ``limits``, which have to see to it that this ends soon: it can't be stopped."""
        self._configure(limits)
        return self._control.solve(assumptions=assumed, on_model=keep)

    def _is_small(self) -> bool:
        return len(self._control.symbolic_atoms) < SMALL

    def _configure(self, limits: Limits) -> None:
        """Set clasp's options that differ from those of the last search: to set one takes long."""
        conflicts = "umax" if limits.conflicts is None else str(limits.conflicts)
        options = {"models": str(limits.models), "solve_limit": f"{conflicts},umax"}
        if self._optimizes:
            options["opt_mode"] = "optN" if limits.best else "ignore"
        if self._advises:
            options["heuristic"] = "Domain" if limits.advised else "Vsids,92"  # clingo's own, where nothing is said
        configuration = self._control.configuration
        for name, value in options.items():
            if self._options.get(name) != value:
                setattr(configuration.solver if name == "heuristic" else configuration.solve, name, value)
        self._options = options
