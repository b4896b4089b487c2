"""Checks of a program before it drives a robot: lint, trial plans, verification."""
