"""Numerical loops of navigation, compiled by numba."""
