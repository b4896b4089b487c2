"""Navigation as a node, as move_base."""
