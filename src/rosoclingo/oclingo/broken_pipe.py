"""Handles a closed pipe at the output of a command, as in ``golog FILE | head``."""

import os
import sys
from functools import wraps
from typing import Any, Callable, TypeVar, cast

Main = TypeVar("Main", bound=Callable[..., int])


def exits_on_broken_pipe(main: Main) -> Main:
    """Decorate the ``main`` function of a command: it ends with exit code 1 and no message if its output is closed."""

    @wraps(main)
    def run(*arguments: Any, **named: Any) -> int:
        """Run the command."""
        try:
            code = main(*arguments, **named)
            sys.stdout.flush()
            return code
        except BrokenPipeError:  # Python flushes the rest at exit, which must not fail again
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            return 1

    return cast(Main, run)
