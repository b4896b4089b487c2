"""The command ``watch``: prints the account of a running system, or of a bag."""

import argparse
import sys
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Callable, Iterable, Optional, Sequence

import rospy

from rosoclingo.nodes.account_node import TOPICS, AccountNode
from rosoclingo.nodes.missing_ros import Beginning, missing_master
from rosoclingo.nodes.recording.bag_reader import read_bag
from rosoclingo.nodes.words import words_of
from rosoclingo.oclingo.broken_pipe import exits_on_broken_pipe
from rosoclingo.runs.account import Account
from rosoclingo.runs.recorded_run import RecordingError
from rosoclingo.runs.topic_names import USUAL

Say = Callable[[str], None]

_PRINT = partial(print, flush=True)  # also a pipe's reader gets each line at once

#: The type of a topic of each core, by which cores are found.
_PLAN = "rosoclingo/TaskPlan"

#: Seconds of wall time between two checks for lines that are due.
_TURN = 0.2


@exits_on_broken_pipe
def main(description: Optional[str], arguments: Optional[Sequence[str]] = None, say: Say = _PRINT) -> int:
    """Run the command; return its exit code."""
    parser = argparse.ArgumentParser(
        prog="watch", description=description, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("bag", nargs="?", type=Path, metavar="RUN.bag", help="a recording; needs no master")
    parser.add_argument("--state", action="store_true", help="also print each change of the program's beliefs")
    parser.add_argument("--core", metavar="NAME", help="the core's name (default: the only core)")
    options = parser.parse_args(rospy.myargv()[1:] if arguments is None else arguments)
    missing = missing_master() if options.bag is None else None
    if missing:
        sys.exit(missing)
    try:
        if options.bag is not None:
            watch_bag(options.bag, options.core, options.state, say)
        else:
            rospy.init_node("watch", anonymous=True, disable_signals=True)
            watch_system(options.core, options.state, say)
    except RecordingError as error:
        sys.stderr.write(f"watch: {error}\n")
        return 2
    return 0


def watch_bag(path: Path, core: Optional[str], with_state: bool, say: Say) -> None:
    """Print the account of a bag, and the summary; raises RecordingError."""
    account = Account(say, with_state=with_state)
    with suppress(KeyboardInterrupt):
        read_bag(path, core, account, TOPICS)
    account.finish()
    _conclude(account, say)


def watch_system(core: Optional[str], with_state: bool, say: Say) -> None:
    """Print the account of a core's system until Ctrl-C or the master's end, then the summary."""
    name = rospy.resolve_name(core or USUAL)
    if not core:
        name = chosen_core(rospy.get_published_topics(), name)
    account = Account(say, with_state=with_state)
    account.sentences = words_of(name)  # first, as the first line can be about an action
    node, beginning = AccountNode(account, name), Beginning()
    try:
        while not rospy.is_shutdown():
            node.tick(_TURN)
            line = beginning.line()
            if line:
                say(line)
    except KeyboardInterrupt:
        pass
    node.finish()
    _conclude(account, say)


def _conclude(account: Account, say: Say) -> None:
    for line in ("", *account.summary(), f"time: {account.seconds:.1f} s"):
        say(line)


def chosen_core(published: Iterable[Sequence[str]], usual: str) -> str:
    """Return the ``usual`` core if it is in these topics (name, type), else the only core; raises RecordingError."""
    cores = sorted(name.rpartition("/")[0] for name, kind in published if kind == _PLAN)
    if usual in cores or not cores:
        return usual
    if len(cores) > 1:
        raise RecordingError(f"there are {len(cores)} cores: choose one of {', '.join(cores)} with --core")
    return cores[0]
