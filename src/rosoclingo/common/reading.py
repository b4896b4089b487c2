"""YAML and parameters: values read at their places, with all faults at once, each with its place and its mend."""

import re
import sys
from difflib import get_close_matches
from functools import partial
from pathlib import Path
from reprlib import Repr
from typing import Any, Callable, Iterable, List, Mapping, Optional, Sequence, Tuple, Type, TypeVar, Union

import yaml

__all__ = ["MISSING", "Reader", "likely", "read_yaml"]

MISSING: Any = object()  # what is not there, or as a default: what has to be there

T = TypeVar("T")

INF = float("inf")
_LARGEST = sys.float_info.max
_LONGEST = 200  # characters of a value that a message repeats
# Numbers to ROS's C++ programs and to YAML 1.2, texts to PyYAML: an exponent without point or sign.
_EXPONENTIAL = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)[eE][-+]?\d+\Z")


class Reader:
    """One value at its place, with what is inside of it.

    What reads a value gives one that can be worked with, also where it notes a fault: then the default, or an empty one
    of that type. So all faults are found before ``check`` raises them. A value without a default has to be there.

    ``source``, such as the file's name, begins each message; ``where`` says where to give what is missing, ``joint``
    stands between the keys of a place.
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
        """The place with its source, as messages begin with it."""
        return self.source + self.place

    @property
    def given(self) -> bool:
        """Whether there is a value; an empty one of YAML counts as left out."""
        return self.value is not MISSING and self.value is not None

    # ---- faults ---------------------------------------------------------------------------------------------------

    def fault(self, text: str) -> None:
        """Note a fault of this value."""
        self.faults.append(f"{self.named}{': ' if self.place else ''}{text}")

    def check(self, error: Type[Exception]) -> None:
        """Raise an error with all faults that were noted so far, a line each, if there are any."""
        if self.faults:
            raise error("\n".join(self.faults))

    # ---- what is inside -------------------------------------------------------------------------------------------

    def at(self, key: str) -> "Reader":
        """The value of a key of this mapping."""
        if key not in self._known:
            self._known.append(key)
        inside = self.value.get(key, MISSING) if isinstance(self.value, Mapping) else MISSING
        # Of what is no mapping no key is missing: it is a fault as a whole.
        faults = self.faults if isinstance(self.value, Mapping) or not self.given else []
        return Reader(inside, self._of(key), self.source, self._where, self._joint, faults)

    def close(self, wanted: str = "", also: Iterable[str] = ()) -> None:
        """Note which keys there are besides those asked for and ``also``, or that this is no mapping at all."""
        self._known += also
        known = ", ".join(self._known)
        if isinstance(self.value, Mapping):
            for key in self.value:
                if key not in self._known:
                    self.fault(f"unknown key {key!r}{likely(str(key), self._known)}; keys are {known}")
        elif self.given:
            self.fault(f"must be {wanted or f'a mapping with the keys {known}'}, not {_shown(self.value)}")

    def items(self, wanted: str = "a list", default: Any = ()) -> List["Reader"]:
        """The values in this list."""
        found = self.read(wanted, lambda value: _as(value, list, tuple), default, ())
        return [self._inside(value, f"{self.place}[{index}]") for index, value in enumerate(found)]

    def entries(self, wanted: str = "a mapping", default: Any = MISSING) -> List[Tuple[str, "Reader"]]:
        """The names in this mapping, as text, and their values."""
        found = self.mapping(wanted, default)
        return [(str(key), self._inside(value, self._of(str(key)))) for key, value in found.items()]

    # ---- what it is -----------------------------------------------------------------------------------------------

    def read(self, wanted: str, fit: Callable[[Any], Optional[T]], default: Any = MISSING, empty: Any = None) -> T:
        """The value as ``fit`` gives it, which returns None for what is not as ``wanted`` says.

        Left out, it is the default; that or ``empty`` stands for what cannot be used.
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
        """The value as a finite number from ``low`` to ``high``, more than ``above``."""
        fit = partial(_number, low=low, high=high, above=above)
        return self.read(wanted or _range("number", low, high, above), fit, default, 0.0)

    def whole(self, default: Any = MISSING, low: float = -INF, high: float = INF) -> int:
        """The value as a whole number from ``low`` to ``high``."""
        fit = partial(_number, low=low, high=high, kind=int)
        return self.read(_range("whole number", low, high), fit, default, 0)

    def numbers(self, sizes: Sequence[int], default: Any = MISSING, wanted: str = "") -> Tuple[float, ...]:
        """The value as finite numbers, as many as one of ``sizes``."""
        words = wanted or "{} finite numbers".format(" or ".join(map(str, sizes)))
        return self.read(words, partial(_all, fit=_number, sizes=sizes), default, (0.0,) * sizes[0])

    def text(self, default: Any = MISSING, empty: bool = False, wanted: str = "a text") -> str:
        """The value as a text, which may be empty where ``empty`` says so or the default is."""
        return self.read(wanted, partial(_text, empty=empty or default == ""), default, "")

    def texts(self, default: Any = MISSING, wanted: str = "a list of texts", some: bool = False) -> Tuple[str, ...]:
        """The value as texts, none of them empty; at least one of them with ``some``."""
        return self.read(wanted, partial(_all, fit=_text, sizes=range(int(some), sys.maxsize)), default, ())

    def flag(self, default: Any = MISSING) -> bool:
        """The value as true or false."""
        return self.read("true or false", lambda value: _as(value, bool), default, False)

    def choice(self, choices: Iterable[str], default: Any = MISSING) -> str:
        """The value as one of some words."""
        words = list(choices)
        wanted = "one of {}".format(", ".join(words))
        return self.read(wanted, lambda value: value if value in words else None, default, words[0])

    def like(self, default: Any, least: float = -INF) -> Any:
        """The value as one of the default's kind: true or false, a whole number from ``least``, a number from 0 on."""
        if isinstance(default, bool):
            return self.flag(default)
        return self.whole(default, least) if isinstance(default, int) else self.number(default, low=0.0)

    def mapping(self, wanted: str = "a mapping", default: Any = MISSING) -> Mapping[Any, Any]:
        """The value as a mapping; its values are not looked at."""
        return self.read(wanted, lambda value: _as(value, Mapping), default, {})

    def _of(self, key: str) -> str:
        return self.place + ("" if self.place in ("", "~") else self._joint) + key

    def _inside(self, value: Any, place: str) -> "Reader":
        return Reader(value, place, self.source, self._where, self._joint, self.faults)


def read_yaml(path: Union[str, Path], what: str, error: Type[Exception]) -> Reader:
    """What a YAML file holds; raises the error, which names ``what`` it is and the file, where it cannot be read."""
    try:
        data = yaml.safe_load(Path(path).read_text(encoding="utf-8"))
    except (OSError, ValueError, yaml.YAMLError) as cause:
        raise error(f"{what} {path}: cannot be read: {cause}") from cause
    return Reader(data, source=f"{what} {path}: ")


def likely(name: str, known: Iterable[str], before: str = "") -> str:
    """Which of the ``known`` names a misspelt one probably stands for, in words; empty where none is near."""
    close = get_close_matches(name, list(known), 1)
    return f" (is {before}{close[0]} meant?)" if close else ""


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
    if low > -INF:
        return f"a {kind} from {low:g} {'on' if high == INF else f'to {high:g}'}"
    if above > -INF:
        return f"a {kind} above {above:g}"
    return f"a {kind}" if kind != "number" else "a finite number"


def _shown(value: Any) -> str:
    """Return the value as text or how that begins, without writing all of it: by its aliases a YAML may be endless."""
    short = Repr()
    short.maxlist = short.maxtuple = short.maxdict = 12
    short.maxstring = short.maxlong = short.maxother = 3 * _LONGEST
    short.maxlevel = 3
    text = short.repr(value)
    return text if len(text) <= _LONGEST else text[:_LONGEST] + " ..."
