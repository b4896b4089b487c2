"""Commands whose reader goes before the end of their output, as in ``golog FILE | head``."""

import os
import sys
from functools import wraps
from typing import Any, Callable, TypeVar, cast

Main = TypeVar("Main", bound=Callable[..., int])


def ends_unread(main: Main) -> Main:
    """Return a command that ends with exit code 1, without a message, when its reader has gone."""

    @wraps(main)
    def run(*arguments: Any, **named: Any) -> int:
        """Run the command."""
        try:
            code = main(*arguments, **named)
            sys.stdout.flush()
            return code
        except BrokenPipeError:  # else Python flushes the rest when it ends
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            return 1

    return cast(Main, run)
