"""Tasks in PDDL, for planners that benches compare with."""

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
        actions_of: returns the actions that the operators of a plan stand for.

    """

    domain: str
    problem: str
    actions_of: Callable[[Sequence[Operator]], List[Action]]


def last_arguments(plan: Sequence[Operator]) -> List[Action]:
    """Return actions with the operators' names and last arguments."""
    return [(operator[0], operator[-1]) for operator in plan]


def task_of(
    domain: Path,
    objects: Dict[str, Iterable[str]],
    init: Iterable[str],
    goal: Iterable[str],
    actions_of: Callable[[Sequence[Operator]], List[Action]] = last_arguments,
) -> Pddl:
    """Return a task of the domain in a file, with ``objects`` by type, and atoms without their parentheses."""
    typed = " ".join(f"{' '.join(names)} - {kind}" for kind, names in objects.items())
    initial, wanted = (" ".join(f"({atom})" for atom in atoms) for atoms in (init, goal))
    head = f"(define (problem task) (:domain {domain.stem})\n"
    problem = f"{head}(:objects {typed})\n(:init {initial})\n(:goal (and {wanted})))\n"
    return Pddl(domain.read_text(), problem, actions_of)
