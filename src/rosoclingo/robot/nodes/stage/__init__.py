"""The simulator node, with the interface of stage_ros."""
