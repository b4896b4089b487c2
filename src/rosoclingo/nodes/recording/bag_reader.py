"""Events of recorded runs out of bags, without a master and without built messages."""

from contextlib import contextmanager
from pathlib import Path
from typing import Collection, Dict, Iterator, List, Optional, Set

import rosbag

from rosoclingo.nodes.pose_topics import EXACT
from rosoclingo.nodes.run_topics import PATHS, RunTopics
from rosoclingo.runs.events import RunEvents
from rosoclingo.runs.recorded_run import RecordedRun, RecordingError, RunCollector

__all__ = ["bag_runs", "core_in", "opened", "read_bag"]

#: The topics of a replay, named as :func:`full_name` takes them.
REPLAYED = ("~program", "~updates", "~task_plan", "out_rosoclingo", "/rosout")

#: Bytes of a std_msgs/Header before its frame's name: number and time, which differ in each message.
STAMP = 12

#: Topics that several robots can share at the root.
SHARED = ("map", "packages")

#: Topics whose messages begin with a header and are sent again and again unchanged.
REPEATED = ("rosoclingo/status", "packages", *PATHS)


def bag_runs(path: Path, core: Optional[str] = None) -> List[RecordedRun]:
    """Return the runs in a bag, those of ``core`` where there are several; raises RecordingError."""
    collector = RunCollector()
    read_bag(path, core, collector, REPLAYED)
    try:
        return collector.runs()
    except RecordingError as error:
        raise RecordingError(f"{path}: {error}") from None


def read_bag(path: Path, core: Optional[str], events: RunEvents, only: Optional[Collection[str]] = None) -> None:
    """Give ``events`` the events of a core's runs in a bag; raises RecordingError.

    ``core`` names it where there are several, ``only`` the topics that are read, by default all of a run.
    """
    with opened(path) as bag:
        topics = set(bag.get_type_and_topic_info().topics)
        reader = RunTopics(events, core_in(topics, core))
        names = {_found(name, reader.full(name), topics): name for name in (reader.takes if only is None else only)}
        if reader.full(EXACT) in topics:  # tf has many messages
            names = {topic: name for topic, name in names.items() if not name.startswith("/tf")}
        last: Dict[str, bytes] = {}
        for topic, (_, data, _, _, kind), moment in bag.read_messages(sorted(topics & names.keys()), raw=True):
            name, time = names[topic], moment.to_sec()
            if reader.is_too_soon(name, time) or (name in REPEATED and last.get(name) == data[STAMP:]):
                continue
            last[name] = data[STAMP:]
            message = kind()
            message.deserialize(data)
            reader.takes[name](time, message)


def _found(name: str, topic: str, topics: Set[str]) -> str:
    """Return a topic as a bag has it: a shared one can lie at the root."""
    return f"/{name}" if name in SHARED and topic not in topics else topic


@contextmanager
def opened(path: Path) -> Iterator[rosbag.Bag]:
    """A bag that is read; what is wrong with it, found here or while it is read, is a RecordingError."""
    try:
        with rosbag.Bag(str(path)) as bag:
            yield bag
    except RecordingError as error:
        raise RecordingError(f"{path}: {error}") from None
    except rosbag.ROSBagUnindexedException:
        mend = f"rosbag reindex {path} mends it"
        raise RecordingError(
            f"{path} has no index: who wrote it was killed, or still writes; if nobody does, {mend}"
        ) from None
    except OSError as error:
        raise RecordingError(f"{path} cannot be read: {error.strerror or error}") from None
    except Exception as error:  # noqa: BLE001 rosbag can raise anything at a damaged file
        what = f"{type(error).__name__}: {error}"
        mend = "rosbag reindex may save what is whole, or take another copy"
        raise RecordingError(f"{path} is no bag, or damaged ({what}); {mend}") from None


def core_in(topics: Set[str], wanted: Optional[str] = None) -> str:
    """Return the name of the core whose run it is; raises RecordingError."""
    if not topics:
        raise RecordingError("the bag is empty: the recorder heard of nothing; record a run with record:=true")
    found = sorted(topic[: -len("/updates")] for topic in topics if topic.endswith("/updates"))
    cores = [name for name in found if f"{name}/task_plan" in topics]
    if wanted is not None:
        cores = [name for name in found if name.strip("/") == wanted.strip("/")]
        if not cores:
            raise RecordingError(f"the core {wanted} is not in it, but {', '.join(found) or 'none'}")
    if not found:
        raise RecordingError(
            "no stream updates of a core (rosoclingo/updates) are in it: record with record:=true, or these topics too"
        )
    if not cores:
        raise RecordingError(f"it lacks {found[0]}/task_plan, which tells what was decided: record that topic too")
    if len(cores) > 1:
        raise RecordingError(f"the runs of {len(cores)} cores are in it: name one of {', '.join(cores)} by --core")
    return cores[0]
