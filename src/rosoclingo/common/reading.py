"""Validation of YAML files and parameters: reports all faults at once, each with its place and how to fix it."""

import re
import sys
from difflib import get_close_matches
from functools import partial
from pathlib import Path
from reprlib import Repr
from typing import Any, Callable, Iterable, List, Mapping, Optional, Sequence, Tuple, Type, TypeVar, Union

import yaml

MISSING: Any = object()  # as a value: not given; as a default: required

T = TypeVar("T")

INF = float("inf")
_LARGEST = sys.float_info.max
_LONGEST = 200  # characters of a value that a message repeats
# Exponents without point or sign: numbers to ROS's C++ programs and to YAML 1.2, texts to PyYAML.
_EXPONENTIAL = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)[eE][-+]?\d+\Z")


class Reader:
    """A value with its place in a file, and the values inside.

    The methods that read a value always return a valid value: for a fault, which they collect, the default or an empty
    value of the type. So one pass finds all faults before ``check`` raises them. A value without a default is required.

    ``source``, such as the file's name, begins each message; ``where`` says where to add a missing value; ``joint``
    separates the keys of a place.
    """

    def __init__(
        self,
        value: Any,
        place: str = "",
        source: str = "",
        where: str = "",
        joint: str = ".",
        faults: Optional[List[str]] = None,
    ) -> None:
        self.value = value
        self.place = place
        self.faults: List[str] = [] if faults is None else faults
        self.source, self._where, self._joint = source, where, joint
        self._known: List[str] = []

    @property
    def named(self) -> str:
        """The source and the place, the beginning of each message."""
        return self.source + self.place

    @property
    def given(self) -> bool:
        """Whether there is a value; an empty value of YAML counts as missing."""
        return self.value is not MISSING and self.value is not None

    def holding(self, value: Any) -> "Reader":
        """Return a reader of another value in the same place."""
        return self._inside(value, self.place)

    # ---- faults ---------------------------------------------------------------------------------------------------

    def fault(self, text: str) -> None:
        """Add a fault of this value."""
        self.faults.append(f"{self.named}{': ' if self.place else ''}{text}")

    def check(self, error: Type[Exception]) -> None:
        """Raise ``error`` with all faults so far, a line each, if there are any."""
        if self.faults:
            raise error("\n".join(self.faults))

    # ---- values inside --------------------------------------------------------------------------------------------

    def at(self, key: str) -> "Reader":
        """Return the reader of a key of this mapping."""
        if key not in self._known:
            self._known.append(key)
        inside = self.value.get(key, MISSING) if isinstance(self.value, Mapping) else MISSING
        # A value that is not a mapping is a single fault; do not report its keys as missing too.
        faults = self.faults if isinstance(self.value, Mapping) or not self.given else []
        return Reader(inside, self._of(key), self.source, self._where, self._joint, faults)

    def close(self, wanted: str = "", also: Iterable[str] = ()) -> None:
        """Add faults for keys that were neither read nor are in ``also``, or if the value is not a mapping."""
        self._known += also
        known = ", ".join(self._known)
        if isinstance(self.value, Mapping):
            for key in self.value:
                if key not in self._known:
                    self.fault(f"unknown key {key!r}{likely(str(key), self._known)}; keys are {known}")
        elif self.given:
            self.fault(f"must be {wanted or f'a mapping with the keys {known}'}, not {_shown(self.value)}")

    def items(self, wanted: str = "a list", default: Any = ()) -> List["Reader"]:
        """Return the readers of the values in this list."""
        found = self.read(wanted, lambda value: _as(value, list, tuple), default, ())
        return [self._inside(value, f"{self.place}[{index}]") for index, value in enumerate(found)]

    def entries(self, wanted: str = "a mapping", default: Any = MISSING) -> List[Tuple[str, "Reader"]]:
        """Return the names in this mapping, as text, with the readers of their values."""
        found = self.mapping(wanted, default)
        return [(str(key), self._inside(value, self._of(str(key)))) for key, value in found.items()]

    # ---- the value by type ----------------------------------------------------------------------------------------

    def read(self, wanted: str, fit: Callable[[Any], Optional[T]], default: Any = MISSING, empty: Any = None) -> T:
        """Return the value converted by ``fit``, which returns None for a value that does not match ``wanted``.

        A missing value is the default; an invalid value is the default or ``empty``.
        """
        instead: Any = empty if default is MISSING else default
        if not self.given:
            if default is MISSING:
                self.fault(f"is missing: give {wanted}{self._where}")
            return instead  # type: ignore[no-any-return]
        found = fit(self.value)
        if found is None:
            self.fault(f"must be {wanted}, not {_shown(self.value)}")
        return instead if found is None else found

    def number(
        self, default: Any = MISSING, low: float = -INF, high: float = INF, above: float = -INF, wanted: str = ""
    ) -> float:
        """Return the value as a finite number from ``low`` to ``high``, greater than ``above``."""
        fit = partial(_number, low=low, high=high, above=above)
        return self.read(wanted or _range("number", low, high, above), fit, default, 0.0)

    def whole(self, default: Any = MISSING, low: float = -INF, high: float = INF) -> int:
        """Return the value as an integer from ``low`` to ``high``."""
        fit = partial(_number, low=low, high=high, kind=int)
        return self.read(_range("integer", low, high), fit, default, 0)

    def numbers(self, sizes: Sequence[int], default: Any = MISSING, wanted: str = "") -> Tuple[float, ...]:
        """Return the value as a tuple of finite numbers, whose length is in ``sizes``."""
        words = wanted or "{} finite numbers".format(" or ".join(map(str, sizes)))
        return self.read(words, partial(_all, fit=_number, sizes=sizes), default, (0.0,) * sizes[0])

    def text(self, default: Any = MISSING, empty: bool = False, wanted: str = "a text") -> str:
        """Return the value as a text; it can be empty with ``empty`` or an empty default."""
        return self.read(wanted, partial(_text, empty=empty or default == ""), default, "")

    def texts(self, default: Any = MISSING, wanted: str = "a list of texts", some: bool = False) -> Tuple[str, ...]:
        """Return the value as a tuple of non-empty texts; with ``some`` at least one."""
        return self.read(wanted, partial(_all, fit=_text, sizes=range(int(some), sys.maxsize)), default, ())

    def flag(self, default: Any = MISSING) -> bool:
        """Return the value as a Boolean."""
        return self.read("true or false", lambda value: _as(value, bool), default, False)

    def choice(self, choices: Iterable[str], default: Any = MISSING) -> str:
        """Return the value, which has to be in ``choices``."""
        words = list(choices)
        wanted = "one of {}".format(", ".join(words))
        return self.read(wanted, lambda value: value if value in words else None, default, words[0])

    def like(self, default: Any, least: float = -INF) -> Any:
        """Return the value in the default's type: a Boolean, an integer from ``least``, or a number from 0."""
        if isinstance(default, bool):
            return self.flag(default)
        return self.whole(default, least) if isinstance(default, int) else self.number(default, low=0.0)

    def mapping(self, wanted: str = "a mapping", default: Any = MISSING) -> Mapping[Any, Any]:
        """Return the value as a mapping; its values are not checked."""
        return self.read(wanted, lambda value: _as(value, Mapping), default, {})

    def _of(self, key: str) -> str:
        return self.place + ("" if self.place in ("", "~") else self._joint) + key

    def _inside(self, value: Any, place: str) -> "Reader":
        return Reader(value, place, self.source, self._where, self._joint, self.faults)


def read_yaml(path: Union[str, Path], what: str, error: Type[Exception]) -> Reader:
    """Read a YAML file; raises ``error``, which names ``what`` and the file, if the file cannot be read."""
    try:
        data = yaml.safe_load(Path(path).read_text(encoding="utf-8"))
    except (OSError, ValueError, yaml.YAMLError) as cause:
        raise error(f"{what} {path}: cannot be read: {cause}") from cause
    return Reader(data, source=f"{what} {path}: ")


def likely(name: str, known: Iterable[str], before: str = "") -> str:
    """Return a hint with the ``known`` name closest to a misspelt name; empty if none is close."""
    close = get_close_matches(name, list(known), 1)
    return f" (did you mean {before}{close[0]}?)" if close else ""


def _number(value: Any, low: float = -INF, high: float = INF, above: float = -INF, kind: type = float) -> Any:
    if isinstance(value, str) and _EXPONENTIAL.match(value):
        value = float(value)
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not -_LARGEST <= value <= _LARGEST:
        return None
    return kind(value) if low <= value <= high and value > above and kind(value) == value else None


def _text(value: Any, empty: bool = False) -> Optional[str]:
    return value if isinstance(value, str) and (value or empty) else None


def _all(value: Any, fit: Callable[[Any], Optional[T]], sizes: Sequence[int]) -> Optional[Tuple[T, ...]]:
    found = [fit(one) for one in value] if isinstance(value, (list, tuple)) and len(value) in sizes else [None]
    return None if None in found else tuple(one for one in found if one is not None)


def _as(value: Any, *kinds: type) -> Any:
    return value if isinstance(value, kinds) else None


def _range(kind: str, low: float, high: float, above: float = -INF) -> str:
    name = "an integer" if kind == "integer" else "a number"
    if low > -INF:
        return f"{name} of at least {low:g}" if high == INF else f"{name} from {low:g} to {high:g}"
    if above > -INF:
        return f"{name} above {above:g}"
    return name if kind == "integer" else "a finite number"


def _shown(value: Any) -> str:
    """Return the beginning of the value as text, without expanding all of it: YAML aliases can make it endless."""
    short = Repr()
    short.maxlist = short.maxtuple = short.maxdict = 12
    short.maxstring = short.maxlong = short.maxother = 3 * _LONGEST
    short.maxlevel = 3
    text = short.repr(value)
    return text if len(text) <= _LONGEST else text[:_LONGEST] + " ..."
