"""Runs the planner Fast Downward (https://www.fast-downward.org, GPL) for comparison, if it is installed.

The package up-fast-downward of PyPI provides it (the group bench of pyproject.toml). No module of it is imported.
"""

import re
import subprocess
import tempfile
from functools import lru_cache
from pathlib import Path
from typing import Optional, Tuple

from figures import children_time
from planning_domains import Task
from routing import bench_python

HOW = "Fast Downward is not installed, so its columns are left out; ./dev bench domains many_goals installs it"

ALIASES = {"lama-first": "lama-first", "lama": "seq-sat-lama-2011"}
"""Configurations of Fast Downward: the first stops at its first plan, the second continues with shorter plans."""


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


def solve(task: Task, alias: str, seconds: float) -> Tuple[float, Optional[int]]:
    """Return the processor time of a run in seconds, translation included, and the steps of its best plan.

    The search is limited to ``seconds`` of processor time, at least one. Without a plan, the steps are None.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "domain.pddl").write_text(task.domain)
        (folder / "problem.pddl").write_text(task.problem)
        limit = ["--search-time-limit", f"{max(1.0, seconds):g}s", "--plan-file", "plan"]
        command = [bench_python(), str(driver()), "--alias", ALIASES[alias], *limit, "domain.pddl", "problem.pddl"]
        before = children_time()
        subprocess.run(command, cwd=name, capture_output=True, check=False)
        plans = sorted(folder.glob("plan*"), key=lambda path: int(path.suffix[1:] or 0))
        steps = len(re.findall(r"^\(", plans[-1].read_text(), re.MULTILINE)) if plans else None
        return children_time() - before, steps
