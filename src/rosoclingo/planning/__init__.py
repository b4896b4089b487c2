"""The planner of the core: a history of updates is folded to a snapshot, grounded, and asked questions."""
