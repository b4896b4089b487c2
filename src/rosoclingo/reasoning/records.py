"""The persisted state: attributes and tables of the core's parts, as rows of JSON values.

A row has the name ``GROUP:KEY``. Its group is a part of the core, or a table of a part.
"""

import math
from enum import Enum
from functools import lru_cache
from typing import (
    Any,
    Callable,
    ClassVar,
    Dict,
    Iterable,
    Iterator,
    List,
    Mapping,
    MutableMapping,
    NamedTuple,
    Optional,
    Tuple,
    TypeVar,
    Union,
    get_args,
    get_origin,
    get_type_hints,
)

from clingo import Symbol

from rosoclingo.planning.explaining.questions import Stream, stream_from_message, stream_to_message
from rosoclingo.planning.history import Entry, entry_from_message, entry_to_message
from rosoclingo.planning.text import symbol_list, symbols_to_text
from rosoclingo.reasoning.keywords import Action, Return, action_of, return_of

K = TypeVar("K")
V = TypeVar("V")

#: Rows by name, in order.
Record = Dict[str, Any]

#: Maximum number of cached texts, and maximum length of a cached text.
CACHED, SHORT = 4096, 200

_texts: Dict[Symbol, str] = {}


def text_of(symbol: Symbol) -> str:
    """Return a symbol as text for :func:`symbol_of`; short texts are cached."""
    text = _texts.get(symbol)
    if text is None:
        text = symbols_to_text([symbol])
        if len(text) <= SHORT:
            if len(_texts) >= CACHED:
                _texts.clear()
            _texts[symbol] = text
    return text


def symbol_of(text: str) -> Symbol:
    """Return the symbol of :func:`text_of`; those of short texts are cached."""
    return _parse(text) if len(text) <= SHORT else symbol_list(text)[0]


@lru_cache(maxsize=CACHED)
def _parse(text: str) -> Symbol:
    return symbol_list(text)[0]


class Codec(NamedTuple):
    """A conversion of values to JSON values, and back."""

    encode: Callable[[Any], Any]
    decode: Callable[[Any], Any]


def _same(value: Any) -> Any:
    return value


_CODECS: Dict[Any, Codec] = {
    **dict.fromkeys((bool, int, str, dict, type(None)), Codec(_same, _same)),
    float: Codec(lambda value: value if math.isfinite(value) else str(value), float),
    Symbol: Codec(text_of, symbol_of),
    Action: Codec(lambda action: text_of(action.atom), lambda text: action_of(symbol_of(text))),
    Return: Codec(lambda answer: text_of(answer.atom), lambda text: return_of(symbol_of(text))),
    Entry: Codec(entry_to_message, entry_from_message),
    Stream: Codec(stream_to_message, stream_from_message),
}


@lru_cache(maxsize=None)
def codec(hint: Any) -> Codec:
    """Return the codec of a type, or ``hint`` itself if it is a codec.

    The types are those of JSON, symbols, actions, returns, entries, streams, enumerations, named tuples and data
    classes of such types, optional values, and lists, tuples and sets of values of one type.
    """
    if isinstance(hint, Codec) or hint in _CODECS:
        return hint if isinstance(hint, Codec) else _CODECS[hint]
    items = [codec(one) for one in get_args(hint) if one not in (..., type(None))]
    kind = get_origin(hint)
    if kind is Union:
        encode, decode = items[0]
        return Codec(lambda one: None if one is None else encode(one), lambda one: None if one is None else decode(one))
    if kind is not None:
        encode, decode = items[0]
        order = sorted if kind in (set, frozenset) else iter  # type: Callable[[Any], Iterable[Any]]
        return Codec(lambda values: [encode(one) for one in order(values)], lambda values: kind(map(decode, values)))
    if issubclass(hint, Enum):
        return Codec(lambda value: value.value, hint)
    parts = fields(**get_type_hints(hint))
    return Codec(lambda one: encode_fields(one, parts), lambda row: hint(**decode_fields(row, parts)))


def fields(**hints: Any) -> Mapping[str, Codec]:
    """Return the codecs of attributes by their names, for these types."""
    return {name: codec(hint) for name, hint in hints.items()}


def encode_fields(one: object, parts: Mapping[str, Codec]) -> Record:
    """Return the attributes of an object as JSON values."""
    return {name: part.encode(getattr(one, name)) for name, part in parts.items()}


def decode_fields(record: Record, parts: Mapping[str, Codec]) -> Dict[str, Any]:
    """Return the attributes of :func:`encode_fields`."""
    return {name: part.decode(record[name]) for name, part in parts.items()}


def group(record: Record, name: str) -> Record:
    """Return the rows ``name:KEY`` by their keys, in order."""
    start = name + ":"
    return {key[len(start) :]: value for key, value in record.items() if key.startswith(start)}


class PersistentTable(MutableMapping[K, V]):
    """A dictionary whose items are persisted as rows of a group, in order.

    Call :meth:`changes` for the rows that have changed. Values are replaced, or changed in place if the table is
    ``mutable``; such a table compares all its values. ``popitem`` removes the first item.
    """

    def __init__(self, name: str, key: Any, value: Any, mutable: bool = False) -> None:
        """Name the group ``name``; ``key`` and ``value`` are types or codecs, and keys become texts."""
        self._group, self._key, self._value = name, codec(key), codec(value)
        self._items: Dict[K, V] = {}
        self._new: Dict[K, bool] = {}  # items set since the last changes, each with whether it replaces a row
        self._gone: Dict[K, None] = {}
        self._last: Optional[Dict[K, Any]] = {} if mutable else None

    def __getitem__(self, key: K) -> V:
        return self._items[key]

    def __setitem__(self, key: K, value: V) -> None:
        self._new.setdefault(key, key in self._items)
        self._items[key] = value

    def __delitem__(self, key: K) -> None:
        del self._items[key]
        if self._new.pop(key, True):
            self._gone[key] = None

    def __iter__(self) -> Iterator[K]:
        return iter(self._items)

    def __len__(self) -> int:
        return len(self._items)

    def match(self, items: Mapping[K, V]) -> None:
        """Remove the items whose keys ``items`` lacks, and add its further items as the last ones."""
        for key in [one for one in self._items if one not in items]:
            del self[key]
        self.update({key: value for key, value in items.items() if key not in self._items})

    def changes(self) -> Tuple[List[str], Record]:
        """Return the names of removed rows, and the new and changed rows, since the last call."""
        gone, new, self._gone, self._new = self._gone, self._new, {}, {}
        if self._last is not None:
            last, self._last = self._last, {key: self._value.encode(value) for key, value in self._items.items()}
            new = {key: True for key, value in self._last.items() if key in new or value != last.get(key)}
        return [*map(self._name, gone)], {self._name(key): self._value.encode(self._items[key]) for key in new}

    def record(self) -> Record:
        """Return all rows."""
        return {self._name(key): self._value.encode(value) for key, value in self._items.items()}

    def restore(self, record: Record) -> None:
        """Restore the items from their rows."""
        rows = group(record, self._group)
        self._items = {self._key.decode(key): self._value.decode(value) for key, value in rows.items()}

    def _name(self, key: K) -> str:
        return f"{self._group}:{self._key.encode(key)}"


class PersistentPart:
    """A part of the core whose state is persisted: the attributes in ``FIELDS``, and its tables.

    Each attribute is a row of the group ``GROUP``.
    """

    GROUP: ClassVar[str]
    FIELDS: ClassVar[Mapping[str, Codec]] = {}

    @property
    def tables(self) -> List[PersistentTable[Any, Any]]:
        """The tables of this part."""
        return [one for one in vars(self).values() if isinstance(one, PersistentTable)]

    def row_of(self, name: str) -> str:
        """Return the name of an attribute's row."""
        return f"{self.GROUP}:{name.lstrip('_')}"

    def record(self) -> Record:
        """Return all rows."""
        rows = {self.row_of(name): value for name, value in encode_fields(self, self.FIELDS).items()}
        return dict(rows, **{name: row for one in self.tables for name, row in one.record().items()})

    def restore(self, record: Record) -> None:
        """Restore the state from all rows."""
        for name, part in self.FIELDS.items():
            setattr(self, name, part.decode(record[self.row_of(name)]))
        for one in self.tables:
            one.restore(record)


def record_of(parts: Iterable[PersistentPart]) -> Record:
    """Return the rows of all parts."""
    return {name: row for part in parts for name, row in part.record().items()}


class ChangeRecorder:
    """Records the changes of parts since the last record. Tuples and frozen sets count as immutable."""

    def __init__(self) -> None:
        self._attributes: Dict[str, Tuple[Any, Any]] = {}  # by row: the value and its JSON value

    def changes(self, parts: Iterable[PersistentPart]) -> Record:
        """Return the names of rows to ``drop``, and then the rows to ``set``; empty if nothing has changed."""
        gone: List[str] = []
        new: Record = {}
        for part in parts:
            for name, field in part.FIELDS.items():
                new.update(self._changed(part.row_of(name), getattr(part, name), field))
            for table in part.tables:
                removed, rows = table.changes()
                gone += removed
                new.update(rows)
        return {**({"drop": gone} if gone else {}), **({"set": new} if new else {})}

    def _changed(self, row: str, value: Any, field: Codec) -> Record:
        """Return the row of an attribute if its ``value`` has changed."""
        known, old = self._attributes.get(row, (None, self))
        if value is known and isinstance(value, (tuple, frozenset)):
            return {}
        new = field.encode(value)
        self._attributes[row] = value, new
        return {} if new == old else {row: new}
