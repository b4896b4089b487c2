#!/usr/bin/env python3
"""An actionlib server that logs each goal to a file. SIGUSR1 makes it hold goals, SIGUSR2 ends them."""

import signal

import rospy
from actionlib.action_server import ActionServer
from actionlib.msg import TestAction


class SignalledServer:
    """Ends each goal at once, except while it holds goals."""

    def __init__(self, name, log):
        self._log, self._holds, self._held = log, False, []
        signal.signal(signal.SIGUSR1, self._hold)
        signal.signal(signal.SIGUSR2, self._release)
        self._server = ActionServer(name, TestAction, self._accept, auto_start=False)
        self._server.start()

    def _accept(self, handle):
        handle.set_accepted()
        with open(self._log, "a") as log:
            log.write(f"{handle.get_goal().goal}\n")
        if self._holds:
            self._held.append(handle)
        else:
            handle.set_succeeded()

    def _hold(self, *_):
        self._holds = True

    def _release(self, *_):
        self._holds = False
        while self._held:
            self._held.pop().set_succeeded()


rospy.init_node("server")
server = SignalledServer(*rospy.myargv()[1:])
rospy.spin()
