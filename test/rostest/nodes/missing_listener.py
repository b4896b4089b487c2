#!/usr/bin/env python3
"""Writes the received news to standard error; rospy misses the first publisher that the master reports to it.

This is what happens if the master's reply to a subscription, still without a publisher, arrives after the update.
"""

import sys

import rospy
from rospy.impl.registration import RegManager
from std_msgs.msg import String

from rosoclingo.common.registration import Registration

if __name__ == "__main__":
    take, missed = RegManager.publisher_update, []

    def miss(manager, topic, addresses):
        """Miss the first publisher of news."""
        if topic == "/news" and addresses and not missed:
            missed.extend(addresses)
            addresses = []
        take(manager, topic, addresses)

    RegManager.publisher_update = miss
    rospy.init_node("listener")
    rospy.Subscriber("news", String, lambda message: print(message.data, bool(missed), file=sys.stderr))
    Registration()
    rospy.spin()
