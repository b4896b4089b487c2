"""The recorder: a bag holds everything up to the end of a run, or up to the recorder's death."""

import re
import signal
import tempfile
import unittest
from pathlib import Path

import rosbag
import rospy
from diagnostic_msgs.msg import DiagnosticArray
from full_disk import room_for
from interface_helpers import (
    Process,
    executable,
    process_of,
    send_request,
    wait_for_diagnosis,
    wait_until,
)
from rosgraph_msgs.msg import Clock
from std_msgs.msg import String

from rosoclingo.nodes.recording.bag_file import unfinished_path
from rosoclingo.nodes.recording.recorder import is_recording

HERE = Path(__file__).resolve().parent
NOTES = "/record/notes"
WORDS = 5000


def recorder(bag, topics="[last_words]"):
    return Process(executable("record"), f"_bag:={bag}", f"_topics:={topics}")


def speaker(words=WORDS):
    return Process(str(HERE / "last_words.py"), f"_words:={words}")


def recording():
    return is_recording(["/last_words"])


class Recorder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.bag = Path(folder.name, "run.bag")

    def until_written(self, words):
        """Wait until the bag's file has these words."""
        wait_until(lambda: words.encode() in unfinished_path(self.bag).read_bytes(), f"{words} in the file")

    def holds(self, bag=None):
        """Return the texts of the recorded topic, and the bag's notes about itself."""
        with rosbag.Bag(str(bag or self.bag)) as read:
            messages = [(topic, message.data) for topic, message, _ in read.read_messages()]
        notes = [text for topic, text in messages if topic == NOTES]
        return [text for topic, text in messages if topic == "/last_words"], notes

    def test_recorder_ends_last_of_all(self):
        """As with roslaunch, all nodes are asked to end at once, and the recorder would be the first to do so."""
        with recorder(self.bag) as record, speaker() as speaking:
            wait_until(recording, "the recorder to be connected")
            self.until_written("hello")
            record.signal(signal.SIGINT)
            speaking.signal(signal.SIGINT)
            self.assertEqual(record.wait(), (0, ""))
        words, notes = self.holds()
        self.assertEqual(words, ["hello", *map(str, range(WORDS))])
        self.assertEqual(notes, ["begins", "ends, with the run: complete"])

    def test_recorder_names_node_that_does_not_end(self):
        with recorder(self.bag) as record, speaker():
            wait_until(recording, "the recorder to be connected")
            self.until_written("hello")
            record.signal(signal.SIGINT)
            wait_until(lambda: is_recording([]), "the recorder to wait")
            record.signal(signal.SIGINT)
            self.assertEqual(record.wait()[0], 0)
        self.assertEqual(self.holds(), (["hello"], ["begins", "ends, later messages are missing on /last_words"]))

    def test_killed_recorder_leaves_earlier_messages(self):
        publisher = rospy.Publisher("last_words", String, queue_size=None, latch=True)
        with recorder(self.bag) as record:
            wait_until(lambda: publisher.get_num_connections() > 0, "the recorder")
            for number in range(100):
                publisher.publish(f"word {number}.")
            self.until_written("word 99.")
            record.signal(signal.SIGKILL)
        publisher.unregister()
        with recorder(self.bag, "[nothing]") as record:
            wait_until(self.bag.with_name("run_1.bag").exists, "the bag to be laid aside")
            wait_until(lambda: is_recording([]), "the next recorder")
            record.signal(signal.SIGINT)
            self.assertIn("was killed", record.wait()[1])
        words, notes = self.holds(self.bag.with_name("run_1.bag"))
        self.assertEqual(words, [f"word {number}." for number in range(100)])
        self.assertIn("repaired: the recorder was killed; messages after", notes[-1])
        self.assertEqual(self.holds()[1], ["begins", "ends, with the run: complete"])

    def test_full_disk_is_reported_once_and_recording_resumes(self):
        publisher = rospy.Publisher("last_words", String, queue_size=None)
        with recorder(self.bag) as record:
            wait_until(recording, "the recorder to be connected")
            publisher.publish("before")
            self.until_written("before")
            with room_for(unfinished_path(self.bag).stat().st_size, process_of("/record")):
                publisher.publish("lost")
                is_full = re.compile(r"the bag .*/run\.bag cannot be written: .*File too large").match
                wait_for_diagnosis("rosoclingo: recorder", lambda one: is_full(one.message), "the trouble")
            wait_for_diagnosis("rosoclingo: recorder", lambda one: one.message == "recording", "its end")
            publisher.publish("after")
            publisher.unregister()
            record.signal(signal.SIGINT)
            code, error = record.wait()
        self.assertEqual((code, error.count("cannot be written")), (0, 1), error)
        words, notes = self.holds()
        self.assertEqual(words, ["before", "after"])
        self.assertRegex(notes[1], r"^messages from .* s to .* s are missing: the bag .* cannot be written: ")
        self.assertEqual((notes[0], notes[2]), ("begins", "ends, with the run: with the gaps noted before"))

    def test_messages_stay_ordered_when_time_goes_back(self):
        publisher = rospy.Publisher("last_words", String, queue_size=None)
        clock = rospy.Publisher("/clock", Clock, queue_size=10, latch=True)
        self.addCleanup(clock.unregister)
        times = []
        rospy.Subscriber("/diagnostics", DiagnosticArray, lambda one: times.append(one.header.stamp.to_sec()))
        rospy.set_param("/use_sim_time", True)  # for the recorder; this node has been there before
        self.addCleanup(rospy.delete_param, "/use_sim_time")
        with recorder(self.bag) as record:
            wait_until(recording, "the recorder to be connected")
            for moment in (100, 5, 7):
                clock.publish(Clock(rospy.Time(moment)))
                wait_until(lambda wanted=moment: times[-1:] == [wanted], "the time to arrive")
                publisher.publish(str(moment))
                self.until_written(f"\0{moment}")
            publisher.unregister()
            record.signal(signal.SIGINT)
            self.assertEqual(record.wait()[0], 0)
        self.assertEqual(self.holds()[0], ["100", "5", "7"])
        with rosbag.Bag(str(self.bag)) as bag:
            moments = [moment.to_sec() for _, _, moment in bag.read_messages(["/last_words"])]
        self.assertEqual(moments, [100.0, 100.0, 102.0])

    def test_bad_parameters_and_files_are_refused(self):
        for bag, topics, text in (
            (self.bag, "[]", "~topics: must be a list of topics, not []"),
            ("/proc/no/run.bag", "[a]", "the bag /proc/no/run.bag cannot be written"),
        ):
            with recorder(bag, topics) as process:
                process.refuses(text)

    def test_ctrl_c_bag_has_the_results_of_the_end(self):
        """Without world and navigation: the goal's first action waits for a server when Ctrl-C comes."""
        nothing = [f"{layer}:=none" for layer in ("sim", "nav", "map_server", "localization")]
        bag = ("record:=true", f"bag:={self.bag}")
        with Process("roslaunch", "rosoclingo", "mailbot.launch", *nothing, *bag) as launch:
            wait_until(lambda: is_recording(["/rosoclingo/result", "/out_rosoclingo"]), "the recorder")
            with send_request("goal(office3,office2,1)") as client:
                client.lines_until("active")
                launch.signal(signal.SIGINT)
                launch.wait()
                reported = client.wait()[1].splitlines()[-1]
        with rosbag.Bag(str(self.bag)) as bag:
            results = [message for _, message, _ in bag.read_messages(["/rosoclingo/result"])]
            notes = [message.data for _, message, _ in bag.read_messages([NOTES])]
        self.assertEqual([f"aborted: {one.status.text}" for one in results], [reported])
        self.assertEqual(notes[-1], "ends, with the run: complete")
