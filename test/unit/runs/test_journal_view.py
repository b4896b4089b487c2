"""A core's journal on a page: goals, cycles, actions and times of the run, and the missing parts."""

from itertools import count

import pytest
from journal_runs import GOALS, LASTS, journal_run, journal_view, play
from shipped import shipped
from team_programs import TEAM

from rosoclingo.oclingo import ReactiveProgram, parse_update
from rosoclingo.reasoning.events import ActionsDispatched, PlanMade, UpdateSent
from rosoclingo.reasoning.settings import CoreSettings
from rosoclingo.runs.replay import CycleVerdict, Replay
from rosoclingo.runs.run_view import LACKS


def records(view, name):
    return [record for _, record in view.changes()[name]]


@pytest.mark.slow
def test_journal_view_shows_the_published_run(whole):
    file, published = whole
    view = journal_view(file)
    assert (view.about["lacks"], view.about["run"]) == (LACKS, 1)
    assert view.about["labels"] == {"office1": [1.0, 2.0, 0.0], "office2": [5.0, 2.0, 1.5]}
    goals = {goal["id"]: goal for goal in records(view, "goals")}
    assert [(key, goal["request"], goal["sent"]) for key, goal in goals.items()] == [
        (key, text, LASTS * number) for number, (key, text) in enumerate(GOALS)
    ]
    assert [word for _, word, *_ in goals["a"]["states"]] == ["pending", "active", "succeeded"]
    assert [word for _, word, *_ in goals["b"]["states"]][-2:] == ["canceling", "canceled"]
    cycles = {one["cycle"]: one for one in records(view, "cycles")}
    sent = {event.cycle: event.stream for event in published if isinstance(event, UpdateSent)}
    assert {cycle: one["updates"] for cycle, one in cycles.items() if one["updates"]} == {
        cycle: [str(parse_update(text).plain).strip()] for cycle, text in sent.items()
    }
    made = {event.cycle: event.horizon for event in published if isinstance(event, PlanMade) and event.cycle > 1}
    assert {cycle: cycles[cycle]["plans"][-1]["horizon"] for cycle in made} == made
    actions = records(view, "actions")
    acts = [action for event in published if isinstance(event, ActionsDispatched) for action in event.actions]
    names = [view.changes()["words"][one["action"]][1] for one in actions]
    assert [(one["interface"], one["parameter"], one["cycle"]) for one in names] == [
        (one.interface_name, str(one.parameter), one.cycle) for one in acts
    ]
    assert {one["ended"] - one["begun"] for one in actions} == {LASTS}
    assert [one["value"] for one in actions if one["failed"]] == ["blocked"]
    lines = [(one["kind"], one["text"]) for one in records(view, "log")]
    assert lines[0] == ("request", "Bring package 1 from office3 to office2")
    assert {("cancel", "Bring package 2 from office2 to office4"), ("return", "picks up 1: blocked")} <= {*lines}
    terms = [one["text"] for one in records(view, "terms")]
    places = [terms[one] for belief in records(view, "beliefs") for one in belief["atoms"] if "robot_at(" in terms[one]]
    assert (places[0], "robot_at(office3,now)" in places) == ("robot_at(office1,now)", True)


@pytest.mark.slow
def test_journal_view_shows_a_queued_goal(tmp_path):
    program, settings = shipped("mailbot.lp", "office.lp"), CoreSettings(goals_at_once=1)
    file, _ = play(tmp_path, program, GOALS[:2], None, None, settings=settings)
    _, waiting = records(journal_view(file), "goals")
    assert [word for _, word, *_ in waiting["states"]] == ["pending", "waiting", "pending", "active", "succeeded"]


@pytest.mark.slow
def test_journal_view_of_rewritten_journal_begins_with_open_goals(late):
    file, published = late
    view = journal_view(file)
    first = min(one["cycle"] for one in records(view, "cycles"))
    assert first > 1
    assert f"it begins with cycle {first}" in view.about["lacks"]
    last = [one for event in published if isinstance(event, ActionsDispatched) for one in event.actions][-1]
    word = view.changes()["words"][records(view, "actions")[-1]["action"]][1]
    assert (word["interface"], word["cycle"]) == (last.interface_name, last.cycle)
    assert all(goal["ended"] is not None for goal in records(view, "goals"))


@pytest.mark.slow
def test_journal_view_ends_each_long_action_once(tmp_path):
    program, goals = ReactiveProgram.from_text(TEAM), [("a", "job(saw,1)"), ("b", "job(drill,2)"), ("c", "job(saw,3)")]
    turns = count()
    path, _ = play(tmp_path, program, goals, cancel_at=99, ends=lambda awaited: awaited[next(turns) < 4 :])
    changes = journal_view(path).changes()
    records = [record for _, record in changes["actions"]]
    names = [changes["words"][one["action"]][1] for one in records]
    assert [(one["interface"], one["parameter"]) for one in names] == [
        ("saw", "1"),
        ("drill", "2"),
        ("saw", "3"),
        ("saw", "3"),
    ]
    assert [one["value"] for one in records] == ["1", "2", "blocked", "3"]
    assert [round(one["ended"] - one["begun"], 1) for one in records][1:] == [LASTS, LASTS, LASTS]
    assert records[0]["ended"] == max(one["ended"] for one in records)
    returns = [one["text"] for _, one in changes["log"] if one["kind"] == "return"]
    assert sorted(returns) == ["drill 2: done", "saw 1: done", "saw 3: blocked", "saw 3: done"]
    reports = list(Replay(journal_run(path), program).reports())
    assert {one.verdict for one in reports} == {CycleVerdict.SAME}
