"""Numerical loops of the simulation, compiled by numba."""
