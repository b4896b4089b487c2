"""Profiles for hypothesis, which tests are slow, and a browser.

The standing run looks at the same random examples each time, others at new ones.
"""

import os
from collections import defaultdict

import browser
import pytest
from hypothesis import HealthCheck, settings

_slow = [HealthCheck.too_slow, HealthCheck.data_too_large]  # no test depends on the machine's speed
settings.register_profile("random", deadline=None, suppress_health_check=_slow)
settings.register_profile("thorough", parent=settings.get_profile("random"), max_examples=5000)
settings.register_profile("standing", parent=settings.get_profile("random"), derandomize=True, max_examples=30)
settings.register_profile("brief", parent=settings.get_profile("standing"), max_examples=15)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "standing"))

#: Folders of tests of what clingo runs, and of what is run by hand: their slow tests say nothing of a Python.
ABOUT_NO_PYTHON = ("encodings", "bench")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """Mark as slow what is mostly_slow, but its first case; with again the first of a file in which all are slow.

    Of the latter there is none in the folders that are about no Python.
    """
    begun, files = set(), defaultdict(list)
    for item in items:
        if item.get_closest_marker("mostly_slow"):
            name = item.nodeid.partition("[")[0]
            if name in begun:
                item.add_marker("slow")
            begun.add(name)
        files[item.path].append(item)
    for path, ours in files.items():
        if path.parent.name in ABOUT_NO_PYTHON:
            continue
        again = [one for one in ours if not one.get_closest_marker("once")]
        if all(one.get_closest_marker("slow") for one in again):
            for one in again[:1]:
                one.add_marker("again")


@pytest.fixture(scope="module")
def page():
    """A page of a browser, as large as a desktop's."""
    path = browser.found()
    if path is None:
        pytest.skip("there is no browser: install chromium")
    with browser.Browser(path) as one:
        one.size(1280, 900)
        yield one
