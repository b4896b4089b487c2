"""The command ``oclingo`` with all that it uses: the planner for ``--shortest``, the check for ``--check``."""

import argparse
import sys
from contextlib import contextmanager
from typing import Any, Callable, Iterator, Optional, Sequence

from rosoclingo.checking.extension import CheckExtension
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.service import command
from rosoclingo.planning.workers.pool import WorkerPool
from rosoclingo.planning.workers.process_solver import ProcessSolver


def main(
    arguments: Optional[Sequence[str]] = None, load_extension: Callable[[], CheckExtension] = CheckExtension
) -> int:
    """Run the command; return its exit code. ``load_extension`` is called for ``--check`` only."""

    def add_check(parser: argparse.ArgumentParser) -> Callable[[argparse.Namespace], int]:
        """Add the arguments of the check."""
        from rosoclingo.checking.check_command import add_trials, check  # noqa: PLC0415 as much as all else

        extension = load_extension()
        add_trials(parser, extension)
        return lambda options: check(options, extension)

    return command.main(arguments, _solver, add_check)


@contextmanager
def _solver(program: ReactiveProgram, **options: Any) -> Iterator[ProcessSolver]:
    """A solver in a process of its own, a fork of this one."""
    with WorkerPool(program, fork=True, **options) as pool:
        pool.start()
        yield ProcessSolver(pool)


if __name__ == "__main__":
    sys.exit(main())
