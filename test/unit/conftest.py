"""Profiles for hypothesis: thorough looks longer, brief at few examples; CI=true looks at the same ones each time."""

import os

from hypothesis import HealthCheck, settings

_slow = [HealthCheck.too_slow, HealthCheck.data_too_large]  # no test depends on the machine's speed
settings.register_profile("default", deadline=None, suppress_health_check=_slow)
settings.register_profile("ci", parent=settings.get_profile("default"), derandomize=True)
settings.register_profile("brief", parent=settings.get_profile("ci"), max_examples=20)
settings.register_profile("thorough", parent=settings.get_profile("default"), max_examples=5000)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "ci" if os.environ.get("CI") else "default"))
