"""Planning domains other than deliveries, with programs that give the solver no advice.

Each domain has three files:

* ``NAME.lp`` is the program as a user would write it.
* ``NAME.py`` generates tasks and contains the rules in plain Python.
* ``NAME.pddl`` is the same domain for other planners.

The program of the garden is the one of doc/tutorial.md. The domain crates has simultaneous actions, which PDDL lacks.
"""

from typing import Callable, Dict, NamedTuple, Tuple

from planning_domains import blocks, crates, disinfection, elevator, garden, gripper, hanoi, keys, tiles
from planning_domains.task import Action, RuleError, Step, Task, World, check, superfluous

__all__ = ["DOMAINS", "Action", "Domain", "RuleError", "Step", "Task", "World", "check", "superfluous"]


class Domain(NamedTuple):
    """A domain: a function that makes tasks, and its arguments for three sizes, without the seed."""

    make: Callable[..., Task]
    sizes: Dict[str, Tuple[int, ...]]


DOMAINS = {
    one.__name__.rpartition(".")[2]: Domain(one.make, one.SIZES)
    for one in (blocks, gripper, elevator, hanoi, tiles, keys, disinfection, garden, crates)
}
