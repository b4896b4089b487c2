"""Plays the stream that a core published to a separate solver, and compares."""

from rosoclingo.reasoning.events import ActionsDispatched, PlanMade, Problem, UpdateSent
from rosoclingo.runs.recorded_run import RunCollector
from rosoclingo.runs.replay import AGREEING, CycleVerdict, Replay


def recorded(journal):
    """Return the run that a journal of a core's events describes."""
    collector = RunCollector()
    takes = {
        UpdateSent: lambda event: collector.update(0.0, event.stream),
        PlanMade: lambda event: collector.plan(
            0.0, event.cycle, event.horizon, [str(one.atom) for one in event.actions]
        ),
        ActionsDispatched: lambda event: collector.dispatched(0.0, [str(one.atom) for one in event.actions]),
        Problem: lambda event: collector.problem(0.0, event.cycle, event.message),
    }
    for event in journal.events:
        takes.get(type(event), lambda event: None)(event)
    (run,) = collector.runs()
    return run


def check_replay(program, journal):
    """Check that a solver agrees with each decision, different answers are explained, and updates occur once."""
    reported = journal.of(UpdateSent)
    reports = list(Replay(recorded(journal), program).reports()) if reported else []
    agreeing = (*AGREEING, CycleVerdict.MISSED)
    odd = [report.line() for report in reports if not report.explained or report.verdict not in agreeing]
    assert not odd, odd
    restarted = any("#anew." in event.stream for event in reported)
    steps = [event.cycle for event in reported]
    assert restarted or steps == sorted(set(steps)), "each cycle's update is sent once"
