"""Preemption: find running actions that a new plan no longer needs, on a separate planner."""

from typing import FrozenSet, Iterable, Tuple

from rosoclingo.oclingo import SolveOutcome, SolverError
from rosoclingo.reasoning.input_feeder import InputFeeder
from rosoclingo.reasoning.keywords import Action
from rosoclingo.reasoning.records import PersistentPart, fields
from rosoclingo.reasoning.returns import ExecutionMonitor
from rosoclingo.reasoning.stream_planner import Planner


class Preemption(PersistentPart):
    """Checks the running actions after each arrival, and reports each unwanted action once."""

    GROUP = "preemption"
    FIELDS = fields(_considered=int, _found=FrozenSet[Action])

    def __init__(self, feeder: InputFeeder, execution: ExecutionMonitor, declared: bool) -> None:
        """Check the actions that ``execution`` awaits; ``declared`` is true if the program receives ``_cancel/3``."""
        self._feeder = feeder
        self._execution = execution
        self._declared = declared
        self._considered = 0
        self._found: FrozenSet[Action] = frozenset()

    def begin(self, actions: Tuple[Action, ...]) -> None:
        """Record that ``actions`` were dispatched; no arrival can have made them useless yet."""
        if actions and actions == self._execution.awaited:
            self._considered = self._feeder.arrivals

    @property
    def found(self) -> Tuple[Action, ...]:
        """The running actions that are unwanted."""
        return tuple(action for action in self._execution.awaited if action in self._found)

    def unwanted(self, planner: Planner) -> Tuple[Action, ...]:
        """Return the running actions that are no longer wanted; raises DisturbedError after an arrival.

        Suppose that all running actions return ``preempted`` now. An action is wanted if some shortest plan then begins
        with it again. If there is no plan, or the program ignores this return, all actions are wanted.
        """
        if self._considered == self._feeder.arrivals:
            return ()
        running = tuple(action for action in self._execution.awaited if action not in self._found)
        found = self._ask(planner, running) if running else ()
        self._considered = self._feeder.arrivals
        return self.end(found)

    def end_all(self) -> Tuple[Action, ...]:
        """End all running actions, because the core shuts down; return them."""
        return self.end(self._execution.awaited)

    def end(self, actions: Iterable[Action]) -> Tuple[Action, ...]:
        """Record running actions as unwanted, and feed their cancellations to the program; return the new ones."""
        found = tuple(action for action in actions if action not in self._found)
        for action in found if self._declared else ():
            self._feeder.add_fact(self._execution.present(action).cancellation)
            self._considered += 1
        self._found = frozenset((*self.found, *found))
        return found

    def _ask(self, planner: Planner, running: Tuple[Action, ...]) -> Tuple[Action, ...]:
        execution, others = self._execution, self._found
        returns = [execution.preempted(action) for action in running]
        try:
            trial = planner.restarted()
            trial.running = lambda: {one: planned for one, planned in execution.running.items() if one in others}
            ended = [execution.present(action).cancellation for action in running] if self._declared else []
            update = self._feeder.preview(execution.cycle + 1, execution.under_way, [*ended, *returns])
            result = trial.update(update)
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
