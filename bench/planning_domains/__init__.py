"""Planning domains that are no deliveries, with programs that give the solver no advice.

Of each domain there are: ``NAME.lp``, the program as a user would write it; ``NAME.py``, which makes tasks and has the
rules in plain Python; and ``NAME.pddl``, the same domain for other planners. The garden's program is that of
doc/tutorial.md; crates has actions at the same time, which PDDL lacks.
"""

from typing import Callable, Dict, NamedTuple, Tuple

from planning_domains import blocks, crates, disinfection, elevator, garden, gripper, hanoi, keys, tiles
from planning_domains.task import Action, RuleError, Step, Task, World, check, superfluous

__all__ = ["DOMAINS", "Action", "Domain", "RuleError", "Step", "Task", "World", "check", "superfluous"]


class Domain(NamedTuple):
    """A domain: what makes a task of it, and the arguments for tasks of three sizes, without the seed."""

    make: Callable[..., Task]
    sizes: Dict[str, Tuple[int, ...]]


DOMAINS = {
    one.__name__.rpartition(".")[2]: Domain(one.make, one.SIZES)
    for one in (blocks, gripper, elevator, hanoi, tiles, keys, disinfection, garden, crates)
}
