"""Nodes of the stand-in for a robot."""
