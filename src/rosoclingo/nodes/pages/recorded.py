"""A recorded run for a page: out of a bag or a journal, without a master and without built messages."""

import math
from pathlib import Path
from typing import Any, Dict, Iterator, Mapping, Optional, Tuple

import rosbag

from rosoclingo.nodes.recording.bag_reader import core_in, opened
from rosoclingo.nodes.run_topics import PATHS, RunTopics
from rosoclingo.reasoning.journal.database import file_of, is_journal
from rosoclingo.runs.journal_run import journal_view
from rosoclingo.runs.recorded_run import RecordingError
from rosoclingo.runs.run_view import RunView

__all__ = ["read_view"]

#: Bytes of a std_msgs/Header before its frame's name: number and time, which differ in each message.
STAMP = 12

#: What all robots may share.
SHARED = ("map", "packages")

#: Topics whose messages begin with a header and are sent again and again as they were.
REPEATED = ("rosoclingo/status", "packages", *PATHS)

#: A topic whose messages have all goals, and the one that has each once; that may lack what a client sent at its start.
ALL_GOALS, GOAL = "~goals", "rosoclingo/goal"

#: Seconds between two of those messages that are read, where there are both topics; the last one is, too.
GOALS_APART = 10.0


def read_view(path: Path, core: Optional[str] = None, about: Optional[Mapping[str, Any]] = None) -> RunView:
    """Return what a page shows of a core's runs in a bag, or of that in a journal; raises RecordingError, OSError.

    ``core`` names it where there are several, ``about`` is what else the page says.
    """
    file = file_of(path)
    if not is_journal(file):
        return _bag_view(path, core, about)
    try:
        return journal_view(file, about)
    except RecordingError as error:
        raise RecordingError(f"{file}: {error}") from None


def _bag_view(path: Path, core: Optional[str], about: Optional[Mapping[str, Any]]) -> RunView:
    with opened(path) as bag:
        topics = set(bag.get_type_and_topic_info().topics)
        view = RunView(about)
        reader = RunTopics(view, core_in(topics, core))
        names = {_found(name, reader.full(name), topics): name for name in reader.takes}
        for name, kind, data, time in _fresh(bag, names, reader):
            message = kind()
            message.deserialize(data)
            reader.takes[name](time, message)
        view.finish()
        return view


def _found(name: str, topic: str, topics: "set[str]") -> str:
    """Return a topic as a bag has it: what all robots share may lie at the root."""
    return f"/{name}" if name in SHARED and topic not in topics else topic


def _fresh(bag: rosbag.Bag, names: Mapping[str, str], reader: RunTopics) -> Iterator[Tuple[str, Any, bytes, float]]:
    """Yield the messages that say something new: name, class, bytes and time."""
    last: Dict[str, Any] = {}
    apart = GOALS_APART if GOAL in names.values() and bag.get_message_count(_topic(names, GOAL)) else 0.0
    goals: Optional[Tuple[str, Any, bytes, float]] = None  # that were passed over
    read = -math.inf
    for topic, raw, moment in bag.read_messages(list(names), raw=True):
        name, data, time = names[topic], raw[1], moment.to_sec()
        if name == ALL_GOALS and 0.0 <= time - read < apart:
            goals = name, raw[-1], data, time
            continue
        if name == ALL_GOALS:
            read, goals = time, None
        if name in REPEATED:
            mark, old = data[STAMP:], last.get(name)
            if mark == old:
                continue
            last[name] = mark
        elif reader.is_too_soon(name, time):
            continue
        yield name, raw[-1], data, time
    if goals is not None:
        yield goals


def _topic(names: Mapping[str, str], name: str) -> str:
    return next(topic for topic, one in names.items() if one == name)
