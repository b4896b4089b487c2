"""The command ``watch``: prints the account of a running system, or of a bag."""

import time
from contextlib import suppress
from pathlib import Path
from typing import Callable, Iterable, Optional, Sequence

import rospy

from rosoclingo.nodes.account_node import TOPICS, AccountNode
from rosoclingo.nodes.recording.bag_reader import read_bag
from rosoclingo.nodes.server_watch import Beginning
from rosoclingo.nodes.words import words_of
from rosoclingo.runs.account import Account, Summary
from rosoclingo.runs.recorded_run import RecordingError
from rosoclingo.runs.topic_names import USUAL

Say = Callable[[str], None]

#: The type of a topic of each core, by which cores are found.
_PLAN = "rosoclingo/TaskPlan"

#: Seconds of wall time between two checks for lines that are due.
_TURN = 0.2


def watch_bag(path: Path, core: Optional[str], with_state: bool, say: Say) -> None:
    """Print the account of a bag, and the summary; raises RecordingError."""
    account = Account(say, with_state=with_state)
    with suppress(KeyboardInterrupt):
        read_bag(path, core, account, TOPICS)
    account.finish()
    _conclude(account.summary, say)


def watch_system(core: Optional[str], with_state: bool, say: Say) -> None:
    """Print the account of a core's system until Ctrl-C or the master's end, then the summary."""
    name = rospy.resolve_name(core) if core else _find_core()
    words = words_of(name)  # first, as the first line can be about an action
    account, beginning = AccountNode(say, with_state, name, words), Beginning()
    try:
        while not rospy.is_shutdown():
            time.sleep(_TURN)
            line = beginning.line()
            if line:
                say(line)
            account.tick()
    except KeyboardInterrupt:
        pass
    _conclude(account.finish(), say)


def _conclude(summary: Summary, say: Say) -> None:
    for line in ("", *summary.lines(), f"time: {summary.seconds:.1f} s"):
        say(line)


def _find_core() -> str:
    """Return the absolute name of the core with the default name, if it is running, or of the only core."""
    return chosen_core(rospy.get_published_topics(), rospy.resolve_name(USUAL))


def chosen_core(published: Iterable[Sequence[str]], usual: str) -> str:
    """Return the ``usual`` core if it is in these topics (name, type), else the only core; raises RecordingError."""
    cores = sorted(name.rpartition("/")[0] for name, kind in published if kind == _PLAN)
    if usual in cores or not cores:
        return usual
    if len(cores) > 1:
        raise RecordingError(f"there are {len(cores)} cores: choose one of {', '.join(cores)} with --core")
    return cores[0]
