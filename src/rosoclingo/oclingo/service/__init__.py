"""The solver as oClingo's TCP service and as a command."""
