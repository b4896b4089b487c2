"""The former name of ``rosoclingo.robot.navigation``, for plugins that users have written: it has the same names."""

import importlib
from typing import Any


def __getattr__(name: str) -> Any:
    return getattr(importlib.import_module("rosoclingo.robot.navigation"), name)
