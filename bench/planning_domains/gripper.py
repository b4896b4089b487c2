"""Gripper: a robot with two arms takes balls to other rooms."""

import random
from typing import Dict, List, Sequence

from pddl import Action, task_of

from planning_domains.task import FOLDER, Arrangement, Task, require, sources_of

#: Rooms and balls.
SIZES = {"small": (2, 4), "middle": (3, 8), "large": (4, 16)}

ARMS = ("left", "right")


class Gripper(Arrangement):
    """The robot, the balls in its arms, and the places of all balls."""

    def __init__(self, rooms: Sequence[str], places: Dict[str, str]) -> None:
        super().__init__(places)
        self._rooms, self.room, self.held = rooms, rooms[0], dict.fromkeys(ARMS, "")

    def do_go(self, room: str) -> None:
        """Drive to another room."""
        require(room in self._rooms and room != self.room, f"the robot cannot go to {room}")
        self.room = room

    def _use(self, arm: str, parameter: str) -> None:
        what, ball = parameter[:-1].split("(")
        if what == "take":
            require(not self.held[arm], f"the {arm} arm holds a ball")
            require(self.places.get(ball) == self.room, f"{ball} is not here")
            self.held[arm] = ball
            del self.places[ball]
        else:
            require(what == "put" and self.held[arm] == ball, f"the {arm} arm does not hold {ball}")
            self.held[arm], self.places[ball] = "", self.room

    def do_left(self, parameter: str) -> None:
        """Take a ball or put it down with the left arm."""
        self._use("left", parameter)

    def do_right(self, parameter: str) -> None:
        """Take a ball or put it down with the right arm."""
        self._use("right", parameter)


def make(rooms: int, balls: int, seed: int = 1) -> Task:
    """Return a task of moving balls from the hall to the other rooms."""
    source = random.Random(1000 * seed + 100 * rooms + balls)
    places = ["hall", *(f"room{number}" for number in range(1, rooms))]
    names = [f"ball{number}" for number in range(1, balls + 1)]
    ends = {ball: source.choice(places[1:]) for ball in names}
    goals = [f"bring({ball},{room},{number})" for number, (ball, room) in enumerate(ends.items(), 1)]
    init = ["at hall", *(f"in {ball} hall" for ball in names), *(f"free {arm}" for arm in ARMS)]
    problem = task_of(
        FOLDER / "gripper.pddl",
        {"room": places, "ball": names, "arm": ARMS},
        init,
        [f"in {ball} {room}" for ball, room in ends.items()],
        _actions_of,
    )
    facts = [*(f"room({room})" for room in places), *(f"lies({ball},hall)" for ball in names)]
    return Task(sources_of("gripper", facts), goals, lambda: Gripper(places, dict.fromkeys(names, "hall")), problem)


def _actions_of(plan: Sequence[Sequence[str]]) -> List[Action]:
    return [("go", one[2]) if one[0] == "go" else (one[1], f"{one[0]}({one[2]})") for one in plan]
