"""Worker processes that run the planner."""
