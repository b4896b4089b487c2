"""Runs with actions that go on: each return belongs to the action as it was sent, in all views of the run."""

from itertools import count

import pytest
from journal_runs import LASTS
from journal_runs import play as play_journal
from team_programs import TEAM

from rosoclingo.oclingo import ReactiveProgram, parse_updates
from rosoclingo.runs.journal_run import journal_run, journal_view
from rosoclingo.runs.replay import CycleVerdict, Replay
from rosoclingo.runs.sent_returns import SentReturns


@pytest.mark.parametrize(
    ("stream", "returns"),
    [
        ("#step 2. _return(saw,1,1). #endstep.", ["_return(saw,1,1)"]),
        ("#step 2. _running(saw,1,1). #endstep. #step 3. _return(saw,1,2). #endstep.", ["_return(saw,1,1)"]),
        ("#step 2. _running(saw,1,1). #endstep. #step 3. _return(drill,1,2). #endstep.", ["_return(drill,1,2)"]),
        (
            """#step 2. _running(saw,1,1). #endstep. #step 3. _running(saw,1,2). _running(saw,2,2). #endstep.
            #step 4. _return(saw,2,3). _return(saw,worn,3). #endstep. #step 5. _return(saw,3,4). #endstep.""",
            ["_return(saw,2,2)", "_return(saw,worn,1)", "_return(saw,3,4)"],
        ),
        (
            """#step 4. _running(saw,1,2). _running(saw,1,3). #endstep.
            #step 5. _running(saw,1,4). _return(saw,2,4). #endstep. #step 6. _return(saw,failed(1),5). #endstep.""",
            ["_return(saw,2,4)", "_return(saw,failed(1),2)"],
        ),
    ],
)
def test_sent_returns_name_the_cycle_of_dispatch(stream, returns):
    found = SentReturns()
    assert [str(one.atom) for update in parse_updates(stream) for one in found.of(update)] == returns


def test_journal_view_ends_each_long_action_once(tmp_path):
    program, goals = ReactiveProgram.from_text(TEAM), [("a", "job(saw,1)"), ("b", "job(drill,2)"), ("c", "job(saw,3)")]
    turns = count()
    path, _ = play_journal(tmp_path, program, goals, cancel_at=99, ends=lambda awaited: awaited[next(turns) < 4 :])
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
