"""What is set for a robot, labels and interfaces, beside a program, before anything runs.  No ROS but genpy."""
