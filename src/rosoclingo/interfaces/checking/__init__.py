"""Checks of a robot's labels, interfaces and orders against a program; of ROS they only need genpy."""
