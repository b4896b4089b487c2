"""The core node's start: bad parameters, gaps of a program; and the end of a request."""

import signal
import tempfile
import unittest

from actionlib_msgs.msg import GoalStatus
from core_helpers import Client, Updates, start_core
from interface_helpers import Process, executable, send_request


class CoreStart(unittest.TestCase):
    def test_bad_parameters_end_the_start(self):
        with start_core("zero", horizon_limit=0) as process:
            process.refuses("~horizon_limit: must be an integer of at least 1, not 0")

    def test_unread_parameters_are_reported(self):
        arm = ("_interfaces:={arm: {type: actionlib/TestAction}}", "_server_timout:=3", "_retries:=1")
        for process, words in (
            (start_core("misspelt", horizon_limt=7), "~horizon_limt (did you mean ~horizon_limit?)"),
            (Process(executable("interface"), "__name:=arm", *arm), "~server_timout (did you mean ~server_timeout?)"),
        ):
            with process:
                lines = process.lines_until("unknown parameters")
            self.assertIn(words, lines[-1])

    def test_program_gaps_are_reported_at_the_start(self):
        with tempfile.NamedTemporaryFile("w", suffix=".lp") as file:
            file.write("#const n = 2.\n#program cumulative(t).\n{ _action_lib(go,n,t) }.\n")
            file.flush()
            with start_core("lacking", program_files=f"[{file.name}]", constants="{n: -2}") as process:
                Client("lacking/rosoclingo").send("go(1)").ends_as(GoalStatus.REJECTED)
                process.signal(signal.SIGINT)
                error = process.wait()[1]
        for text in ("no external _request/2 (write", "no external _return/3 (write", "no volatile part", "n is -2"):
            self.assertEqual(error.count(text), 1, error)

    def test_request_is_cancelled_on_ctrl_c(self):
        with start_core("asked", action_timeout=2.0):
            updates = Updates("asked/rosoclingo")
            words = ("do(walk,1)", "--plain", "--server", "asked/rosoclingo")
            with send_request(*words) as request:
                lines = request.lines_until("walks 1")
                request.signal(signal.SIGINT)
                updates.wait_for("cancel(1)")
                code, rest = request.wait()
        lines += rest.splitlines()
        self.assertEqual(code, 2)
        self.assertEqual(lines[:2], ["walks 1", "cancelling do(walk,1) (Ctrl-C again: do not wait)"])
        self.assertTrue(lines[-1].startswith("do(walk,1): cancelled"), lines)
        self.assertFalse([one for one, after in zip(lines, lines[1:]) if one == after], "news are printed once")
