"""The core as a node."""
