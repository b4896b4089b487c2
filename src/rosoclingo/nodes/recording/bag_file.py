"""A bag that stays readable when its writer is killed, except for the last second."""

import os
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, Iterator

import genpy
import rosbag
from std_msgs.msg import String

#: Bytes of one chunk; an unfinished chunk is lost with the process, so each flush finishes one.
CHUNK = 768 * 1024

#: Free bytes that a full disk needs before writing resumes.
ROOM = 2 * CHUNK

#: Number of flushes after which the index in memory is released.
KEEP = 300

#: The earliest time of a message in a bag.
FIRST = genpy.Time(0, 1)


class BagError(RuntimeError):
    """A bag that cannot be written or repaired; the text has the file and the reason."""


def unfinished_path(path: Path) -> Path:
    """Return the path of an unfinished bag, as in rosbag."""
    return path.with_name(path.name + ".active")


class BagFile:
    """The writer of a bag, which is called ``FILE.active`` until it is closed.

    ``notes`` is the topic (std_msgs/String) of notes about the bag itself: its beginning, its gaps, and whether it ends
    with the run. Methods raise BagError if the disk cannot be written.
    """

    def __init__(self, path: Path, notes: str) -> None:
        """Create the bag."""
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
        self._file = unfinished_path(self.path).open("w+b" if mode == "w" else "r+b")
        self._bag = rosbag.Bag(self._file, mode, chunk_threshold=CHUNK, skip_index=mode == "a")

    def write(self, topic: str, data: bytes, header: Any, time: genpy.Time) -> None:
        """Write a serialized message with its connection's header."""
        kind = type("Kind", (), {"_md5sum": header["md5sum"], "_full_text": header["message_definition"]})
        raw = (header["type"], data, header["md5sum"], kind)
        with self._disk():
            self._bag.write(topic, raw, max(time, FIRST), raw=True, connection_header=header)

    def add(self, topic: str, message: Any, time: genpy.Time) -> None:
        """Write a message of the recorder itself."""
        with self._disk():
            self._bag.write(topic, message, max(time, FIRST))

    def note(self, text: str, time: genpy.Time) -> None:
        """Write a note about the bag into the bag."""
        self.add(self._notes, String(text), time)

    def flush(self) -> None:
        """Flush all messages, so that they survive this process."""
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
        """Continue after the last flush, with a note; raises BagError while the disk is full."""
        with suppress(OSError):  # from buffered data
            self._file.close()
        with self._disk():
            with unfinished_path(self.path).open("r+b") as file:
                file.truncate(self._size)
                os.posix_fallocate(file.fileno(), self._size, ROOM)
                file.truncate(self._size)
            self._file = unfinished_path(self.path).open("r+b")
            self._bag = _reindexed(self._file)
            self.note(text, time)
            self._flush()

    def close(self) -> None:
        """Index the bag and give it its final name."""
        with self._disk("closed"):
            self._bag.close()
            os.replace(unfinished_path(self.path), self.path)


def _reindexed(file: Any) -> rosbag.Bag:
    """Reindex a bag whose writer did not close it, and return it, ready for writing."""
    bag = rosbag.Bag(file, "a", chunk_threshold=CHUNK, allow_unindexed=True)
    for _ in bag.reindex():
        pass
    return bag


def repair(path: Path, to: Path, notes: str) -> None:
    """Repair the unfinished bag ``path`` of a killed writer as the bag ``to``, with a note about the gap.

    Raises BagError if nothing can be repaired.
    """
    left = unfinished_path(path)
    try:
        _reindexed(str(left)).close()
        with rosbag.Bag(str(left)) as bag:
            end = genpy.Time.from_sec(bag.get_end_time()) if bag.get_message_count() else FIRST
        with rosbag.Bag(str(left), "a") as bag:
            note = f"repaired: the recorder was killed; messages after {end.to_sec():.3f} s are missing"
            bag.write(notes, String(note), end)
        os.replace(left, to)
    except (OSError, rosbag.ROSBagException) as error:
        raise BagError(f"{left} cannot be repaired: {error}") from error
