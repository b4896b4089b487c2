"""Scenarios played with real goals."""
