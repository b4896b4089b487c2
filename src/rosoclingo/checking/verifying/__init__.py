"""Looks for a stream that breaks a program: the core itself, on every way that goals, returns and facts may take."""
