"""The reactive solver: updates in, answers out, growing the horizon."""
