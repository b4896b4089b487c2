"""What rviz shows of labels, packages and plans."""
