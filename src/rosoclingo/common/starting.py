"""How the scripts start: with words for what is missing, ``--help``, and a node's errors as one line of the log."""

import argparse
import contextlib
import inspect
import os
import shlex
import signal
import sys
import threading
from typing import Any, Callable, Iterator, NoReturn, Sequence, Tuple, Type

from rosoclingo.common.streams import print_utf8, tolerate_any_locale, tolerate_full_disk

__all__ = ["leave", "missing", "needed_modules", "node_arguments", "print_utf8", "run_node"]

#: PyPI's packages where they have another name than the module.
_PYPI = {"PIL": "Pillow", "clingo": "clingo>=5.7", "llvmlite": "numba", "yaml": "PyYAML"}


@contextlib.contextmanager
def needed_modules() -> Iterator[None]:
    """Around a script's imports: end the script with the missing module and how to install it.

    From here on the script prints any text in any locale.
    """
    tolerate_any_locale()
    try:
        yield
    except ModuleNotFoundError as error:
        sys.exit(f"{os.path.basename(sys.argv[0])}: {missing(error.name or str(error))}")


def missing(module: str) -> str:
    """How to install a module that this Python lacks."""
    name = module.partition(".")[0]
    if name == "rosoclingo":
        return f"there is no {module}: build the workspace and source its setup.bash (devel/setup.bash)"
    python, package = f"{sys.executable} (Python {sys.version_info[0]}.{sys.version_info[1]})", _PYPI.get(name, name)
    mend = f"rosdep install rosoclingo, or {sys.executable} -m pip install {shlex.quote(package)}"
    return f"{name} is not installed for {python}: {mend}"


def leave(code: int) -> NoReturn:
    """End the process with this exit code and what it has written, but do not take apart what it has in memory."""
    with contextlib.suppress(BrokenPipeError):  # nobody reads on
        sys.stdout.flush()
        sys.stderr.flush()
    os._exit(code)


def node_arguments(node: Type[Any], script: str, positional: str = "") -> Sequence[str]:
    """The command line's arguments without those of ROS, at most one; ``--help`` shows the node's docstring."""
    from rospy import myargv

    tolerate_any_locale()
    own = f" [{positional}]" if positional else ""
    parser = argparse.ArgumentParser(
        prog=script,
        usage=f"rosrun rosoclingo {script}{own} [_PARAMETER:=VALUE ...] [NAME:=NEW_NAME ...]",
        description=inspect.getdoc(node),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    if positional:
        parser.add_argument("argument", nargs="?", metavar=positional)
    found = parser.parse_args(myargv()[1:])
    return [found.argument] if positional and found.argument is not None else []


def run_node(
    name: str,
    node: Callable[..., Any],
    errors: Tuple[Type[Exception], ...],
    arguments: Sequence[Any] = (),
    begin: Callable[[Any], None] = lambda node: None,
) -> int:
    """Be the node until shutdown; the exit code: 0, or 1 where making it raised one of ``errors`` or its worker failed.

    Parameters that it has not read by then are logged.
    """
    import rospy

    from rosoclingo.common.parameters import warn_of_unread
    from rosoclingo.common.registration import Registration
    from rosoclingo.common.worker import failed

    tolerate_full_disk()
    rospy.init_node(name)
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, _shut_down)
    try:
        made = node(*arguments)
    except errors as error:
        rospy.logfatal("%s: %s", rospy.get_name(), error)
        return 1
    warn_of_unread()
    Registration()
    begin(made)
    rospy.spin()
    return 1 if failed() else 0


def _shut_down(number: int, _frame: Any) -> None:
    """Shut down in a thread: rospy's own handler waits for a lock that the thread it interrupts can hold."""
    import rospy

    threading.Thread(target=rospy.signal_shutdown, args=(f"signal-{number}",)).start()
