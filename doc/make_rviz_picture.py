"""Make doc/images/mailbot_rviz.png: the mailbot at work, in a real rviz on a virtual screen.

Run it in the built workspace: ./dev exec python3 doc/make_rviz_picture.py
It starts everything with a master of its own, sends two requests, and takes the picture while the robot carries a
package from one office to the next.  Needs Xvfb, Pillow with X11 support, and rviz; rendering is done in software.
"""

import contextlib
import math
import os
import socket
import subprocess
import sys
import time
from pathlib import Path

import rospy
from actionlib import ActionClient
from nav_msgs.msg import Odometry
from PIL import Image, ImageGrab
from rosoclingo.msg import PackageStates, ROSoClingoAction, ROSoClingoGoal

PICTURE = Path(__file__).resolve().parent / "images" / "mailbot_rviz.png"
DISPLAY = ":93"
SCREEN = "1280x900x24"
REQUESTS = ("goal(office3,office2,1)", "goal(office2,office4,4)")
BETWEEN = (6.4, 8.9)  # metres along the corridor: between office2 and office3
PATIENCE = 600.0  # seconds


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


@contextlib.contextmanager
def running(*command, **options):
    """A process that is ended, and waited for, in the end."""
    with subprocess.Popen(command, **options) as process:
        try:
            yield process
        finally:
            process.send_signal(2)
            try:
                process.wait(60)
            except subprocess.TimeoutExpired:
                process.kill()


class Watch:
    """Knows whether the moment for the picture has come."""

    def __init__(self):
        self.carried = False
        self.x = 0.0
        self.moving = False
        rospy.Subscriber("packages", PackageStates, self._packages)
        rospy.Subscriber("base_pose_ground_truth", Odometry, self._pose)

    def _packages(self, message):
        self.carried = any(package.carried for package in message.packages)

    def _pose(self, message):
        self.x = message.pose.pose.position.x
        twist = message.twist.twist.linear
        self.moving = math.hypot(twist.x, twist.y) > 0.3

    def come(self):
        return self.carried and self.moving and BETWEEN[0] < self.x < BETWEEN[1]


def wait_for(condition, what):
    end = time.monotonic() + PATIENCE
    while not condition():
        if time.monotonic() > end:
            sys.exit(f"gave up waiting for {what}")
        time.sleep(0.05)


def take_picture(display, path=PICTURE):
    save(ImageGrab.grab(xdisplay=display), path)


def save(picture, path):
    """Save a picture with few colours, and print its size."""
    picture.convert("P", palette=Image.ADAPTIVE, colors=256).save(path, optimize=True)
    print(f"{path}: {path.stat().st_size // 1000} kB")


def play():
    rospy.init_node("make_rviz_picture", disable_signals=True)
    watch = Watch()
    client = ActionClient("rosoclingo", ROSoClingoAction)
    wait_for(lambda: client.pub_goal.get_num_connections() and watch.x > 0.0, "the core and the simulator")
    wait_for(lambda: client.status_sub.get_num_connections(), "the core")
    time.sleep(8.0)  # rviz and move_base need a moment more, and nothing tells when rviz has drawn
    handles = [client.send_goal(ROSoClingoGoal(request)) for request in REQUESTS]
    wait_for(watch.come, "the robot to carry a package")
    take_picture(DISPLAY)
    del handles


def main():
    port = str(free_port())
    os.environ.update(ROS_MASTER_URI=f"http://localhost:{port}", DISPLAY=DISPLAY, LIBGL_ALWAYS_SOFTWARE="1")
    launch = ("roslaunch", "-p", port, "rosoclingo", "mailbot.launch", "rviz:=true", "speed:=0.5")
    with running("Xvfb", DISPLAY, "-screen", "0", SCREEN), running(*launch, stdout=subprocess.DEVNULL):
        end = time.monotonic() + PATIENCE
        while subprocess.call(["rostopic", "list"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL):
            if time.monotonic() > end:
                sys.exit("no master")
        play()


if __name__ == "__main__":
    main()
