"""Feeding the solver an update that it has refused: what can be taken of it is taken."""

from typing import Callable, Optional, Sequence

from rosoclingo.oclingo import DroppedError, SolverError, SolveResult
from rosoclingo.reasoning.goal_manager import GoalDesk
from rosoclingo.reasoning.goals import Goal, Outcome
from rosoclingo.reasoning.input_feeder import Batch
from rosoclingo.reasoning.stream_planner import Planner


def feed_less(
    planner: Planner, batch: Batch, error: SolverError, desk: GoalDesk, problem: Callable[[str], None]
) -> Optional[SolveResult]:
    """Feed what can be taken of a batch that came to an ``error``, and search; None where nothing of it is taken.

    Of an update that is refused, the new goals are left out, then all but the commitments. One that was dropped since
    its search would not end is first fed without looking ahead: then it is known, whatever the search does. Goals that
    are not taken end.
    """

    def refused(error: SolverError, goals: Sequence[Goal]) -> None:
        """Report an update that the solver does not take, and end the goals that it was for."""
        dropped = isinstance(error, DroppedError)
        why = ": ".join(filter(None, (planner.ended_by if dropped else "", str(error))))
        problem(f"update {batch.update.step} is {'dropped' if dropped else 'refused by the solver'}: {why}")
        text = f"is given up without a plan: {why}" if dropped else f"is refused by the solver: {why}"
        desk.end(goals, Outcome.ABORTED if dropped else Outcome.REJECTED, text)

    if isinstance(error, DroppedError):
        refused(error, ())
        take, fewer = planner.take, [batch.update, batch.without_goals, batch.commitments]
    else:
        refused(error, batch.goals)
        take, fewer = planner.update, [batch.without_goals, batch.commitments]
    for number, update in enumerate(fewer):
        if update not in fewer[:number]:
            try:
                return take(update)
            except SolverError as again:
                refused(again, batch.goals if update is batch.update else ())
    return None
