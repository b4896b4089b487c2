"""The planner in processes of its own."""
