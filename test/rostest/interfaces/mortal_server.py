#!/usr/bin/env python3
"""An actionlib server that accepts goals and never ends them; the test kills it, or only its topics, by SIGUSR1."""

import signal
import socket
import struct

import rospy
from actionlib.action_server import ActionServer
from actionlib.msg import TestAction


def vanish(*_):
    """Reset all connections and remove the topics; the node stays alive."""
    for topic in (server.status_pub, server.result_pub, server.feedback_pub, server.goal_sub, server.cancel_sub):
        for connection in topic.impl.connections:
            connection.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
            connection.socket.close()
        topic.unregister()


rospy.init_node("mortal", anonymous=True)
signal.signal(signal.SIGUSR1, vanish)
server = ActionServer("mortal", TestAction, lambda handle: handle.set_accepted(), auto_start=False)
server.start()
rospy.spin()
