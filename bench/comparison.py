"""The common part of the benches that compare planners: measurements of the core, and a table."""

from contextlib import suppress
from typing import Callable, Dict, Iterable, List, Optional, Tuple

from acting_core import Robot, TooLongError
from figures import Figure, Option
from planning_domains import Task

from rosoclingo.nodes.core.loading import CoreParameters

Cells = Dict[str, Optional[float]]

#: Returns the numbers of the goals that arrive before the next action.
Due = Callable[[Robot], Iterable[int]]

OPTIONS = {
    "seed": Option(1, "seed of the tasks"),
    "action_time": Option(0.5, "seconds to improve the plan during an action; real actions take longer", 0.05),
    "limit": Option(60.0, "time limit of a plan for all goals", 10.0),
}


def first_plan(task: Task, timeout: float = 0.0, limit: float = 0.0) -> Optional[Tuple[float, int, int]]:
    """Return the processor time (s) until the first plan, its steps, and the number of queued goals.

    Without a ``timeout`` of searches, the plan is for all goals; None if a search takes longer than ``limit``.
    """
    with suppress(TooLongError), Robot(task, search_timeout=timeout, limit=limit) as robot:
        begin = robot.process.cpu_time
        robot.ask()
        steps = robot.plan()
        return robot.process.cpu_time - begin, steps, robot.waiting
    return None


def execute(task: Task, action_time: float, timeout: float, limit: float = 0.0, due: Optional[Due] = None) -> Cells:
    """Execute all goals; return the number of steps and the costs, nothing if a search takes longer than ``limit``.

    Without ``due``, all goals arrive at once.
    """
    with suppress(TooLongError), Robot(task, CoreParameters.plan_time, timeout, limit) as robot:
        begin, start, out = robot.used, robot.process.cpu_time, 0.0
        robot.ask(due and due(robot))
        while robot.busy:
            robot.plan_until_action()
            out = out or robot.process.cpu_time - start
            robot.act(action_time)
            robot.ask(due(robot) if due else ())
        costs = {"longest [s]": robot.longest, "still [s]": robot.still, "out [s]": out}
        spent = robot.used - begin - robot.improving
        return {"executed": robot.executed, **costs, "ms": 1000 * spent / robot.executed}
    return {}


class Table:
    """A table that is printed row by row; empty cells are ``-``. Columns whose unit is not None are figures."""

    def __init__(self, head: str, columns: Dict[str, Optional[str]]) -> None:
        self._columns = columns
        self._print(head, {column: column for column in columns})

    def row(self, name: str, cells: Cells) -> List[Figure]:
        """Print a row; return its figures."""
        texts = {}
        for column in (one for one in self._columns if cells.get(one) is not None):
            texts[column] = f"{cells[column]:.2f}" if "[s]" in column or "/" in column else f"{cells[column]:.0f}"
        self._print(name, texts)
        units = ((one, self._columns[one]) for one in texts)
        return [Figure(f"{name}: {one}", cells[one], unit) for one, unit in units if unit is not None]

    def _print(self, name: str, texts: Dict[str, str]) -> None:
        shown = [texts.get(one, "-").rjust(max(5, len(one))) for one in self._columns]
        print("  ".join([name.ljust(20), *shown]), flush=True)
