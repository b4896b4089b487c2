"""Markers for rviz: labels, things, ways, plan and goals."""
