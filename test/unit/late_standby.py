"""A fake standby worker in this process, whose prefetched answers arrive some cycles late."""

from rosoclingo.planning.solver import PlanSolver

NEVER = 10**9


class Standby:
    """Prefetches answers within ``delay`` cycles; its solvers have this ``plan_time``.

    Attributes:
        searches: number of searches that the robot waited for, because no answer was prefetched.
        waits: number of times that the core waited for a prefetched answer.

    """

    def __init__(self, delay=0, plan_time=0.0):
        self.delay, self.searches, self.waits, self.plan_time = delay, 0, 0, plan_time
        self._asked, self._since = None, 0

    def solver(self, program):
        """Return a solver that uses this standby."""
        return _Solver(program, self)

    def ask(self, question, step):
        if self._asked != question:
            self._asked, self._since = question, step

    def has(self, question, step):
        return self._asked == question and step - self._since >= self.delay


class _Solver(PlanSolver):
    def __init__(self, program, standby):
        super().__init__(program, plan_time=standby.plan_time)
        self._standby = standby

    def prefetch(self, update, before=()):
        log = self._log_after(before) if before else self.log
        if log is not None:
            self._standby.ask((update, log.key), self.log.step)
        return log is not None

    def has_prefetched(self, update, stopped=None):
        self._standby.waits += stopped is not None
        return self._standby.has((update, self.log.key), self.log.step)

    def update(self, update, *watches):
        self._standby.searches += not (self.predicts(update) or self.has_prefetched(update))
        return super().update(update, *watches)
