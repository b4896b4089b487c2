"""A journal's lines: a header, then records.

A record says which sections of the state are other than before, and when it was written; the first holds all of
them, so that the file has a beginning however long the core has run. Each line tells whether it is as it was written
(:mod:`rosoclingo.common.durable`). A last line without its end was not written to the end and is cut off; any other
line that is not as it was written makes the journal one that nobody should trust.
"""

import json
import math
from typing import Any, Dict, Iterable, Iterator, List, NamedTuple, Optional, Set, Tuple

from rosoclingo.common import durable

#: What this version writes, and reads.
FORMAT = 4

#: A state by sections: plain values that JSON knows, in the order in which they came.
State = Dict[str, Any]


class JournalError(Exception):
    """A journal that cannot be used; the text says what is wrong with it and what to do."""


class Header(NamedTuple):
    """What a journal is of: the ``run`` of a core, the ``program`` (a hash) and the ``launch`` that has started it.

    ``description`` is the program whole and what else decisions depend on, as text for whoever replays the run.
    """

    run: str
    program: str
    launch: str = ""
    description: str = ""

    @property
    def record(self) -> State:
        """The header as a line's value."""
        return {"format": FORMAT, **self._asdict()}


class Kept(NamedTuple):
    """What a journal holds: its header, the state after the last whole record, and how many records there are."""

    header: Header
    state: State
    records: int


class Moment(NamedTuple):
    """The state after a record, and when that was written in seconds of the run's clock, None where it does not say."""

    state: State
    time: Optional[float]


def line_of(number: int, record: State, time: Optional[float] = None) -> bytes:
    """Return a record as the line of this ``number``, from 0; ``time`` is in seconds of the run's clock."""
    return durable.sealed({"n": number, **({} if time is None else {"at": round(time, 3)}), **record})


def read(data: bytes) -> Kept:
    """Return what the bytes of a file hold; raises JournalError with the number of the line that is not right."""
    header, values = _records(data)
    state: State = {}
    for value in values:
        _apply(state, value)
    return Kept(header, state, len(values))


def history(data: bytes) -> Tuple[Header, Iterator[Moment]]:
    """Return the header, and the moment after each record in turn: the same state, changed; raises JournalError."""
    header, values = _records(data)

    def moments() -> Iterator[Moment]:
        """Yield the moments."""
        state: State = {}
        for value in values:
            _apply(state, value)
            yield Moment(state, value.get("at"))

    return header, moments()


def changes(before: State, after: State) -> State:
    """Return what makes one state of the other, in the same order within each group; empty where they are the same."""
    moved = set() if list(before) == list(after) else _moved(before, after)
    gone = [name for name in before if name not in after or name in moved]
    new = {
        name: value
        for name, value in after.items()
        if name not in before or name in moved or not _same(before[name], value)
    }
    return {**({"drop": gone} if gone else {}), **({"set": new} if new else {})}


def group_of(name: str) -> str:
    """Return the group of a section ``GROUP:KEY``; one without a key is alone."""
    return name.partition(":")[0]


def _records(data: bytes) -> Tuple[Header, List[State]]:
    """Return the header and the changes, one at least; raises JournalError with the number of a line not right."""
    *lines, rest = data.split(b"\n")
    if rest and durable.opened(rest[:-1]) is not None:
        raise JournalError(f"line {len(lines) + 1} does not end as it was written")
    header = _header(_value(lines[0], 0) if lines else {})
    values = [_value(line, number) for number, line in enumerate(lines)]
    if len(values) < 2:
        raise JournalError("line 2 is missing: a journal begins with all that was known")
    return header, values[1:]


def _moved(before: State, after: State) -> Set[str]:
    """The sections that stand behind others of their group than before: new ones come last."""
    places = {name: place for place, name in enumerate(before)}
    last: Dict[str, float] = {}
    found: Set[str] = set()
    for name in after:
        group, place = group_of(name), places.get(name, math.inf)
        if place < last.get(group, -1):
            found.add(name)
            place = math.inf
        last[group] = place
    return found


def _apply(state: State, change: State) -> None:
    for name in change.get("drop", ()):
        state.pop(name, None)
    state.update(change.get("set", {}))


def _same(one: Any, other: Any) -> bool:
    return one is other or one == other


def _value(line: bytes, number: int) -> State:
    value = durable.opened(line)
    if value is None:
        raise JournalError(f"line {number + 1} is not as it was written")
    if value["n"] != number:
        raise JournalError(f"line {number + 1} is missing: record {value['n']} stands in its place")
    return value


def _header(value: State) -> Header:
    if not value:
        raise JournalError("line 1 is missing: there is no header")
    if value.get("format") != FORMAT:
        raise JournalError(f"line 1: it is of format {value.get('format')}, this version reads {FORMAT}")
    return Header(*(str(value[field]) for field in Header._fields))


def launch_of(data: bytes) -> str:
    """Return the launch that a journal says it is of, whatever is wrong with the rest; empty where it says none."""
    try:
        return str(json.loads(data.split(b"\n")[0])["launch"])
    except (ValueError, KeyError, TypeError):
        return ""


def lines_of(kept: Kept) -> Iterable[str]:
    """Yield a journal in words, for people."""
    yield f"run {kept.header.run}, {kept.records} records since all was written"
    for name, value in kept.state.items():
        yield f"{name} {json.dumps(value)}"
