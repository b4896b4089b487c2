"""Planning domains other than deliveries, with programs that give the solver no advice.

Each domain has three parts:

* ``NAME.lp`` is the program as a user would write it. The program of the garden is the one of doc/tutorial.md.
* The function NAME in ``tasks.py`` makes random tasks.
* ``NAME.pddl`` has the rules, with which worlds check plans. It is the same domain for other planners, except that
  the two robots of crates act simultaneously, which PDDL lacks.
"""

from planning_domains.task import Action, Goal, RuleError, Step, Task, World, check, superfluous
from planning_domains.tasks import DOMAINS

__all__ = ["DOMAINS", "Action", "Goal", "RuleError", "Step", "Task", "World", "check", "superfluous"]
