"""Reads the events of recorded runs from bags, without a master and without built messages."""

from contextlib import contextmanager
from pathlib import Path
from typing import Collection, Iterator, Optional, Set

import rosbag

from rosoclingo.nodes.pose_topics import EXACT
from rosoclingo.nodes.run_topics import RunTopics
from rosoclingo.reasoning.journal.database import file_of, is_journal
from rosoclingo.runs.recorded_run import RecordingError
from rosoclingo.runs.run_view import RunEvents

#: The topics of a replay, with names for :func:`full_name`.
REPLAYED = ("~program", "~updates", "~task_plan", "out_rosoclingo", "/rosout")

#: Topics that several robots can share at the root.
SHARED = ("map", "packages", "record/wall_time")


def read_bag(path: Path, core: Optional[str], events: RunEvents, only: Optional[Collection[str]] = None) -> None:
    """Pass the events of a core's runs in a bag to ``events``; raises RecordingError.

    ``core`` is required if the bag has several cores. ``only`` limits the topics; by default all topics of a run are
    read.
    """
    with open_bag(path) as bag:
        topics = set(bag.get_type_and_topic_info().topics)
        reader = RunTopics(events, core_in(topics, core))
        names = {_found(name, reader.full(name), topics): name for name in (reader.takes if only is None else only)}
        if reader.full(EXACT) in topics:  # tf has many messages
            names = {topic: name for topic, name in names.items() if not name.startswith("/tf")}
        for topic, (_, data, _, _, kind), moment in bag.read_messages(sorted(topics & names.keys()), raw=True):
            name, time = names[topic], moment.to_sec()
            if not reader.is_too_soon(name, time):
                message = kind()
                message.deserialize(data)
                reader.pass_on(name, time, message)


def _found(name: str, topic: str, topics: Set[str]) -> str:
    """Return the name of a topic in a bag: a shared topic can be at the root."""
    return f"/{name}" if name in SHARED and topic not in topics else topic


def read_recording(path: Path, core: Optional[str], events: RunEvents, only: Optional[Collection[str]] = None) -> None:
    """Pass the events of a bag, see :func:`read_bag`, or of a journal; raises RecordingError, OSError."""
    if is_journal(file_of(path)):
        from rosoclingo.runs.journal_run import read_journal  # noqa: PLC0415 loads the core, which a bag does not need

        read_journal(file_of(path), events)
    else:
        read_bag(path, core, events, only)


@contextmanager
def open_bag(path: Path) -> Iterator[rosbag.Bag]:
    """Open a bag for reading; its faults, also during reading, raise RecordingError."""
    try:
        with rosbag.Bag(str(path)) as bag:
            yield bag
    except RecordingError as error:
        raise RecordingError(f"{path}: {error}") from None
    except rosbag.ROSBagUnindexedException:
        fix = f"if not, run: rosbag reindex {path}"
        raise RecordingError(f"{path} has no index: its recorder was killed, or is still writing; {fix}") from None
    except OSError as error:
        raise RecordingError(f"{path} cannot be read: {error.strerror or error}") from None
    except Exception as error:  # noqa: BLE001 rosbag can raise anything for a damaged file
        what = f"{type(error).__name__}: {error}"
        fix = "try rosbag reindex, or another copy"
        raise RecordingError(f"{path} is not a bag, or is damaged ({what}); {fix}") from None


def core_in(topics: Set[str], wanted: Optional[str] = None) -> str:
    """Return the name of the core in a bag with these topics; raises RecordingError."""
    if not topics:
        raise RecordingError("the bag is empty: record a run with record:=true")
    found = sorted(topic[: -len("/updates")] for topic in topics if topic.endswith("/updates"))
    cores = [name for name in found if f"{name}/task_plan" in topics]
    if wanted is not None:
        cores = [name for name in found if name.strip("/") == wanted.strip("/")]
        if not cores:
            raise RecordingError(f"the bag has no core {wanted}; its cores: {', '.join(found) or 'none'}")
    if not found:
        raise RecordingError(
            "the bag has no stream updates of a core (rosoclingo/updates): record with record:=true, or add this topic"
        )
    if not cores:
        raise RecordingError(f"the bag lacks the decisions ({found[0]}/task_plan): record that topic too")
    if len(cores) > 1:
        raise RecordingError(f"the bag has runs of {len(cores)} cores: choose one of {', '.join(cores)} with --core")
    return cores[0]
