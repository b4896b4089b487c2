"""The navigation node, with the interface of move_base."""
