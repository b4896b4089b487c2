"""Occupancy grids, path planning, path following and recovery (pure)."""
