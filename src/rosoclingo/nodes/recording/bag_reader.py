"""Recorded runs out of bags, without a master and without built messages."""

from contextlib import contextmanager
from pathlib import Path
from typing import Iterator, List, Optional, Set

import rosbag

from rosoclingo.nodes.run_topics import RunTopics
from rosoclingo.runs.recorded_run import RecordedRun, RecordingError, RunCollector

__all__ = ["bag_runs", "core_in", "opened"]

#: The topics of a replay, named as :func:`full_name` takes them.
REPLAYED = ("~program", "~updates", "~task_plan", "out_rosoclingo", "/rosout")


def bag_runs(path: Path, core: Optional[str] = None) -> List[RecordedRun]:
    """Return the runs in a bag, those of ``core`` where there are several; raises RecordingError."""
    with opened(path) as bag:
        topics = set(bag.get_type_and_topic_info().topics)
        return _read(bag, core_in(topics, core), topics)


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
    except Exception as error:  # noqa: BLE001 rosbag raises whatever it stumbles over in a damaged file
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


def _read(bag: rosbag.Bag, core: str, topics: Set[str]) -> List[RecordedRun]:
    """Give the messages of a core that a replay needs to a collector."""
    collector = RunCollector()
    reader = RunTopics(collector, core)
    takes = {reader.full(name): reader.takes[name] for name in REPLAYED}
    for topic, message, moment in bag.read_messages([topic for topic in takes if topic in topics]):
        takes[topic](moment.to_sec(), message)
    return collector.runs()
