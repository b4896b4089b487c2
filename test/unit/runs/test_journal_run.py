"""A core's journal as a recorded run: it has the published messages and decisions, and is solved again."""

import pytest
from journal_runs import changed, journal_run
from shipped import shipped

from rosoclingo.reasoning.events import ActionsDispatched, UpdateSent
from rosoclingo.runs.recorded_run import RecordingError
from rosoclingo.runs.replay import AGREEING, Replay


def streams(published):
    return "".join(event.stream for event in published if isinstance(event, UpdateSent))


def dispatched(published):
    events = [event for event in published if isinstance(event, ActionsDispatched)]
    return {event.cycle: [str(one.atom) for one in event.actions] for event in events}


@pytest.mark.slow
def test_journal_run_has_the_published_messages_and_actions(whole):
    file, published = whole
    run = journal_run(file)
    assert run.program.run == "run"
    assert run.program.load().fingerprint == shipped("mailbot.lp", "office.lp").fingerprint
    assert run.stream.split() == streams(published).split()
    assert {one.cycle: one.dispatched for one in run.cycles if one.dispatched} == dispatched(published)


@pytest.mark.slow
def test_journal_run_continues_from_a_stored_state(late):
    file, published = late
    run = journal_run(file)
    first, sent = run.cycles[0].cycle, dispatched(published)
    assert first > 1
    assert {one.cycle: one.dispatched for one in run.cycles if one.dispatched} == {
        cycle: actions for cycle, actions in sent.items() if cycle >= first
    }
    reports = list(Replay(run, run.program.load(), run.program.plan_time).reports())
    assert [one.line() for one in reports if not one.explained or one.verdict not in AGREEING] == []


@pytest.mark.slow
def test_journal_run_from_stored_state_has_no_stream(late):
    with pytest.raises(RecordingError, match=r"the updates before cycle \d+ are compacted to a checkpoint"):
        _ = journal_run(late[0]).stream


def test_journal_run_can_be_empty(whole, tmp_path):
    with pytest.raises(RecordingError, match="there is nothing to replay yet"):
        journal_run(changed(whole[0], tmp_path / "begun", "DELETE FROM record WHERE number > 1"))
