"""The two-dimensional world: robots, sensors, doors, packages (pure)."""
