"""The simulator as a node, as stage_ros."""
