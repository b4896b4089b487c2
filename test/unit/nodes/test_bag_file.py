"""The bag during recording: its content after any flush, and after its writer dies anywhere."""

import genpy
import pytest
import rosbag
from full_disk import room_for
from std_msgs.msg import String

from rosoclingo.nodes.recording import bag_file
from rosoclingo.nodes.recording.bag_file import BagError, BagFile, repair, unfinished_path

HEADER = {"type": String._type, "md5sum": String._md5sum, "message_definition": String._full_text, "latching": "1"}


def write(bag, *texts):
    for text in texts:
        length = len(text).to_bytes(4, "little")
        bag.write("/said", length + text.encode(), HEADER, genpy.Time(int(text)))


def read(path):
    with rosbag.Bag(str(path)) as bag:
        return [message.data for _, message, _ in bag.read_messages(["/said"])]


def test_bag_repair_refuses_other_files(tmp_path):
    path = tmp_path / "run.bag"
    for content in (b"", b"#ROSBAG V2.0\n", b"something else"):
        unfinished_path(path).write_bytes(content)
        with pytest.raises(BagError, match=r"run\.bag\.active cannot be repaired"):
            repair(path, path, "/notes")
    assert not path.exists()


def fill(bag):
    """Write more than fits on the disk."""
    for number in range(10, 100):
        write(bag, str(number))
        bag.flush()


@pytest.mark.parametrize(("keep", "room"), [(2, 5000), (300, 100)])
def test_bag_recording_continues_once_full_disk_has_room(tmp_path, monkeypatch, keep, room):
    monkeypatch.setattr(bag_file, "KEEP", keep)
    bag = BagFile(tmp_path / "run.bag", "/notes")
    write(bag, "1", "2")
    bag.flush()
    with room_for(unfinished_path(bag.path).stat().st_size + room):
        with pytest.raises(BagError, match=r"run\.bag cannot be written: .*File too large"):
            fill(bag)
        for _ in range(2):
            with pytest.raises(BagError, match=r"run\.bag cannot be written: .*File too large"):
                bag.resume("lacks a lot", genpy.Time(100))
        left = unfinished_path(bag.path).read_bytes()
    bag.resume("lacks a lot", genpy.Time(100))
    write(bag, "101")
    bag.flush()
    write(bag, "102")
    bag.close()
    found = [int(text) for text in read(bag.path)]
    assert found[:2] == [1, 2]
    assert found[2:-2] == list(range(10, 10 + len(found) - 4)), "the flushed messages are there"
    assert found[-2:] == [101, 102]
    assert bag.path.read_bytes()[4117:].startswith(left[4117:]), "nothing is written twice, behind the file's header"
    with rosbag.Bag(str(bag.path)) as whole:
        assert [message.data for _, message, _ in whole.read_messages(["/notes"])] == ["lacks a lot"]


def test_bag_that_ends_on_full_disk_is_repairable(tmp_path):
    bag = BagFile(tmp_path / "run.bag", "/notes")
    write(bag, "1", "2")
    bag.flush()
    with room_for(unfinished_path(bag.path).stat().st_size), pytest.raises(
        BagError, match=r"run\.bag cannot be closed"
    ):
        bag.close()
    repair(bag.path, bag.path, "/notes")
    assert read(bag.path) == ["1", "2"]
