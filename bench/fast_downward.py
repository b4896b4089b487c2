"""Runs the planner Fast Downward (https://www.fast-downward.org, GPL) for comparison, if it is installed.

The package up-fast-downward of PyPI provides it (the group bench of pyproject.toml). No module of it is imported.
"""

import re
import resource
import subprocess
import tempfile
from functools import lru_cache
from pathlib import Path
from typing import Callable, Dict, List, NamedTuple, Optional

from pddl import Action, Pddl
from routing import bench_python

HOW = "Fast Downward is not installed, so its columns are left out; ./dev bench domains many_goals installs it"

FIRST = "lama-first"
"""The alias that stops at the first plan."""

BEST = "seq-sat-lama-2011"
"""The alias that continues with shorter plans."""


class PlannerRun(NamedTuple):
    """Processor time of a run in seconds, translation included, and the operators of its best plan."""

    seconds: float
    plan: Optional[List[List[str]]]


@lru_cache(maxsize=None)
def driver() -> Optional[Path]:
    """Return the path of Fast Downward's driver; None if it is not installed."""
    code = "import importlib.util as u; print(u.find_spec('up_fast_downward').submodule_search_locations[0])"
    try:
        found = subprocess.run([bench_python(), "-c", code], capture_output=True, text=True, check=False)
    except OSError:
        return None
    path = Path(found.stdout.strip()) / "downward" / "fast-downward.py"
    return path if found.returncode == 0 and path.is_file() else None


def measure(task: Pddl, check: Callable[[List[Action]], None], limit: float, seconds: float) -> Dict[str, float]:
    """Return seconds and steps of the first plan, found within ``limit``, and of the best plan after ``seconds``.

    ``check`` raises an error if actions are not a plan. Without a plan there is no entry.
    """
    found = {}
    for name, alias, end in (("lama-first", FIRST, limit), ("lama", BEST, seconds)):
        spent, plan = _solve(task, alias, end)
        if plan is not None:
            actions = task.actions_of(plan)
            check(actions)
            found.update({f"{name} [s]": spent, name: len(actions)})
    return found


def _solve(task: Pddl, alias: str, seconds: float) -> PlannerRun:
    """Run Fast Downward; its search is limited to ``seconds`` of processor time, at least one."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "domain.pddl").write_text(task.domain)
        (folder / "problem.pddl").write_text(task.problem)
        options = ["--alias", alias, "--search-time-limit", f"{max(1.0, seconds):g}s", "--plan-file", "plan"]
        command = [bench_python(), str(driver()), *options, "domain.pddl", "problem.pddl"]
        before = _used()
        subprocess.run(command, cwd=name, capture_output=True, check=False)
        spent = _used() - before
        plans = sorted(folder.glob("plan*"), key=lambda path: int(path.suffix[1:] or 0))
        return PlannerRun(spent, _operators(plans[-1].read_text()) if plans else None)


def _used() -> float:
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def _operators(text: str) -> List[List[str]]:
    return [line.split() for line in re.findall(r"^\((.*)\)", text, re.MULTILINE)]
