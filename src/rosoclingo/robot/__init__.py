"""Simulated robot: navigation, simulation and their nodes. A real robot replaces this package."""
