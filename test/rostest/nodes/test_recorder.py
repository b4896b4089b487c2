#!/usr/bin/env python3
"""The recorder: a bag holds everything up to the end of a run, or up to the recorder's death."""

import os
import re
import signal
import socketserver
import subprocess
import sys
import tempfile
import threading
import unittest
from pathlib import Path
from xmlrpc.server import SimpleXMLRPCServer

import rosbag
import rosgraph.network
import rosnode
import rospy
import rostest
from diagnostic_msgs.msg import DiagnosticArray
from rosgraph_msgs.msg import Clock
from std_msgs.msg import String

from rosoclingo.nodes.recording.bag_file import unfinished_path
from rosoclingo.nodes.recording.recorder import TOPICS, is_recording

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from interface_helpers import (
    PATIENCE,
    Process,
    executable,
    full_disk,
    init_node,
    process_of,
    wait_for_diagnosis,
    wait_until,
)

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
            wait_until(lambda: b"hello" in unfinished_path(self.bag).read_bytes(), "the first word in the file")
            record.signal(signal.SIGINT)
            speaking.signal(signal.SIGINT)
            self.assertEqual(record.wait(), (0, ""))
        words, notes = self.holds()
        self.assertEqual(words, ["hello", *map(str, range(WORDS))])
        self.assertEqual(notes, ["begins", "ends, with the run: complete"])

    def test_recorder_without_topics_has_its_own_list(self):
        if rospy.has_param("/record/topics"):  # another test's
            rospy.delete_param("/record/topics")
        with Process(executable("record"), f"_bag:={self.bag}") as record:
            with Process(str(HERE / "last_words.py"), "_words:=2", "last_words:=/rosoclingo/updates") as speaking:
                wait_until(lambda: is_recording(["/rosoclingo/updates"]), "the recorder to be connected")
                wait_until(lambda: b"hello" in unfinished_path(self.bag).read_bytes(), "the first word in the file")
                record.signal(signal.SIGINT)
                speaking.signal(signal.SIGINT)
                self.assertEqual(record.wait(), (0, ""))
        with rosbag.Bag(str(self.bag)) as read:
            words = [one.data for _, one, _ in read.read_messages(["/rosoclingo/updates"])]
        self.assertEqual(words, ["hello", "0", "1"])
        command = [executable("record"), "--help"]
        help_text = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True, timeout=PATIENCE).stdout
        for topic in TOPICS:
            self.assertIn((topic.rpartition("/plan")[0] and "plans") or topic.rpartition("/")[2], help_text)

    def test_recorder_names_node_that_does_not_end(self):
        with recorder(self.bag) as record, speaker():
            wait_until(recording, "the recorder to be connected")
            wait_until(lambda: b"hello" in unfinished_path(self.bag).read_bytes(), "the first word in the file")
            record.signal(signal.SIGINT)
            wait_until(lambda: is_recording([]), "the recorder to wait")
            record.signal(signal.SIGINT)
            self.assertEqual(record.wait()[0], 0)
        self.assertEqual(self.holds(), (["hello"], ["begins", "ends, later messages are missing on /last_words"]))

    def test_publisher_that_refuses_the_connection_is_not_waited_for(self):
        """As a node does that is ending when the recorder connects."""
        refused = self.register_refusing_node("/last_words")
        with recorder(self.bag) as record:
            self.assertTrue(refused.wait(PATIENCE), "the recorder has not connected")
            record.signal(signal.SIGINT)
            self.assertEqual(record.wait()[0], 0)
        self.assertEqual(self.holds(), ([], ["begins", "ends, with the run: complete"]))

    def register_refusing_node(self, topic):
        """Register a publisher that refuses all connections; return an event that is set by the first one."""
        host, refused = rosgraph.network.get_host_name(), threading.Event()

        class Refusal(socketserver.BaseRequestHandler):
            def handle(self):
                refused.set()
                rosgraph.network.write_ros_handshake_header(self.request, {"error": "node shutting down"})

        topics = socketserver.ThreadingTCPServer((host, 0), Refusal)
        topics.daemon_threads = True
        node = SimpleXMLRPCServer((host, 0), logRequests=False)
        node.register_function(lambda *_: (1, "", ["TCPROS", host, topics.server_address[1]]), "requestTopic")
        node.register_function(lambda *_: (1, "", []), "getPublications")  # so rospy gives up, but keeps the connection
        for server in (topics, node):
            threading.Thread(target=server.serve_forever, daemon=True).start()
            self.addCleanup(server.server_close)
            self.addCleanup(server.shutdown)
        uri = f"http://{host}:{node.server_address[1]}/"
        master = rosgraph.Master("/refusing")
        master.registerPublisher(topic, String._type, uri)
        self.addCleanup(master.unregisterPublisher, topic, uri)
        return refused

    def test_rosnode_kill_completes_the_bag(self):
        with recorder(self.bag) as record, speaker():
            wait_until(recording, "the recorder to be connected")
            wait_until(lambda: b"hello" in unfinished_path(self.bag).read_bytes(), "the first word in the file")
            rosnode.kill_nodes(["/record"])
            self.assertEqual(record.wait()[0], 0)
        self.assertEqual(self.holds()[0], ["hello"])

    def test_killed_recorder_leaves_earlier_messages(self):
        publisher = rospy.Publisher("last_words", String, queue_size=None, latch=True)
        with recorder(self.bag) as record:
            wait_until(lambda: publisher.get_num_connections() > 0, "the recorder")
            for number in range(100):
                publisher.publish(f"word {number}.")
            wait_until(lambda: b"word 99." in unfinished_path(self.bag).read_bytes(), "the last word in the file")
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
            wait_until(lambda: b"before" in unfinished_path(self.bag).read_bytes(), "the first word in the file")
            with full_disk(process_of("/record"), room=unfinished_path(self.bag).stat().st_size):
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
                word = b"\x00" + str(moment).encode()
                wait_until(lambda wanted=word: wanted in unfinished_path(self.bag).read_bytes(), "the word in the file")
            publisher.unregister()
            record.signal(signal.SIGINT)
            self.assertEqual(record.wait()[0], 0)
        self.assertEqual(self.holds()[0], ["100", "5", "7"])
        with rosbag.Bag(str(self.bag)) as bag:
            moments = [moment.to_sec() for _, _, moment in bag.read_messages(["/last_words"])]
        self.assertEqual(moments, [100.0, 100.0, 102.0])

    def test_bad_parameters_and_files_are_refused(self):
        for arguments, text in (
            (("_topics:=[]",), "~topics: must be a list of topics, not []"),
            (("_topics:=[a]", "_bag:=/proc/no/run.bag"), "the bag /proc/no/run.bag cannot be written"),
        ):
            with Process(executable("record"), *[one.replace("~", "_") for one in arguments]) as process:
                code, error = process.wait()
            self.assertEqual(code, 1, error)
            self.assertIn(text, error)
            self.assertNotIn("Traceback", error)

    def start(self, *command, **pipes):
        process = subprocess.Popen(command, start_new_session=True, text=True, stderr=subprocess.DEVNULL, **pipes)
        self.addCleanup(self.end, process)
        return process

    def end(self, process):
        """Press Ctrl-C, and wait."""
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGINT)
            process.wait(PATIENCE)

    def test_ctrl_c_bag_has_the_results_of_the_end(self):
        """Without world and navigation: the goal's first action waits for a server when Ctrl-C comes."""
        nothing = [f"{layer}:=none" for layer in ("sim", "nav", "map_server", "localization")]
        bag = ("record:=true", f"bag:={self.bag}")
        launch = self.start("roslaunch", "rosoclingo", "mailbot.launch", *nothing, *bag, stdout=subprocess.DEVNULL)
        wait_until(lambda: is_recording(["/rosoclingo/result", "/out_rosoclingo"]), "the recorder")
        client = self.start(executable("request"), "goal(office3,office2,1)", stdout=subprocess.PIPE)
        self.assertIn("active", client.stdout.readline())
        self.end(launch)
        reported = client.communicate(timeout=PATIENCE)[0].splitlines()[-1]
        with rosbag.Bag(str(self.bag)) as bag:
            results = [message for _, message, _ in bag.read_messages(["/rosoclingo/result"])]
            notes = [message.data for _, message, _ in bag.read_messages([NOTES])]
        self.assertEqual([f"aborted: {one.status.text}" for one in results], [reported])
        self.assertEqual(notes[-1], "ends, with the run: complete")


if __name__ == "__main__":
    init_node("recorder_test")
    rostest.rosrun("rosoclingo", "recorder", Recorder, sys.argv)
