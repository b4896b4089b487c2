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
    NamedTuple,
    Tuple,
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

#: Rows by name, in order.
Record = Dict[str, Any]


def text_of(symbol: Symbol) -> str:
    """Return a symbol as text for :func:`symbol_of`."""
    return symbols_to_text([symbol])


def symbol_of(text: str) -> Symbol:
    """Return the symbol of :func:`text_of`."""
    return symbol_list(text)[0]


class Codec(NamedTuple):
    """A conversion of values to JSON values, and back; ``mutable``: values can change in place."""

    encode: Callable[[Any], Any]
    decode: Callable[[Any], Any]
    mutable: bool = False


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
        encode, decode, mutable = items[0]
        some = Codec(lambda one: None if one is None else encode(one), lambda one: None if one is None else decode(one))
        return some._replace(mutable=mutable)
    if kind is not None:
        encode, decode, _ = items[0]
        order = sorted if kind in (set, frozenset) else iter  # type: Callable[[Any], Iterable[Any]]
        mutable = kind in (list, set) or any(one.mutable for one in items)
        every = Codec(lambda values: [encode(one) for one in order(values)], lambda values: kind(map(decode, values)))
        return every._replace(mutable=mutable)
    if issubclass(hint, Enum):
        return Codec(lambda value: value.value, hint)
    parts = fields(**get_type_hints(hint))
    frozen = issubclass(hint, tuple) or hint.__dataclass_params__.frozen
    mutable = not frozen or any(one.mutable for one in parts.values())
    return Codec(
        lambda one: {name: part.encode(getattr(one, name)) for name, part in parts.items()},
        lambda row: hint(**{name: part.decode(row[name]) for name, part in parts.items()}),
        mutable,
    )


def fields(**hints: Any) -> Mapping[str, Codec]:
    """Return the codecs of attributes by their names, for these types."""
    return {name: codec(hint) for name, hint in hints.items()}


def group(record: Record, name: str) -> Record:
    """Return the rows ``name:KEY`` by their keys, in order."""
    start = name + ":"
    return {key[len(start) :]: value for key, value in record.items() if key.startswith(start)}


class DictCodec(NamedTuple):
    """The conversion of a dictionary to rows of a group, one for each item, in order."""

    group: str
    key: Codec
    value: Codec


def tables(**hints: Tuple[str, Any, Any]) -> Mapping[str, DictCodec]:
    """Return the tables of dictionaries by their names: each has a group, and the types of its keys and values."""
    return {name: DictCodec(group_name, codec(key), codec(value)) for name, (group_name, key, value) in hints.items()}


class Group(NamedTuple):
    """The values of a group: ``row`` returns the name of the row of a key, ``field`` the codec of its value."""

    name: str
    values: Mapping[Any, Any]
    row: Callable[[Any], str]
    field: Callable[[Any], Codec]


class PersistentPart:
    """A part of the core whose state is persisted: the attributes in ``FIELDS``, and the dictionaries in ``TABLES``.

    Each attribute is a row of the group ``GROUP``, each item of a dictionary a row of the group of its table.
    """

    GROUP: ClassVar[str]
    FIELDS: ClassVar[Mapping[str, Codec]] = {}
    TABLES: ClassVar[Mapping[str, DictCodec]] = {}

    def groups(self) -> Iterator[Group]:
        """Yield the groups of this part."""
        attributes = {name: getattr(self, name) for name in self.FIELDS}
        yield Group(self.GROUP, attributes, self._row_of, self.FIELDS.__getitem__)
        for name, one in self.TABLES.items():
            yield _group_of(one, getattr(self, name))

    def _row_of(self, name: str) -> str:
        """Return the name of an attribute's row."""
        return f"{self.GROUP}:{name.lstrip('_')}"

    def record(self) -> Record:
        """Return all rows."""
        return {
            one.row(key): one.field(key).encode(value) for one in self.groups() for key, value in one.values.items()
        }

    def restore(self, record: Record) -> None:
        """Restore the state from all rows."""
        for name, field in self.FIELDS.items():
            setattr(self, name, field.decode(record[self._row_of(name)]))
        for name, one in self.TABLES.items():
            rows = group(record, one.group)
            setattr(self, name, {one.key.decode(key): one.value.decode(value) for key, value in rows.items()})


def _group_of(one: DictCodec, values: Mapping[Any, Any]) -> Group:
    return Group(one.group, values, lambda key: f"{one.group}:{one.key.encode(key)}", lambda _key: one.value)


def record_of(parts: Iterable[PersistentPart]) -> Record:
    """Return the rows of all parts."""
    return {name: row for part in parts for name, row in part.record().items()}


class ChangeRecorder:
    """Records the changes of parts since the last record, by a comparison with the values at that time."""

    def __init__(self) -> None:
        self._last: Dict[str, Dict[Any, Tuple[Any, Any]]] = {}  # by group and key: the value and its JSON value

    def changes(self, parts: Iterable[PersistentPart]) -> Record:
        """Return the names of rows to ``drop``, and then the rows to ``set``; empty if nothing has changed."""
        gone: List[str] = []
        new: Record = {}
        for one in (one for part in parts for one in part.groups()):
            before = self._last.get(one.name, {})
            now = self._last[one.name] = _encoded(one, before)
            order = iter(before)
            for key, (_, row) in now.items():
                stays = key in order  # else it is new, or has moved to the end
                if not stays or row != before[key][1]:
                    new[one.row(key)] = row
                gone += [one.row(key)] if key in before and not stays else []
            gone += [one.row(key) for key in before if key not in now]
        return {**({"drop": gone} if gone else {}), **({"set": new} if new else {})}


def _encoded(one: Group, before: Mapping[Any, Tuple[Any, Any]]) -> Dict[Any, Tuple[Any, Any]]:
    """Return the values of a group with their JSON values, those of ``before`` if they are the same."""
    found: Dict[Any, Tuple[Any, Any]] = {}
    for key, value in one.values.items():
        field, known = one.field(key), before.get(key)
        is_same = known is not None and value is known[0] and not field.mutable
        found[key] = known if known is not None and is_same else (value, field.encode(value))
    return found
