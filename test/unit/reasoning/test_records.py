"""The part of the solver's log that the core keeps: enough to continue, also from before the last update."""

import json

import pytest

from rosoclingo.oclingo import parse_atom, parse_update
from rosoclingo.planning.history import AcceptedUpdate, AdoptedPlan, History, Plan
from rosoclingo.planning.snapshot import Snapshot
from rosoclingo.reasoning.action_extractor import TaskPlan
from rosoclingo.reasoning.keywords import action_of
from rosoclingo.reasoning.records import LogRecorder, group, keys_of, log_of, plan_of, plan_to_value


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


def term_text(record):
    return json.loads(json.dumps(record))


@pytest.mark.parametrize(
    ("entries", "passed"),
    [
        ([], 0),
        (["search"], 0),
        (["plan 1", "search", "plan 2"], 0),
        (["plan 1", "checkpoint 1", "plan 2", "search"], 1),
        (["checkpoint 1", "plan 1", "checkpoint 2"], 2),
        (["plan 1", "update 1", "search", "update 2", "plan 2"], 0),
        (["update 1", "checkpoint 1", "update 2"], 1),
        (["update 1", "checkpoint 1", "plan 1", "update 2", "search"], 1),
        (["update 1", "checkpoint 1"], 0),
        (["plan 1", "checkpoint 0", "plan 2", "update 1", "checkpoint 1", "plan 1"], 1),
        (["update 1", "checkpoint 1", "search", "checkpoint 2", "update 2", "checkpoint 3", "search"], 3),
    ],
)
def test_records_begin_at_checkpoint_before_last_update(entries, passed):
    """Without an earlier update they begin at the last one or the start, from where it can be left out as well."""
    log = log_with(*entries)
    kept = log_of(term_text(LogRecorder().record(log)))
    assert names_of(kept) == entries[passed:]
    assert (kept.step, kept.horizon, kept.keep_from) == (log.step, log.horizon, log.keep_from)
    assert (kept.update is None) == (log.update is None)


def test_records_name_each_entry_uniquely_while_kept():
    recorder = LogRecorder()
    log = log_with("plan 1", "update 1")
    first = recorder.record(log)
    assert keys_of(first, "log") == ["1", "2"]
    log = log.with_entries(ENTRIES["checkpoint 1"], ENTRIES["update 2"])
    second = recorder.record(log)
    assert keys_of(second, "log") == ["3", "4"]
    assert recorder.record(log) == second
    other = recorder.record(log.with_entries(ENTRIES["plan 2"]))
    assert {**other, **second} == other
    assert keys_of(other, "log") == ["3", "4", "5"]
    assert group(other, "log")["5"]["do"] == "adopt"
    assert group({"log:1": 1, "logs:2": 2, "log": 3, "a:log:1": 4}, "log") == {"1": 1}


@pytest.mark.parametrize("entries", [["plan 1", "update 1", "plan 2"], ["plan 1", "update 1"], ["update 1"]])
def test_records_of_log_keep_plan_of_both_histories(entries):
    log = log_with(*entries)
    kept = log_of(term_text(LogRecorder().record(log)))
    assert (kept.before_update.plan, kept.plan) == (log.before_update.plan, log.plan)


def test_records_of_task_plans():
    actions = tuple(action_of(parse_atom(f'_action_lib(say,"{word}",1)')) for word in ("a, b", "c"))
    for plan in (TaskPlan(), TaskPlan(actions), TaskPlan(actions, ("no cycle", "no cycle, either"))):
        assert plan_of(term_text(plan_to_value(plan))) == plan
