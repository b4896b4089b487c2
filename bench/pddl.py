"""Tasks in PDDL for the other planners of a bench."""

from pathlib import Path
from typing import Callable, Dict, Iterable, List, NamedTuple, Sequence, Tuple

#: An interface and its parameter.
Action = Tuple[str, str]

#: The name of an operator and its arguments.
Operator = Sequence[str]


class Pddl(NamedTuple):
    """A task in PDDL.

    Attributes:
        domain: the text of the domain.
        problem: the text of the problem.
        actions_of: converts the operators of a plan to actions.

    """

    domain: str
    problem: str
    actions_of: Callable[[Sequence[Operator]], List[Action]]


def last_arguments(plan: Sequence[Operator]) -> List[Action]:
    """Return an action for each operator: its name and its last argument."""
    return [(operator[0], operator[-1]) for operator in plan]


def task_of(
    domain: Path,
    objects: Dict[str, Iterable[str]],
    init: Iterable[str],
    goal: Iterable[str],
    actions_of: Callable[[Sequence[Operator]], List[Action]] = last_arguments,
) -> Pddl:
    """Return a task of the ``domain`` file; ``objects`` are sorted by type, atoms have no parentheses."""
    typed = " ".join(f"{' '.join(names)} - {kind}" for kind, names in objects.items())
    initial, final = (" ".join(f"({atom})" for atom in atoms) for atoms in (init, goal))
    head = f"(define (problem task) (:domain {domain.stem})\n"
    problem = f"{head}(:objects {typed})\n(:init {initial})\n(:goal (and {final})))\n"
    return Pddl(domain.read_text(), problem, actions_of)
