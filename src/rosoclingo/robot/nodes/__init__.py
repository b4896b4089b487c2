"""ROS nodes of the simulated robot: move_base, simulator, map server, localisation and office."""
