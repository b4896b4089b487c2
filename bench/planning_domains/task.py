"""Tasks of planning domains, and the worlds in which plans are checked.

The rules of a domain are those of its PDDL file, which is independent of the program. A world refuses an action that
breaks a rule, so it checks the plans of any planner. A plan is a list of steps, and a step is a list of simultaneous
actions.
"""

import copy
import re
from dataclasses import dataclass, field
from functools import cached_property
from itertools import combinations, product
from pathlib import Path
from typing import Any, Dict, FrozenSet, Iterable, Iterator, List, NamedTuple, Optional, Sequence, Set, Tuple, Type

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.oclingo.program.sources import Source

FOLDER = Path(__file__).resolve().parent

#: An interface and its parameter.
Action = Tuple[str, str]

#: The actions of a step.
Step = Sequence[Action]

#: An atom of PDDL: its words without parentheses.
Atom = Tuple[str, ...]


class RuleError(Exception):
    """An action breaks a rule of the domain, or a plan does not meet its goals; the message contains the action."""


class Goal(NamedTuple):
    """A goal's term in the program, the atoms of PDDL that it asks for, and those of the state that belong to it."""

    term: str
    wanted: FrozenSet[Atom]
    given: FrozenSet[Atom]


def goal(term: str, wanted: Iterable[str], given: Iterable[str] = ()) -> Goal:
    """Return a goal; atoms are texts such as ``at home``."""
    return Goal(term, frozenset(atoms(wanted)), frozenset(atoms(given)))


class Operator(NamedTuple):
    """A ground operator of PDDL."""

    needs: FrozenSet[Atom]
    adds: FrozenSet[Atom]
    deletes: FrozenSet[Atom]


class Schema(NamedTuple):
    """An operator of PDDL with variables: its name, their types, its precondition and its effects."""

    name: str
    variables: Dict[str, str]
    needs: List[Atom]
    adds: List[Atom]
    deletes: List[Atom]


def schemas_of(text: str) -> List[Schema]:
    """Return the operators of a domain in PDDL, of which each condition is an atom or a conjunction of literals."""
    stack: List[List[Any]] = [[]]
    for token in re.findall(r"[()]|[^\s()]+", text):
        if token == "(":
            stack.append([])
        elif token == ")":
            stack[-2].append(stack.pop())
        else:
            stack[-1].append(token)
    found = []
    for _, name, _, words, _, condition, _, effect in (one for one in stack[0][0] if one[0] == ":action"):
        groups = re.findall(r"((?:\?\w+ )+)(?:- (\w+))?", " ".join(words) + " ")
        variables = {variable: kind or "object" for names, kind in groups for variable in names.split()}
        needs, effects = (one[1:] if one[0] == "and" else [one] for one in (condition, effect))
        adds = [tuple(one) for one in effects if one[0] != "not"]
        deletes = [tuple(one[1]) for one in effects if one[0] == "not"]
        found.append(Schema(name, variables, [tuple(one) for one in needs], adds, deletes))
    return found


class World:
    """The state that actions change.

    Attributes:
        state: the atoms that hold.
        open: the goals that are not met, by their numbers.

    """

    def __init__(self, task: "Task") -> None:
        self.task, self.state, self._operators = task, atoms(task.init), task.operators
        self.open: Dict[int, Goal] = {}

    def ask(self, number: int) -> None:
        """Add a goal of the task, unless it is open."""
        if number not in self.open:
            self.open[number] = self.task.goals[number - 1]
            self.state |= self.open[number].given

    def cancel(self, number: int) -> None:
        """Cancel a goal that no action has begun."""
        if number in self.open and self.open[number].given <= self.state:
            self.state -= self.open.pop(number).given

    def do(self, step: Step) -> None:
        """Execute a step of at most one action of each robot; raises RuleError."""
        if not 1 <= len(step) == len({robot for robot, _ in step}) <= self.task.robots:
            raise RuleError(f"not one action for each of {self.task.robots} robots: {step}")
        joint = self._applicable(step)
        operators = [joint] if joint else [self._applicable([one]) for one in step]
        if None in operators:
            raise RuleError(f"{step} is impossible in this state: {sorted(self.state)}")
        for operator in operators:
            self.state -= operator.deletes
            self.state |= operator.adds
        met = [number for number, goal in self.open.items() if goal.wanted <= self.state]
        if not self.task.together or len(met) == len(self.open):
            for number in met:
                del self.open[number]

    def _applicable(self, step: Step) -> Optional[Operator]:
        return next((one for one in self._operators.get(frozenset(step), ()) if one.needs <= self.state), None)

    def fail(self, action: Action) -> None:
        """Let an action fail, which changes nothing."""

    def can_fail(self, action: Action) -> bool:
        """Return whether a program can meet its goals although ``action`` fails, or aborts the goals concerned."""
        return True

    @property
    def at_rest(self) -> bool:
        """Whether all goals are met and the world is in a state in which a plan can end."""
        return atoms(self.task.final).union(*(goal.wanted for goal in self.open.values())) <= self.state

    def copy(self) -> "World":
        """Return a world in the same state."""
        other = copy.copy(self)
        other.state, other.open = set(self.state), dict(self.open)
        return other

    def do_possible(self, step: Step) -> None:
        """Execute as many actions of ``step`` as possible."""
        for part in (part for size in range(len(step), 0, -1) for part in combinations(step, size)):
            try:
                return self.do(part)
            except RuleError:
                continue
        return None


@dataclass
class Task:
    """An instance of a domain.

    Attributes:
        name: the name of the domain; its rules are those of the file ``NAME.pddl``.
        sources: the program.
        goals: the goals, numbered from 1.
        objects: the objects of PDDL, by type.
        init: the atoms of PDDL that hold at the start.
        actions: for each operator of PDDL, interfaces and parameters; ``{0}`` stands for its first argument.
        terms: the terms of the program for objects with other names.
        final: the atoms of PDDL that must hold at the end.
        together: whether the goals are only met when all of them hold.
        robots: the greatest number of actions in a step.
        world_type: the class of the world.

    """

    name: str
    sources: Sequence[Source]
    goals: Sequence[Goal]
    objects: Dict[str, Iterable[str]]
    init: Sequence[str]
    actions: Dict[str, str]
    terms: Dict[str, str] = field(default_factory=dict)
    final: Sequence[str] = ()
    together: bool = False
    robots: int = 1
    world_type: Type[World] = World

    @property
    def program(self) -> ReactiveProgram:
        """The loaded program."""
        return ReactiveProgram(self.sources)

    @cached_property
    def domain(self) -> str:
        """The text of the domain in PDDL."""
        return (FOLDER / f"{self.name}.pddl").read_text()

    @property
    def problem(self) -> str:
        """The text of the task in PDDL."""
        typed = " ".join(f"{' '.join(names)} - {kind}" for kind, names in self.objects.items())
        wanted = atoms(self.final).union(*(goal.wanted for goal in self.goals))
        initial, final = (" ".join(f"({' '.join(one)})" for one in sorted(those)) for those in (self._all, wanted))
        head = f"(define (problem task) (:domain {self.name})\n"
        return f"{head}(:objects {typed})\n(:init {initial})\n(:goal (and {final})))\n"

    @property
    def _all(self) -> Set[Atom]:
        """The atoms that hold at the start if all goals are open."""
        return atoms(self.init).union(*(goal.given for goal in self.goals))

    def world(self) -> World:
        """Return a world in which all goals are open."""
        world = self.world_type(self)
        for number in range(1, len(self.goals) + 1):
            world.ask(number)
        return world

    def actions_of(self, name: str, arguments: Sequence[str]) -> List[Action]:
        """Return the simultaneous actions that a ground operator stands for."""
        words = self.actions[name].format(*(self.terms.get(one, one) for one in arguments)).split()
        return list(zip(words[::2], words[1::2]))

    @cached_property
    def operators(self) -> Dict[FrozenSet[Action], List[Operator]]:
        """The ground operators for each set of simultaneous actions."""
        schemas, found = schemas_of(self.domain), {}
        added = {atom[0] for schema in schemas for atom in schema.adds}
        for schema in schemas:
            for binding in self._bindings(schema, added):
                parts = (frozenset(_filled(one, binding) for one in part) for part in schema[2:])
                actions = self.actions_of(schema.name, [binding[one] for one in schema.variables])
                found.setdefault(frozenset(actions), []).append(Operator(*parts))
        return found

    def _bindings(self, schema: Schema, added: Set[str]) -> Iterator[Dict[str, str]]:
        """Yield values of a schema's variables with which the conditions that no action adds hold initially."""
        bindings: List[Dict[str, str]] = [{}]
        for atom in (one for one in schema.needs if one[0] not in added):
            facts = [one for one in sorted(self._all) if one[0] == atom[0]]
            bindings = [
                {**binding, **dict(zip(atom[1:], fact[1:]))}
                for binding in bindings
                for fact in facts
                if all(binding.get(word, other) == other for word, other in zip(atom, fact))
            ]
        for binding in bindings:
            names = [one for one in schema.variables if one not in binding]
            for values in product(*(self.objects[schema.variables[one]] for one in names)):
                yield {**binding, **dict(zip(names, values))}


def atoms(texts: Iterable[str]) -> Set[Atom]:
    """Return atoms from texts such as ``at home``."""
    return {tuple(text.split()) for text in texts}


def _filled(atom: Atom, binding: Dict[str, str]) -> Atom:
    return tuple(binding.get(word, word) for word in atom)


def check(world: World, plan: Sequence[Step]) -> None:
    """Raise RuleError unless ``plan`` meets all goals of ``world``; ``world`` is not changed."""
    end = world.copy()
    for step in plan:
        if step:
            end.do(step)
    if not end.at_rest:
        raise RuleError("the plan does not meet all goals")


def superfluous(world: World, plan: Sequence[Step]) -> Set[Tuple[int, Action]]:
    """Return the superfluous actions of ``plan``, each with the number of its step from 0 on.

    An action is superfluous if the plan meets all goals without it and the actions that depend on it. Raises RuleError
    if ``plan`` is not a plan.
    """
    check(world, plan)
    return {(place, action) for place, step in enumerate(plan) for action in step if _leads(world, plan, place, action)}


def _leads(world: World, plan: Sequence[Step], place: int, left_out: Action) -> bool:
    """Return whether the plan meets all goals without the action ``left_out`` of step ``place``."""
    trial = world.copy()
    for number, step in enumerate(plan):
        trial.do_possible([action for action in step if (number, action) != (place, left_out)])
    return trial.at_rest
