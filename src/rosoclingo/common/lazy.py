"""Names of a package that are loaded when they are asked for.

numba takes a second, and not everybody who wants a pose drives robots.
"""

import importlib
from typing import Any, Callable, Mapping


def loader(package: str, homes: Mapping[str, str]) -> Callable[[str], Any]:
    """Return a ``__getattr__`` for ``package``: it finds each name in the module that ``homes`` says.

    It raises AttributeError for every other name.
    """

    def load(name: str) -> Any:
        """Return what a name stands for, from its module."""
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return getattr(importlib.import_module(f"{package}.{homes[name]}"), name)

    return load
