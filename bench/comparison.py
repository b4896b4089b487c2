"""The common part of the benches that compare planners: measurements of the core and of Fast Downward, and a table."""

from contextlib import suppress
from typing import Callable, Dict, Iterable, List, Optional, Sequence, Tuple

import fast_downward
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
    "lama_seconds": Option(10.0, "time limit of seq-sat-lama-2011", 1.0),
}


def first_plan(task: Task, limit: float) -> Optional[Tuple[float, int]]:
    """Return the processor time (s) until a plan for all goals, and its steps; None after ``limit``."""
    with suppress(TooLongError), Robot(task, limit=limit) as robot:
        begin = robot.process.cpu_time
        robot.ask()
        steps = robot.plan()
        return robot.process.cpu_time - begin, steps
    return None


def improved_plans(task: Task, limit: float, seconds: float) -> List[Tuple[float, int]]:
    """Return the first plan with the default of ``~plan_time``, and all better plans of ``seconds`` of improvement.

    Each is the processor time (s) until the plan, and its steps. Without a plan within ``limit``, the list is empty.
    """
    with suppress(TooLongError), Robot(task, CoreParameters.plan_time, limit=limit) as robot:
        begin = robot.process.cpu_time
        robot.ask()
        found = [(robot.plan(), robot.process.cpu_time - begin)]
        found += [(steps, found[0][1] + used) for used, steps in robot.improve(seconds)]
        return [(used, steps) for steps, used in found]
    return []


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
        costs = {"longest [s]": robot.longest, "still [s]": robot.still, "queued": robot.queued}
        spent = robot.used - begin - robot.improving
        return {"executed": robot.executed, **costs, "out [s]": out, "ms": 1000 * spent / robot.executed}
    return {}


def fast_downward_plans(task: Task, limit: float, seconds: float) -> Cells:
    """Return seconds and steps of Fast Downward's first plan within ``limit``, and its best steps in ``seconds``."""
    found: Cells = {}
    for name, end in (("lama-first", limit), ("lama", seconds)):
        spent, plan = fast_downward.solve(task, name, end)
        if plan is not None:
            found.update({f"{name} [s]": spent, name: plan})
    return found


class Table:
    """A table that is printed row by row, with figures of some columns; empty cells are ``-``."""

    def __init__(self, head: str, columns: Sequence[str], units: Dict[str, str]) -> None:
        self._columns, self._units = columns, units
        self._print(head, dict(zip(columns, columns)))

    def row(self, name: str, cells: Cells) -> List[Figure]:
        """Print a row; return the figures of the columns that have units."""
        texts = {}
        for column in (one for one in self._columns if cells.get(one) is not None):
            texts[column] = f"{cells[column]:.2f}" if "[s]" in column or "/" in column else f"{cells[column]:.0f}"
        self._print(name, texts)
        return [Figure(f"{name}: {one}", cells[one], self._units[one]) for one in texts if one in self._units]

    def _print(self, name: str, texts: Dict[str, str]) -> None:
        shown = [texts.get(one, "-").rjust(max(5, len(one))) for one in self._columns]
        print("  ".join([name.ljust(20), *shown]), flush=True)
