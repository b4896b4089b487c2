"""ROS adapters: they put the pure parts on topics, actions, services and parameters."""
