"""Reading mappings from a world file, with errors that name file and key."""

import math
import sys
from typing import Any, Dict, List, Sequence, Tuple

__all__ = ["MISSING", "WorldError", "WorldReader"]

MISSING = object()
LARGEST = sys.float_info.max


class WorldError(ValueError):
    """A world that cannot be, or a change that it does not allow; the message names the place."""


class WorldReader:
    """Reads the keys of one mapping, remembers which, and complains of wrong and unknown ones by their full name."""

    def __init__(self, data: Any, place: str, file: str) -> None:
        self.place, self.file = place, file
        self._seen: List[str] = []
        if not isinstance(data, dict):
            raise self.error("", "must hold keys and values")
        self.data: Dict[str, Any] = data

    def error(self, key: str, text: str) -> WorldError:
        """Return an error that names the file and the key."""
        name = ".".join(part for part in (self.place, key) if part)
        return WorldError("{}: {}{}".format(self.file, name + ": " if name else "", text))

    def get(self, key: str, default: Any = MISSING) -> Any:
        """Return a value, whatever it is."""
        self._seen.append(key)
        value = self.data.get(key, default)
        if value is MISSING:
            raise self.error(key, "is missing")
        return value

    def number(
        self, key: str, default: Any = MISSING, low: float = -math.inf, high: float = math.inf, whole: bool = False
    ) -> Any:
        """Return a finite number from ``low`` to ``high``; ``whole``: an integer."""
        value = _plain(self.get(key, default))
        kind = int if whole else (int, float)
        if isinstance(value, bool) or not isinstance(value, kind) or not -LARGEST <= value <= LARGEST:
            raise self.error(key, "must be a {} number, is {!r}".format("whole" if whole else "finite", value))
        if value < low:
            raise self.error(key, f"must be {low} or more, is {value}")
        if value > high:
            raise self.error(key, f"must be {high} or less, is {value}")
        return value

    def text(self, key: str, default: Any = MISSING) -> str:
        """Return a text that is not empty."""
        value = self.get(key, default)
        if not isinstance(value, str) or not value:
            raise self.error(key, f"must be a text, is {value!r}")
        return value

    def flag(self, key: str, default: bool) -> bool:
        """Return true or false."""
        value = self.get(key, default)
        if not isinstance(value, bool):
            raise self.error(key, f"must be true or false, is {value!r}")
        return value

    def numbers(self, key: str, sizes: Sequence[int], default: Any = MISSING) -> Tuple[float, ...]:
        """Return finite numbers, as many as one of ``sizes``."""
        return self.floats(key, self.get(key, default), sizes)

    def floats(self, key: str, value: Any, sizes: Sequence[int]) -> Tuple[float, ...]:
        """Return a value as finite numbers, as many as one of ``sizes``."""
        numbers = [_plain(v) for v in value] if isinstance(value, (list, tuple)) else []
        good = len(numbers) in sizes and all(isinstance(v, (int, float)) and not isinstance(v, bool) for v in numbers)
        if not good:
            raise self.error(key, "must be {} numbers, is {!r}".format(" or ".join(map(str, sizes)), value))
        if not all(-LARGEST <= v <= LARGEST for v in numbers):
            raise self.error(key, f"must be finite, is {value!r}")
        return tuple(float(v) for v in numbers)

    def each(self, key: str) -> List["WorldReader"]:
        """Return readers of the mappings in a list."""
        value = self.get(key, None) or []
        if not isinstance(value, list):
            raise self.error(key, "must be a list")
        place = f"{self.place}.{key}" if self.place else key
        return [WorldReader(item, f"{place}[{i}]", self.file) for i, item in enumerate(value)]

    def finish(self) -> None:
        """Complain of keys that nobody has asked for."""
        unknown = sorted(str(key) for key in set(self.data) - set(self._seen))
        if unknown:
            raise self.error(unknown[0], "is no key known here (known: {})".format(", ".join(sorted(self._seen))))


def _plain(value: Any) -> Any:
    """Return a number that YAML takes for a text, such as 1e-3, as a number; all else as it is."""
    try:
        return float(value) if isinstance(value, str) else value
    except ValueError:
        return value
