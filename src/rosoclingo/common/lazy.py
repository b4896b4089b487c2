"""Lazy imports of the names of a package.

Importing numba takes a second, and only some users of a package need it.
"""

import importlib
from typing import Any, Callable, Mapping


def loader(package: str, homes: Mapping[str, str]) -> Callable[[str], Any]:
    """Return a ``__getattr__`` for ``package``, which imports each name from its module in ``homes``.

    It raises AttributeError for any other name.
    """

    def load(name: str) -> Any:
        """Import a name from its module."""
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return getattr(importlib.import_module(f"{package}.{homes[name]}"), name)

    return load
