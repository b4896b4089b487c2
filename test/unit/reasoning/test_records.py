"""The rows of the persisted state, and their changes; the history that a resumed core needs."""

import json
from typing import FrozenSet, List, Optional, Tuple

import pytest
from clingo import Symbol
from hypothesis import example, given
from hypothesis import strategies as st

from rosoclingo.oclingo import parse_atom, parse_update
from rosoclingo.planning.history import AcceptedUpdate, AdoptedPlan, History, Plan
from rosoclingo.planning.snapshot import Snapshot
from rosoclingo.reasoning.action_extractor import TaskPlan
from rosoclingo.reasoning.goals import GoalState
from rosoclingo.reasoning.keywords import Action, Return, action_of
from rosoclingo.reasoning.observations import Observation
from rosoclingo.reasoning.recorded_history import RecordedHistory
from rosoclingo.reasoning.records import ChangeRecorder, PersistentPart, codec, fields, tables
from rosoclingo.reasoning.returns import Dispatch


def update(step):
    return AcceptedUpdate(parse_update(f"#step {step}. #endstep."), step)


def plan(step):
    return Plan(frozenset([parse_atom(f"_action_lib(go,a,{step})")]), step, shortest=True)


def checkpoint(step):
    return History().checkpoint(Snapshot(step=step, horizon=step)).entry


ENTRIES = {
    **{f"update {step}": update(step) for step in (1, 2, 3)},
    **{f"checkpoint {step}": checkpoint(step) for step in (0, 1, 2, 3)},
    "search": AcceptedUpdate(None, 1),
    **{f"plan {step}": AdoptedPlan(plan(step)) for step in (1, 2)},
}


def log_with(*names):
    return History().with_entries(*map(ENTRIES.get, names))


def names_of(log):
    """Return the names of all entries, oldest first."""
    found = []
    while log is not None and log.entry is not None:
        found.append(next(name for name, one in ENTRIES.items() if one == log.entry))
        log = log.before
    return found[::-1]


def text_of(value):
    return json.loads(json.dumps(value, allow_nan=False))


def recorded(log):
    """Return the part with the history ``log``, and the history that another core reads from its rows."""
    part, reader = RecordedHistory(), RecordedHistory()
    part.follow(log)
    reader.restore(text_of(part.record()))
    return part, reader.history


@pytest.mark.parametrize(
    ("entries", "passed"),
    [
        (["search"], 0),
        (["plan 1", "checkpoint 1", "plan 2", "search"], 1),
        (["plan 1", "update 1", "search", "update 2", "plan 2"], 0),
        (["update 1", "checkpoint 1", "plan 1", "update 2", "search"], 1),
        (["update 1", "checkpoint 1"], 0),
        (["update 1", "checkpoint 1", "search", "checkpoint 2", "update 2", "checkpoint 3", "search"], 3),
    ],
)
def test_records_begin_at_checkpoint_before_last_update(entries, passed):
    """Without an earlier update they begin at the last one or the start, from where it can be left out as well."""
    log = log_with(*entries)
    _, kept = recorded(log)
    assert names_of(kept) == entries[passed:]
    assert (kept.step, kept.horizon, kept.keep_from) == (log.step, log.horizon, log.keep_from)
    assert (kept.update is None) == (log.update is None)


ACTIONS = tuple(action_of(parse_atom(f'_action_lib(say,"{word}",1)')) for word in ("a, b", "c"))
RETURN = Return(*ACTIONS[0])


@pytest.mark.parametrize(
    ("hint", "value"),
    [
        (TaskPlan, TaskPlan(ACTIONS, ("no cycle", "no cycle, either"))),
        (Optional[TaskPlan], None),
        (Observation, Observation(RETURN.atom, 3, ACTIONS, "eye", parse_atom("_seen(now)"), outdated=True, message=5)),
        (Dispatch, Dispatch(1, ACTIONS, 2.5, [RETURN], [])),
        (FrozenSet[Action], frozenset(ACTIONS)),
        (List[Tuple[Symbol, ...]], [(), (parse_atom('f("x",-1)'),)]),
        (GoalState, GoalState.ACTIVE),
        (float, float("-inf")),
    ],
)
def test_codec_reads_back_values_of_a_type(hint, value):
    found = codec(hint)
    assert found.decode(text_of(found.encode(value))) == value


KEYS = st.sampled_from("abcd")
STEPS = st.lists(
    st.one_of(
        st.tuples(st.just("assign"), KEYS, st.lists(st.integers(0, 2), max_size=1)),
        st.tuples(st.just("append"), KEYS),
        st.tuples(st.just("pop"), KEYS),
        st.tuples(st.just("replace"), st.dictionaries(KEYS, st.just([1]))),
        st.tuples(st.just("count")),
        st.tuples(st.just("record")),
    ),
    max_size=20,
)


class Rows(PersistentPart):
    """A part with attributes, and a dictionary of values that change in place."""

    GROUP = "rows"
    FIELDS = fields(_step=int, words=List[str], plan=Tuple[str, ...])
    TABLES = tables(items=("row", str, List[int]))

    def __init__(self):
        self._step, self.words, self.plan = 1, ["a"], ("go",)
        self.items = {}

    @property
    def fields_now(self):
        """Return the expected rows of the attributes."""
        return {"rows:step": self._step, "rows:words": self.words, "rows:plan": list(self.plan)}

    def assign(self, key, value):
        self.items[key] = list(value)

    def append(self, key):
        self.items.get(key, []).append(3)

    def pop(self, key):
        self.items.pop(key, None)

    def replace(self, items):
        self.items = {key: list(value) for key, value in items.items()}

    def count(self):
        self._step += 1
        self.words.append("b")
        self.plan = tuple(self.plan)


#: A row that moves to the end.
MOVE = [("assign", "a", []), ("assign", "b", []), ("record",), ("pop", "a"), ("assign", "a", [])]


@example(steps=MOVE)
@given(steps=STEPS)
def test_changes_yield_rows_in_order_and_only_new_values(steps):
    part, recorder, rows = Rows(), ChangeRecorder(), {}
    for name, *arguments in [*steps, ("record",)]:
        if name != "record":
            getattr(part, name)(*arguments)
            continue
        changes = text_of(recorder.changes([part]))
        for one in changes.get("drop", ()):
            del rows[one]
        assert all(rows.get(key) != value for key, value in changes.get("set", {}).items())
        rows.update(changes.get("set", {}))
        items_now = {f"row:{key}": value for key, value in part.items.items()}
        assert rows == text_of(part.record()) == {**part.fields_now, **items_now}
        assert [key for key in rows if key in items_now] == [*items_now]
        assert recorder.changes([part]) == {}
    reader = Rows()
    reader.restore({"core:step": 1, **rows})
    assert vars(reader) == vars(part)
    assert [*reader.items] == [*part.items]
