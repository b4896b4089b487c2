#!/usr/bin/env python3
"""Publishes ~words numbers on last_words when it is ended."""

import rospy
from std_msgs.msg import String

if __name__ == "__main__":
    rospy.init_node("speaker")
    words = rospy.get_param("~words")
    rospy.on_shutdown(lambda: [publisher.publish(str(number)) for number in range(words)])
    publisher = rospy.Publisher("last_words", String, queue_size=None, latch=True)
    publisher.publish("hello")
    rospy.spin()
