"""Profiles for hypothesis, markers for slow and sampled tests, the first test of each file, messages, and a browser.

The standing run uses the same random examples each time, the other profiles use new ones.
"""

import gc
import os
from collections import defaultdict
from pkgutil import extend_path

import browser
import pytest
from hypothesis import HealthCheck, settings
from workloads import sized

_slow = [HealthCheck.too_slow, HealthCheck.data_too_large]  # no test depends on the machine's speed
settings.register_profile("random", deadline=None, suppress_health_check=_slow)
settings.register_profile("thorough", parent=settings.get_profile("random"), max_examples=5000)
settings.register_profile("standing", parent=settings.get_profile("random"), derandomize=True, max_examples=15)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "standing"))

#: Folders of tests of programs for clingo, and of manual tools: they are independent of the Python version.
ABOUT_NO_PYTHON = ("encodings", "bench")


def pytest_addoption(parser):
    """Add the option for a second Python."""
    text = "of each file the first test that is neither slow nor once"
    parser.addoption("--first-of-files", action="store_true", help=text)


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config, items):
    """Mark mostly_slow tests as slow, except their first case; leave out cases if sampled, or by an option."""
    config.hook.pytest_deselected(items=(left_out := beyond_samples(items)))
    items[:] = [item for item in items if item not in left_out]
    begun = set()
    for item in items:
        if item.get_closest_marker("mostly_slow") and name_of(item) in begun:
            item.add_marker("slow")
        begun.add(name_of(item))
    if config.getoption("--first-of-files"):
        first = {}
        for item in items:
            left_out = item.get_closest_marker("slow") or item.get_closest_marker("once")
            if not left_out and item.path.parent.name not in ABOUT_NO_PYTHON:
                first.setdefault(item.path, item)
        config.hook.pytest_deselected(items=[one for one in items if first.get(one.path) is not one])
        items[:] = first.values()


def pytest_collection_finish():
    """Collect garbage less often, and never visit what the collected modules hold."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(50_000, 20, 20)


def beyond_samples(items):
    """Return the cases of sampled tests that the standing run leaves out: all but some, evenly spread."""
    cases, left_out = defaultdict(list), set()
    for item in items:
        if item.get_closest_marker("sampled"):
            cases[name_of(item)].append(item)
    for group in cases.values():
        number = sized(group[0].get_closest_marker("sampled").args[0], len(group))
        left_out |= {*group} - {group[one * len(group) // number] for one in range(number)}
    return left_out


def name_of(item):
    """Return the name of a test without its case."""
    return item.nodeid.partition("[")[0]


@pytest.fixture(scope="session", autouse=True)
def reorder_effort():
    """Try fewer orders of a plan's tasks in the standing run, which would otherwise spend much of its time there."""
    from rosoclingo.planning.strategies import reorder

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(reorder, "EFFORT", sized(4_000, reorder.EFFORT))
        yield


@pytest.fixture
def messages(monkeypatch):
    """The package's messages, where unit tests import the package from its sources, without messages."""
    import rosoclingo

    pytest.importorskip("rosbag")
    monkeypatch.setattr(rosoclingo, "__path__", extend_path(list(rosoclingo.__path__), rosoclingo.__name__))
    return pytest.importorskip("rosoclingo.msg", reason="there is no built workspace")


@pytest.fixture(scope="module")
def page():
    """A page of a browser, as large as a desktop's."""
    path = browser.found()
    if path is None:
        pytest.skip("there is no browser: install chromium")
    with browser.Browser(path) as one:
        one.size(1280, 900)
        yield one
