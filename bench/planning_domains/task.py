"""Tasks of planning domains, and the worlds in which plans are checked.

A plan is a list of steps, and a step is a list of simultaneous actions. The rules of a world are independent of the
program. A world refuses an action that breaks a rule, so it checks the plans of any planner.
"""

import copy
from itertools import combinations
from pathlib import Path
from typing import Callable, Dict, Iterable, List, NamedTuple, Optional, Sequence, Set, Tuple

from pddl import Action, Pddl

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.oclingo.program.sources import Source

FOLDER = Path(__file__).resolve().parent


#: The actions of a step.
Step = Sequence[Action]


class RuleError(Exception):
    """An action breaks a rule; the message contains the rule."""


def require(condition: bool, why: str) -> None:
    """Raise RuleError unless ``condition`` holds."""
    if not condition:
        raise RuleError(why)


class World:
    """The state that actions change; the method ``do_INTERFACE`` executes an action.

    Attributes:
        open: the goals that are not met, by their numbers: name and arguments.

    """

    def __init__(self) -> None:
        self.open: Dict[int, Tuple[str, ...]] = {}

    def ask(self, number: int, goal: str) -> None:
        """Add a goal, a term such as ``fetch(t1,1)``."""
        name, arguments = goal[:-1].split("(")
        self.open[number] = (name, *arguments.split(","))

    def cancel(self, number: int) -> None:
        """Cancel a goal."""
        self.open.pop(number, None)

    def do(self, step: Step) -> None:
        """Execute a step of one action; raises RuleError."""
        require(len(step) == 1, "one action at a time")
        interface, parameter = step[0]
        act: Optional[Callable[[str], None]] = getattr(self, f"do_{interface}", None)
        if act is None:
            raise RuleError(f"there is no action {interface}")
        act(parameter)

    def fail(self, action: Action) -> None:
        """Let an action fail, which changes nothing."""

    def can_fail(self, action: Action) -> bool:
        """Return whether a program can meet its goals although ``action`` fails, or aborts the goals concerned."""
        return True

    @property
    def at_rest(self) -> bool:
        """Whether all goals are met and the world is in a state in which a plan can end."""
        return not self.open

    def copy(self) -> "World":
        """Return a world in the same state."""
        return copy.deepcopy(self)

    def do_possible(self, step: Step) -> None:
        """Execute as many actions of ``step`` as possible."""
        for size in range(len(step), 0, -1):
            for part in combinations(step, size):
                trial = self.copy()
                try:
                    trial.do(part)
                except RuleError:
                    continue
                self.__dict__.update(trial.__dict__)
                return


class Arrangement(World):
    """A world of things in places, whose goals are met when all of them hold.

    A goal is ``NAME(THING,PLACE,ID)``, or ``solve(ID)``, which holds if all things are at their ``targets``.
    """

    def __init__(self, places: Dict[str, str], targets: Optional[Dict[str, str]] = None) -> None:
        super().__init__()
        self.places, self._targets = dict(places), targets

    def do(self, step: Step) -> None:
        super().do(step)
        self.meet()

    def meet(self) -> None:
        """Close the goals if all of them hold."""
        if self.at_rest:
            self.open.clear()

    def _holds(self, goal: Sequence[str]) -> bool:
        return self.places == self._targets if goal[0] == "solve" else self.places.get(goal[1]) == goal[2]

    @property
    def at_rest(self) -> bool:
        return all(map(self._holds, self.open.values()))


class Task(NamedTuple):
    """An instance of a domain.

    Attributes:
        sources: the program.
        goals: the goals' terms, whose numbers count from 1.
        new_world: returns a world without goals.
        pddl: the same task in PDDL; None if there is none.

    """

    sources: Sequence[Source]
    goals: Sequence[str]
    new_world: Callable[[], World]
    pddl: Optional[Pddl] = None

    @property
    def program(self) -> ReactiveProgram:
        """The loaded program."""
        return ReactiveProgram(self.sources)

    def world(self) -> World:
        """Return a world in which all goals are open."""
        world = self.new_world()
        for number, goal in enumerate(self.goals, 1):
            world.ask(number, goal)
        return world


def sources_of(name: str, facts: Iterable[str]) -> List[Source]:
    """Return the program of domain ``name`` with the facts of an instance."""
    return [Source.from_file(FOLDER / f"{name}.lp"), instance(facts)]


def instance(facts: Iterable[str]) -> Source:
    """Return the program that consists of ``facts``."""
    return Source("instance.lp", "#program base.\n" + "".join(f"{fact}.\n" for fact in facts))


def check(world: World, plan: Sequence[Step]) -> None:
    """Raise RuleError unless ``plan`` meets all goals of ``world``; ``world`` is not changed."""
    end = world.copy()
    for step in plan:
        if step:
            end.do(step)
    require(end.at_rest, "the plan does not meet all goals")


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
