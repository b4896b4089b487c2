#!/usr/bin/env python3
"""Runs the test cases of a module in this folder as a node; the .test file gives its path as the first argument."""

import importlib
import sys
import unittest
from pathlib import Path

import rospy
import rostest

HERE = Path(__file__).resolve().parent
PATH = HERE / rospy.myargv()[1]
sys.path[:0] = map(str, (PATH.parent, HERE, HERE.parent / "unit", HERE.parents[1] / "bench"))

from interface_helpers import init_node  # noqa: E402 - it is in one of these folders

MODULE = importlib.import_module(PATH.stem)


def suite():
    """Return the module's cases in the order of their definition."""
    classes = [one for one in vars(MODULE).values() if getattr(one, "__module__", "") == MODULE.__name__]
    cases = [one for one in classes if isinstance(one, type) and issubclass(one, unittest.TestCase)]
    return unittest.TestSuite(map(unittest.defaultTestLoader.loadTestsFromTestCase, cases))


if __name__ == "__main__":
    if not hasattr(MODULE, "INITS_NODE"):  # it does so itself, later
        init_node("test")
    rostest.rosrun("rosoclingo", PATH.stem, "__main__.suite", sys.argv)
