"""Preemption: find running actions that a new plan no longer needs, on a separate planner."""

from typing import FrozenSet, Tuple

from rosoclingo.oclingo import SolveOutcome, SolverError
from rosoclingo.reasoning.input_feeder import InputFeeder
from rosoclingo.reasoning.keywords import Action
from rosoclingo.reasoning.records import Record, actions_of, actions_to_text
from rosoclingo.reasoning.returns import ExecutionMonitor
from rosoclingo.reasoning.stream_planner import Planner


class Preemption:
    """Checks the running actions after each arrival, and reports each unwanted action once."""

    def __init__(self, feeder: InputFeeder, execution: ExecutionMonitor, declared: bool) -> None:
        """Check the actions that ``execution`` awaits; ``declared`` is true if the program receives ``_cancel/3``."""
        self._feeder = feeder
        self._execution = execution
        self._declared = declared
        self._considered = 0
        self._found: FrozenSet[Action] = frozenset()

    def begin(self) -> None:
        """Record that the actions of a cycle were dispatched."""
        self._considered, self._found = self._feeder.arrivals, frozenset()

    @property
    def found(self) -> Tuple[Action, ...]:
        """The running actions that are unwanted."""
        return tuple(action for action in self._execution.awaited if action in self._found)

    def record(self) -> Record:
        """Return the unwanted actions as a plain value."""
        return {"considered": self._considered, "ended": actions_to_text(sorted(self._found))}

    def restore(self, record: Record) -> None:
        """Restore from a record."""
        self._considered, self._found = record["considered"], frozenset(actions_of(record["ended"]))

    def unwanted(self, planner: Planner) -> Tuple[Action, ...]:
        """Return the running actions that are no longer wanted; raises DisturbedError after an arrival.

        Suppose that all running actions return ``preempted`` now. An action is wanted if some shortest plan then begins
        with it again. If there is no plan, or the program ignores this return, all actions are wanted.
        """
        if self._considered == self._feeder.arrivals:
            return ()
        running = tuple(action for action in self._execution.awaited if action not in self._found)
        return self._end(self._ask(planner, self._execution.under_way, running) if running else ())

    def end_all(self) -> Tuple[Action, ...]:
        """End all running actions, because the core shuts down; return them."""
        return self._end(tuple(action for action in self._execution.awaited if action not in self._found))

    def _end(self, actions: Tuple[Action, ...]) -> Tuple[Action, ...]:
        """Record actions as unwanted, and feed their cancellations to the program; return them."""
        for action in actions if self._declared else ():
            self._feeder.add_fact(action.cancellation)
        self._considered = self._feeder.arrivals
        self._found |= frozenset(actions)
        return actions

    def _ask(self, planner: Planner, executed: Tuple[Action, ...], running: Tuple[Action, ...]) -> Tuple[Action, ...]:
        cycle = executed[0].cycle
        returns = [self._execution.preempted(action) for action in running]
        try:
            trial = planner.restarted()
            ended = [action.cancellation for action in running] if self._declared else []
            result = trial.update(self._feeder.preview(cycle + 1, executed, [*ended, *returns]))
            unheard = any(str(atom) in warning for atom in returns for warning in result.warnings)
            if unheard or result.outcome is not SolveOutcome.SATISFIABLE:
                return ()
            again = {action: action._replace(cycle=trial.log.step).atom for action in running}
            steps = result.horizon - trial.log.step
            return tuple(
                action
                for action, atom in again.items()
                if atom not in result.answers[0] and not trial.can_begin_with(atom, steps)
            )
        except SolverError:
            return ()
