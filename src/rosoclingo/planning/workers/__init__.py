"""The reactive solver in a process of its own."""
