"""ROS nodes and commands: connect the pure parts to topics, actions, services and parameters."""
