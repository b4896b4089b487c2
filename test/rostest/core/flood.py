#!/usr/bin/env python3
"""Floods the core with facts as fast as it reads them, since the topic has no queue; the argument selects the facts."""

import itertools

import rospy
from rosoclingo.msg import InterfaceIO

#: The facts of two flooding nodes, with a running number. A return of a cycle that runs would fail its action.
FLOODS = {"sensor": ("_seen({})", "reading({})"), "stray": ("x{}((", "_return(walk,{},1000000)")}

if __name__ == "__main__":
    rospy.init_node("flood", anonymous=True)
    kind = rospy.myargv()[1]
    publisher = rospy.Publisher("in_rosoclingo", InterfaceIO, queue_size=None)
    numbers = itertools.count()
    for fact in itertools.cycle(FLOODS[kind]):
        if rospy.is_shutdown():
            break
        publisher.publish(InterfaceIO(kind, [fact.format(next(numbers)) for _ in range(500)]))
