"""Plays the stream that a core told to a solver of its own, and compares."""

from rosoclingo.oclingo import ReactiveSolver, SolveOutcome, parse_updates
from rosoclingo.reasoning import PlanMade, UpdateSent
from rosoclingo.reasoning.keywords import ACTION_LIB, action_of, is_keyword


def replayed(program, stream):
    """The results of all updates of ``stream``."""
    solver = ReactiveSolver(program, shortest=True, oclingo_strings=False)
    return [solver.update(update) for update in parse_updates(stream)]


def check_replay(program, journal, most=200):
    """The stream gives the same plan lengths; each update was told once. The latest ``most`` plans are compared."""
    told = journal.of(UpdateSent)
    results = replayed(program, journal.stream)
    assert len(results) == len(told)
    plans = {event.cycle: event for event in journal.of(PlanMade)}
    last = {event.cycle: result for event, result in zip(told, results)}
    for cycle in sorted(last)[-most:]:
        result, plan = last[cycle], plans[cycle]
        if result.outcome is SolveOutcome.SATISFIABLE:
            left = [
                atom for atom in result.answers[0] if is_keyword(atom, ACTION_LIB) and action_of(atom).cycle >= cycle
            ]
            told_left = [action for action in plan.actions if action.cycle >= cycle]
            assert (cycle, result.horizon, len(left)) == (cycle, plan.horizon, len(told_left))
        else:
            assert not [action for action in plan.actions if action.cycle >= cycle]
    begun_anew = any("#anew." in event.stream for event in told)
    steps = [event.cycle for event in told]
    assert begun_anew or steps == list(range(1, len(steps) + 1)), "each cycle's update is told once"
