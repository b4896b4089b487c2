"""The planner of the core: it folds a history of updates into a snapshot, grounds it and asks questions about plans."""
