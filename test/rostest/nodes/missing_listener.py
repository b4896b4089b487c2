#!/usr/bin/env python3
"""Writes what it hears of news to standard error; rospy misses the first publisher that the master tells it of.

So it does where the master's reply to a subscription, with no publisher yet, comes after the news of one.
"""

import sys

import rospy
from rospy.impl.registration import RegManager
from std_msgs.msg import String

from rosoclingo.common.registration import Registration

if __name__ == "__main__":
    take, missed = RegManager.publisher_update, []

    def miss(manager, topic, addresses):
        """Take the first publisher of news for none."""
        if topic == "/news" and addresses and not missed:
            missed.extend(addresses)
            addresses = []
        take(manager, topic, addresses)

    RegManager.publisher_update = miss
    rospy.init_node("listener")
    rospy.Subscriber("news", String, lambda message: print(message.data, bool(missed), file=sys.stderr))
    Registration()
    rospy.spin()
