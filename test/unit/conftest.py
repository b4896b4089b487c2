"""Profiles for hypothesis: the standing run looks at the same examples each time, random and thorough at new ones."""

import os

from hypothesis import HealthCheck, settings

_slow = [HealthCheck.too_slow, HealthCheck.data_too_large]  # no test depends on the machine's speed
settings.register_profile("random", deadline=None, suppress_health_check=_slow)
settings.register_profile("thorough", parent=settings.get_profile("random"), max_examples=5000)
settings.register_profile("standing", parent=settings.get_profile("random"), derandomize=True)
settings.register_profile("brief", parent=settings.get_profile("standing"), max_examples=20)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "standing"))
