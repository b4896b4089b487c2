"""Profiles for hypothesis, and a browser: the standing run looks at the same examples each time, others at new ones."""

import os

import browser
import pytest
from hypothesis import HealthCheck, settings

_slow = [HealthCheck.too_slow, HealthCheck.data_too_large]  # no test depends on the machine's speed
settings.register_profile("random", deadline=None, suppress_health_check=_slow)
settings.register_profile("thorough", parent=settings.get_profile("random"), max_examples=5000)
settings.register_profile("standing", parent=settings.get_profile("random"), derandomize=True, max_examples=60)
settings.register_profile("brief", parent=settings.get_profile("standing"), max_examples=20)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "standing"))


@pytest.fixture(scope="module")
def page():
    """A page of a browser, as large as a desktop's."""
    path = browser.found()
    if path is None:
        pytest.skip("there is no browser: install chromium")
    with browser.Browser(path) as one:
        one.size(1280, 900)
        yield one
