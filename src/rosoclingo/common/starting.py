"""Start of scripts and nodes: messages about missing modules, ``--help``, and errors as one line of the log."""

import argparse
import contextlib
import gc
import inspect
import os
import shlex
import signal
import sys
import threading
from typing import Any, Callable, Iterator, Sequence, Tuple, Type

from rosoclingo.common.streams import tolerate_any_locale, tolerate_full_disk

#: Names of PyPI packages that differ from the module.
_PYPI = {"PIL": "Pillow", "clingo": "clingo>=5.7", "llvmlite": "numba", "yaml": "PyYAML"}


@contextlib.contextmanager
def needed_modules() -> Iterator[None]:
    """Wrap a script's imports: exit with a message about a missing module and how to install it.

    From then on the script prints any text in any locale. Garbage collection is off during the imports: it finds
    nothing there, and takes a tenth of their processor time.
    """
    tolerate_any_locale()
    gc.disable()
    try:
        yield
    except ModuleNotFoundError as error:
        sys.exit(f"{os.path.basename(sys.argv[0])}: {missing(error.name or str(error))}")
    finally:
        gc.enable()


def missing(module: str) -> str:
    """Return how to install a module that this Python lacks."""
    name = module.partition(".")[0]
    if name == "rosoclingo":
        return f"no module {module}: build the workspace and source its setup.bash (devel/setup.bash)"
    python, package = f"{sys.executable} (Python {sys.version_info[0]}.{sys.version_info[1]})", _PYPI.get(name, name)
    fix = f"rosdep install rosoclingo, or {sys.executable} -m pip install {shlex.quote(package)}"
    return f"{name} is not installed for {python}: {fix}"


def node_arguments(node: Type[Any], script: str, positional: str = "") -> Sequence[str]:
    """Return the command line's arguments without those of ROS, at most one; ``--help`` shows the node's docstring."""
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
    """Run a node until shutdown; return the exit code: 1 if its constructor raised ``errors`` or its worker failed.

    Parameters that the node does not read are logged.
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
    """Shut down in a thread: rospy's handler waits for a lock that the interrupted thread can hold."""
    import rospy

    threading.Thread(target=rospy.signal_shutdown, args=(f"signal-{number}",)).start()
