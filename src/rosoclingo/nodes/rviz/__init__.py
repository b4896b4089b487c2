"""What rviz shows: labels, things, ways, plan and goals."""
