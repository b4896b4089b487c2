"""The command ``oclingo`` with the planner (``--shortest``) and the check (``--check``)."""

import argparse
import sys
from contextlib import contextmanager
from typing import Any, Callable, Iterator, Optional, Sequence

from rosoclingo.checking.extension import CheckExtension
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.oclingo.service import command
from rosoclingo.oclingo.solving.results import SolveResult
from rosoclingo.planning.question import Stop
from rosoclingo.planning.workers.pool import WorkerPool
from rosoclingo.planning.workers.process_solver import ProcessSolver


def main(
    arguments: Optional[Sequence[str]] = None, load_extension: Callable[[], CheckExtension] = CheckExtension
) -> int:
    """Run the command and return its exit code; ``load_extension`` is only called for ``--check``."""

    def add_check(parser: argparse.ArgumentParser) -> Callable[[argparse.Namespace], int]:
        """Add the arguments of the check."""
        from rosoclingo.checking.check_command import add_trials, check  # noqa: PLC0415 slow to load

        extension = load_extension()
        add_trials(parser, extension)
        return lambda options: check(options, extension)

    return command.main(arguments, _solver, add_check)


class _Planner(ProcessSolver):
    """A planner whose answers end with the horizon, as those of the incremental solver do."""

    def __init__(self, pool: WorkerPool, program: ReactiveProgram) -> None:
        """Create a solver for ``program`` that uses the workers of ``pool``."""
        super().__init__(pool)
        self._program = program

    def update(self, update: StreamUpdate, stopped: Optional[Stop] = None) -> SolveResult:
        """Accept ``update`` and search for answers."""
        return super().update(update, stopped).until_horizon(self._program)


@contextmanager
def _solver(program: ReactiveProgram, **options: Any) -> Iterator[ProcessSolver]:
    """Run a solver in a forked process."""
    with WorkerPool(program, fork=True, **options) as pool:
        pool.start()
        yield _Planner(pool, program) if options["shortest"] else ProcessSolver(pool)


if __name__ == "__main__":
    sys.exit(main())
