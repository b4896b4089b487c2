"""People operate robots by their pages: order, see, report a fact, ask why, pause and stop."""

import tempfile
import unittest
from contextlib import ExitStack
from pathlib import Path

import browser
import rospy
import yaml
from core_helpers import ManualInterfaces
from interface_helpers import Process, executable, wait_until
from rosoclingo.msg import PackageState, PackageStates
from std_msgs.msg import String

from rosoclingo.nodes.new_package import new_package

ROOT = Path(__file__).resolve().parents[3]


class Hands(ManualInterfaces):
    """Interfaces whose drives to the place ``shut`` are blocked, if they answer at once."""

    shut = ""

    def succeed(self, command):
        interface, parameter, cycle = command[len("_action_lib(") : -1].split(",")
        if parameter == self.shut and interface == "move_base":
            self.tell(f"_return(move_base,blocked,{cycle})")
        else:
            super().succeed(command)


class OperatedPages(unittest.TestCase):
    def setUp(self):
        path = browser.found()
        if path is None:
            self.skipTest("there is no browser: install chromium")
        self.ends = ExitStack()
        self.addCleanup(self.ends.close)
        self.page = self.ends.enter_context(browser.Browser(path))
        self.page.size(1400, 900)

    def start(self, name, programs, labels, orders):
        """Start a core and its page in a namespace, with the test as the interfaces; open the page."""
        core, web = f"/{name}/rosoclingo", f"/{name}/web"
        places = yaml.safe_load(labels.read_text())
        rospy.set_param(core, {"program_files": list(map(str, programs)), "labels": places, "journal": "none"})
        rospy.set_param(web, {"port": 0, "orders": yaml.safe_load(orders.read_text())})
        for node in ("core", "web"):
            full = core if node == "core" else web
            self.ends.enter_context(Process(executable(node), f"__name:={Path(full).name}", f"__ns:=/{name}"))
        self.hands = Hands(core)
        self.page.open(rospy.wait_for_message(f"{web}/address", String).data)
        self.page.wait_for("document.getElementById('now').textContent === 'Idle: no open goals'")
        self.page.wait_for("document.getElementById('light').textContent === 'All is well'")

    def send(self, form, **chosen):
        """Fill the form of this title and send it."""
        inside = f"#orders form[aria-label='{form}']"
        for name, value in chosen.items():
            self.page.choose(f"{inside} select[name={name}]", value)
        self.page.click(f"{inside} button")

    def command(self, text):
        """Give a command, and confirm it."""
        self.page.push(text, "#commands")
        if text != "Continue":
            self.page.push(text, "#dialog")

    def says(self, text):
        self.page.wait_for(f"document.getElementById('messages').textContent.includes({text!r})")

    def last_order(self, words, state):
        row = "document.querySelector('#orders tbody tr:last-child')"
        self.page.wait_for(
            f"{row} !== null && {row}.innerText.includes({words!r}) && {row}.innerText.includes({state!r})"
        )

    def now(self, text):
        self.page.wait_for(f"document.getElementById('now').textContent.startsWith({text!r})")

    def why(self, text):
        """Ask why the last order was not met."""
        self.page.push("Why?", "#orders tbody")
        self.page.wait_for(f"document.getElementById('dialog').innerText.includes({text!r})")
        self.page.push("Close", "#dialog")

    def test_package_of_the_command_new_is_operated_by_its_page(self):
        folder = Path(self.ends.enter_context(tempfile.TemporaryDirectory()))
        new_package("guard", folder, ROOT / "templates" / "package")
        guard = folder / "guard"
        self.start("guard", [guard / "encodings/guard.lp"], guard / "config/labels.yaml", guard / "config/orders.yaml")
        self.hands.at_once = True
        self.send("A place is closed", place="study")
        self.says("Reported: A place is closed: study")
        self.page.wait_for("document.getElementById('log').textContent.includes('_closed(study')")
        self.send("Visit a place", place="study")
        self.says("Rejected: Visit the study (")
        self.why("the study is closed")
        self.hands.at_once = False
        self.send("Visit a place", place="bedroom")
        command = self.hands.take()
        self.now("Drives to bedroom")
        self.command("Pause")
        self.now("Paused after this")
        seen = len(self.hands.seen)
        self.send("Visit a place", place="bathroom")
        self.hands.succeed(command)
        self.now("Paused")
        self.last_order("Visit the bathroom", "under way")
        self.assertEqual(self.hands.seen[seen:], [])
        self.page.wait_for("document.getElementById('light').textContent === 'Warning'")
        self.command("Continue")
        command = self.hands.take()
        self.command("Stop")
        wait_until(lambda: any(one.startswith("_cancel") for one in self.hands.seen), "the cancel of the action")
        self.hands.fail(command, "preempted")
        self.now("Stopped")
        self.last_order("Visit the bathroom", "given up")
        self.page.click("a[download]")
        self.hands.at_once = True
        self.send("Visit a place", place="home")
        self.last_order("Visit the home", "done")
        self.assertEqual(self.page.faults, [])

    def test_mailbot_is_operated_by_its_page(self):
        things = rospy.Publisher("/mailbot/packages", PackageStates, queue_size=1, latch=True)
        things.publish(packages=[PackageState("7", "office3", False), PackageState("8", "office1", False)])
        programs = [ROOT / "encodings" / name for name in ("mailbot.lp", "office.lp")]
        self.start("mailbot", programs, ROOT / "config/office_labels.yaml", ROOT / "config/office_orders.yaml")
        order = {"form": "Deliver a package"}
        self.hands.at_once = True
        self.send(**order, package="7", to="office2")
        self.says("Done: Bring package 7 from office3 to office2")
        self.hands.shut = "office4"
        self.send(**order, package="8", to="office4")
        self.says("Given up: Bring package 8 from office1 to office4 (")
        self.why("office4")
        self.hands.shut = ""
        self.send("The way is clear again", **{"from": "office3", "to": "office4"})
        self.says("Reported: The way is clear again")
        self.send(**order, package="8", to="office4")
        self.last_order("Bring package 8 from office1 to office4", "done")
        self.assertEqual(self.page.faults, [])
