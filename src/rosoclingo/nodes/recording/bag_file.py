"""A bag that can be read whenever its writer dies, up to a second before."""

import os
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, Iterator

import genpy
import rosbag
from std_msgs.msg import String

__all__ = ["BagError", "BagFile", "active", "mend"]

#: Bytes of one chunk; what is in an unfinished one is lost with the process, so every flush finishes one.
CHUNK = 768 * 1024

#: Bytes that have to fit on a disk that was full before it is written again.
ROOM = 2 * CHUNK

#: Flushes after which the index in memory is let go.
KEEP = 300

#: The least time that a bag may hold.
FIRST = genpy.Time(0, 1)


class BagError(RuntimeError):
    """A bag that cannot be written or mended; the text names the file and says why."""


def active(path: Path) -> Path:
    """Where a bag is while it is written, as rosbag has it."""
    return path.with_name(path.name + ".active")


class BagFile:
    """A bag while it is written; it is called ``FILE.active`` until it is closed.

    ``notes`` is the topic (std_msgs/String) of what the bag says about itself: when it begins, what it lacks, whether
    it ends with the run. Methods raise BagError where the disk does not take what is written.
    """

    def __init__(self, path: Path, notes: str) -> None:
        """Begin a bag."""
        self.path = path
        self._notes = notes
        self._flushes = 0
        with self._disk():
            path.parent.mkdir(parents=True, exist_ok=True)
            self._open("w")
            self._flush()

    @contextmanager
    def _disk(self, what: str = "written") -> Iterator[None]:
        """Turn errors of the disk and of rosbag into a BagError."""
        try:
            yield
        except (OSError, rosbag.ROSBagException) as error:
            raise BagError(f"the bag {self.path} cannot be {what}: {error}") from error

    def _open(self, mode: str) -> None:
        self._file = active(self.path).open("w+b" if mode == "w" else "r+b")
        self._bag = rosbag.Bag(self._file, mode, chunk_threshold=CHUNK, skip_index=mode == "a")

    def write(self, topic: str, data: bytes, header: Any, time: genpy.Time) -> None:
        """Take a message as it came over the wire, with its connection's header."""
        kind = type("Kind", (), {"_md5sum": header["md5sum"], "_full_text": header["message_definition"]})
        raw = (header["type"], data, header["md5sum"], kind)
        with self._disk():
            self._bag.write(topic, raw, max(time, FIRST), raw=True, connection_header=header)

    def note(self, text: str, time: genpy.Time) -> None:
        """Write a note about the bag into the bag."""
        with self._disk():
            self._bag.write(self._notes, String(text), max(time, FIRST))

    def flush(self) -> None:
        """Flush all that was written, so that it survives this process."""
        with self._disk():
            self._flush()
            self._flushes += 1
            if self._flushes % KEEP == 0:  # a Bag holds some 300 bytes for each message until it is closed
                self._bag.close()
                self._open("a")

    def _flush(self) -> None:
        self._bag.flush()
        self._file.flush()
        self._size = os.fstat(self._file.fileno()).st_size

    def resume(self, text: str, time: genpy.Time) -> None:
        """Go on behind what was flushed last, with a note; raises BagError as long as there is no room for more."""
        with suppress(OSError):  # of what it still holds
            self._file.close()
        with self._disk():
            with active(self.path).open("r+b") as file:
                file.truncate(self._size)
                os.posix_fallocate(file.fileno(), self._size, ROOM)
                file.truncate(self._size)
            self._file = active(self.path).open("r+b")
            self._bag = _reindexed(self._file)
            self.note(text, time)
            self._flush()

    def close(self) -> None:
        """End the bag: index it and give it its name."""
        with self._disk("closed"):
            self._bag.close()
            os.replace(active(self.path), self.path)


def _reindexed(file: Any) -> rosbag.Bag:
    """Return a bag whose writer did not close it, indexed and ready for more."""
    bag = rosbag.Bag(file, "a", chunk_threshold=CHUNK, allow_unindexed=True)
    for _ in bag.reindex():
        pass
    return bag


def mend(path: Path, to: Path, notes: str) -> None:
    """Make the bag ``to`` of what a killed writer has left of the bag ``path``, with a note that says so.

    Raises BagError where nothing of a bag is left.
    """
    left = active(path)
    try:
        _reindexed(str(left)).close()
        with rosbag.Bag(str(left)) as bag:
            end = genpy.Time.from_sec(bag.get_end_time()) if bag.get_message_count() else FIRST
        with rosbag.Bag(str(left), "a") as bag:
            bag.write(
                notes, String(f"mended: who wrote this was killed; lacks what came after {end.to_sec():.3f} s"), end
            )
        os.replace(left, to)
    except (OSError, rosbag.ROSBagException) as error:
        raise BagError(f"{left} holds no bag that can be mended: {error}") from error
