"""Answer set programs that control robots: a reactive solver, a reasoning core and its ROS nodes."""
