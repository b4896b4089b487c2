"""Workloads that depend on the profile: the standing run uses smaller ones than ``random`` and ``thorough``."""

from hypothesis import settings

#: Examples of the profile ``random``, and of larger ones.
FULL = 100


def sized(standing, full):
    """Return the workload ``full`` if the profile has many examples, otherwise the one of the standing run."""
    return full if settings.default.max_examples >= FULL else standing
