#!/usr/bin/env python3
"""An actionlib server that accepts goals and never ends them; the test kills it."""

import rospy
from actionlib.action_server import ActionServer
from actionlib.msg import TestAction

rospy.init_node("mortal", anonymous=True)
server = ActionServer("mortal", TestAction, lambda handle: handle.set_accepted(), auto_start=False)
server.start()
rospy.spin()
