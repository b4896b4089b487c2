"""Fast Downward (https://www.fast-downward.org, GPL): a program that benches run, if it is there, as a peer.

It comes with the package up-fast-downward of PyPI (the group bench of pyproject.toml); nothing of it is imported.
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

HOW = "Fast Downward is not there: ./dev bench domains many_goals installs it (once); its columns are left out"

FIRST = "lama-first"
"""The alias that stops at the first plan."""

BEST = "seq-sat-lama-2011"
"""The alias that goes on to shorter plans."""


class Found(NamedTuple):
    """The seconds of processor time that a run took, translation included, and the operators of its best plan."""

    seconds: float
    plan: Optional[List[List[str]]]


@lru_cache(maxsize=None)
def driver() -> Optional[Path]:
    """Return the path of Fast Downward's driver; None if it is not there."""
    code = "import importlib.util as u; print(u.find_spec('up_fast_downward').submodule_search_locations[0])"
    try:
        found = subprocess.run([bench_python(), "-c", code], capture_output=True, text=True, check=False)
    except OSError:
        return None
    path = Path(found.stdout.strip()) / "downward" / "fast-downward.py"
    return path if found.returncode == 0 and path.is_file() else None


def measure(task: Pddl, check: Callable[[List[Action]], None], limit: float, seconds: float) -> Dict[str, float]:
    """Return seconds and steps of the first plan, found within a ``limit``, and steps of the best after ``seconds``.

    ``check`` raises an error unless actions are a plan. There is no entry without a plan.
    """
    found = {}
    for name, alias, end in (("lama-first", FIRST, limit), ("lama", BEST, seconds)):
        spent, plan = _solve(task, alias, end)
        if plan is not None:
            actions = task.actions_of(plan)
            check(actions)
            found.update({f"{name} [s]": spent, name: len(actions)})
    return found


def _solve(task: Pddl, alias: str, seconds: float) -> Found:
    """Run Fast Downward, its search for at most so many ``seconds`` of processor time, and at least one."""
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
        return Found(spent, _operators(plans[-1].read_text()) if plans else None)


def _used() -> float:
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def _operators(text: str) -> List[List[str]]:
    return [line.split() for line in re.findall(r"^\((.*)\)", text, re.MULTILINE)]
