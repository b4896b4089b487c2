"""The command ``oclingo`` with all that it uses: the planner for ``--shortest``, the check for ``--check``."""

import argparse
import sys
from typing import Callable, Optional, Sequence

from rosoclingo.checking.more import More
from rosoclingo.oclingo.service import command
from rosoclingo.planning.workers.pool import WorkerPool


def main(arguments: Optional[Sequence[str]] = None, find_more: Callable[[], Optional[More]] = lambda: None) -> int:
    """Run the command; return its exit code.

    ``find_more`` returns what else ``--check`` looks at; it is called for ``--check`` only.
    """

    def add_check(parser: argparse.ArgumentParser) -> Callable[[argparse.Namespace], int]:
        """Add the arguments of the check."""
        from rosoclingo.checking.check_command import add_trials, check  # noqa: PLC0415 as much as all else

        more = find_more()
        add_trials(parser, more)
        return lambda options: check(options, more)

    return command.main(arguments, WorkerPool, add_check)


if __name__ == "__main__":
    sys.exit(main())
