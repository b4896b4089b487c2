"""Programs that nobody has tuned for the solver, each with tasks at random and its rules in plain Python."""

import random
from pathlib import Path
from typing import Callable, Dict, List, NamedTuple, Sequence, Set, Tuple

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.oclingo.program.sources import Source

FOLDER = Path(__file__).resolve().parents[1] / "data" / "untuned"

#: An interface and its parameter.
Deed = Tuple[str, str]


class RuleError(Exception):
    """An action is against the rules."""


def require(condition: bool, why: str) -> None:
    """Raise RuleError unless ``condition`` holds."""
    if not condition:
        raise RuleError(why)


class World:
    """What the actions of a plan change; ``met`` are the goals that they have met."""

    def __init__(self) -> None:
        self.open: Dict[int, Tuple[str, ...]] = {}

    def ask(self, number: int, *goal: str) -> None:
        """Add goal ``number``."""
        self.open[number] = goal

    def cancel(self, number: int) -> None:
        """Take goal ``number`` back."""
        self.open.pop(number, None)

    def do(self, interface: str, parameter: str) -> None:
        """Do an action; raises RuleError."""
        act: Callable[[str], None] = getattr(self, f"do_{interface}", None) or self.unknown
        act(parameter)

    @staticmethod
    def unknown(parameter: str) -> None:
        """Refuse an action that there is not."""
        raise RuleError(f"there is no such action on {parameter}")

    @property
    def at_rest(self) -> bool:
        """Whether nothing is left to do."""
        raise NotImplementedError


class Task(NamedTuple):
    """A program with an instance of its domain.

    Attributes:
        program: the program.
        goals: goal terms, of which the last argument is the number from 1 on.
        world: makes a world in which nothing was done or asked for.

    """

    program: ReactiveProgram
    goals: Sequence[str]
    world: Callable[[], World]

    def ask(self, world: World, number: int) -> None:
        """Tell ``world`` of goal ``number``."""
        name, arguments = self.goals[number - 1][:-1].split("(")
        world.ask(number, name, *arguments.split(",")[:-1])


def _program(name: str, facts: Sequence[str]) -> ReactiveProgram:
    text = "#program base.\n" + "\n".join(f"{fact}." for fact in facts) + "\n"
    return ReactiveProgram([Source.from_file(FOLDER / f"{name}.lp"), Source("instance", text)])


# ---- A robot that disinfects rooms -----------------------------------------------------------------------------------


class Disinfection(World):
    """The robot, its battery, the doors and the rooms."""

    FULL = 20

    def __init__(self, ways: Sequence[Deed], doors: Sequence[Deed]) -> None:
        super().__init__()
        self._near = dict.fromkeys(ways)
        self._near.update({(a, b): f"d({a},{b})" for a, b in doors})
        self._near.update({(b, a): door for (a, b), door in list(self._near.items())})
        self.place, self.battery, self.shut = "home", self.FULL, {f"d({a},{b})" for a, b in doors}

    def _use(self) -> None:
        require(self.battery > 0, "the battery is empty")
        self.battery -= 1

    def do_move_base(self, room: str) -> None:
        """Drive to a room beside."""
        require((self.place, room) in self._near, f"{room} is not near {self.place}")
        require(self._near[self.place, room] not in self.shut, f"the door to {room} is shut")
        self._use()
        self.place = room

    def _door(self, door: str) -> None:
        require(self.place in door[2:-1].split(","), f"{door} is not at {self.place}")

    def do_open(self, door: str) -> None:
        """Open a door here."""
        self._door(door)
        require(door in self.shut, f"{door} is open")
        self.shut.remove(door)

    def do_shut(self, door: str) -> None:
        """Shut a door here."""
        self._door(door)
        require(door not in self.shut, f"{door} is shut")
        self.shut.add(door)

    def do_disinfect(self, room: str) -> None:
        """Disinfect the room where the robot is, which meets all goals for it."""
        require(room == self.place, f"the robot is not in {room}")
        urgent = {number for number, goal in self.open.items() if goal[2] == "urgent"}
        here = {number for number, goal in self.open.items() if goal[1] == room}
        require(bool(here), f"nobody wants {room}")
        require(not urgent or bool(here & urgent), f"{room} is not urgent, others are")
        self._use()
        for number in here:
            del self.open[number]

    def do_charge(self, place: str) -> None:
        """Charge at home."""
        require(place == self.place == "home", "one charges at home")
        self.battery = self.FULL

    @property
    def at_rest(self) -> bool:
        """Whether all is clean, and the robot at home."""
        return not self.open and self.place == "home"


def disinfection(rooms: int, goals: int, seed: int = 1) -> Task:
    """Rooms on both sides of a corridor, every third behind a door, some joined; and goals for some of them."""
    source = random.Random(1000 * seed + 10 * rooms + goals)
    halls = -(-rooms // 3)
    ways: List[Deed] = [("home", "h1"), *((f"h{one}", f"h{one + 1}") for one in range(1, halls))]
    doors: List[Deed] = []
    for room in range(1, rooms + 1):
        (doors if room % 3 == 2 else ways).append((f"h{-(-room // 3)}", f"r{room}"))
        if room % 3 == 0 and room < rooms:
            doors.append((f"r{room}", f"r{room + 1}"))
    chosen = source.sample(range(1, rooms + 1), goals)
    urgent = set(chosen[: goals // 3])
    terms = [
        f"disinfect(r{room},{'urgent' if room in urgent else 'normal'},{number})"
        for number, room in enumerate(chosen, 1)
    ]
    facts = [f"way({a},{b})" for a, b in ways] + [f"door({a},{b})" for a, b in doors]
    return Task(_program("disinfection", facts), terms, lambda: Disinfection(ways, doors))


# ---- A floor with keys and doors -------------------------------------------------------------------------------------


class Keys(World):
    """The robot, what it holds, where things lie, and which locks are shut."""

    def __init__(self, ways: Sequence[Deed], locks: Dict[Deed, str], lies: Dict[str, str]) -> None:
        super().__init__()
        self._near = {**dict.fromkeys(ways, ""), **locks}
        self._near.update({(b, a): key for (a, b), key in list(self._near.items())})
        self.place, self.lies, self.held = "start", dict(lies), set()  # type: str, Dict[str, str], Set[str]
        self.closed = set(locks.values())

    def do_go(self, room: str) -> None:
        """Go to a room beside."""
        require((self.place, room) in self._near, f"{room} is not near {self.place}")
        require(self._near[self.place, room] not in self.closed, f"the way to {room} is locked")
        self.place = room

    def do_take(self, thing: str) -> None:
        """Take a thing that lies here."""
        require(self.lies.get(thing) == self.place, f"{thing} is not in {self.place}")
        require(len(self.held) < 2, "both hands are full")
        del self.lies[thing]
        self.held.add(thing)

    def do_put(self, thing: str) -> None:
        """Put a thing down here."""
        require(thing in self.held, f"{thing} is not held")
        self.held.remove(thing)
        self.lies[thing] = self.place
        if self.place == "start":
            self.open = {number: goal for number, goal in self.open.items() if goal[1] != thing}

    def do_unlock(self, key: str) -> None:
        """Unlock the door of a key that is held."""
        here = any(self.place in way and lock == key for way, lock in self._near.items())
        require(key in self.held and key in self.closed and here, f"{key} opens nothing here")
        self.closed.remove(key)

    @property
    def at_rest(self) -> bool:
        """Whether all was fetched."""
        return not self.open


def keys(rooms: int, goals: int, seed: int = 1) -> Task:
    """Rooms in a random tree, every other one locked; the key lies in a room with a lower number, as things do."""
    source = random.Random(1000 * seed + 10 * rooms + goals)
    names = ["start", *(f"r{room}" for room in range(1, rooms + 1))]
    ways: List[Deed] = []
    locks: Dict[Deed, str] = {}
    lies: Dict[str, str] = {}
    for room in range(1, rooms + 1):
        way = (names[source.randrange(max(0, room - 3), room)], names[room])
        if room % 2 == 0:
            locks[way] = f"k{room}"
            lies[f"k{room}"] = names[source.randrange(0, room)]
        else:
            ways.append(way)
    for number in range(1, goals + 1):
        lies[f"t{number}"] = names[source.randrange(1, rooms + 1)]
    facts = [f"way({a},{b})" for a, b in ways] + [f"lock({a},{b},{key})" for (a, b), key in locks.items()]
    facts += [f"lies({thing},{room})" for thing, room in lies.items()]
    terms = [f"fetch(t{number},{number})" for number in range(1, goals + 1)]
    return Task(_program("keys", facts), terms, lambda: Keys(ways, locks, lies))


# ---- An elevator -----------------------------------------------------------------------------------------------------


class Elevator(World):
    """The cabin, its doors, and who rides in it."""

    def __init__(self, floors: int) -> None:
        super().__init__()
        self._floors, self.floor, self.doors = floors, 1, "shut"
        self.rides: Dict[int, str] = {}

    def cancel(self, number: int) -> None:
        """Take a goal back; who rides goes on."""
        if number not in self.rides:
            super().cancel(number)

    def do_lift(self, floor: str) -> None:
        """Go one floor up or down."""
        require(self.doors == "shut", "the doors are open")
        require(abs(int(floor) - self.floor) == 1 and 1 <= int(floor) <= self._floors, f"{floor} is not next")
        self.floor = int(floor)

    def do_doors(self, how: str) -> None:
        """Open or shut the doors."""
        require(how != self.doors, f"the doors are {how}")
        self.doors = how

    def do_board(self, number: str) -> None:
        """Let somebody in."""
        goal = self.open.get(int(number))
        require(goal is not None and int(number) not in self.rides, f"{number} does not wait")
        require(goal is not None and int(goal[1]) == self.floor and self.doors == "open", f"{number} can't board here")
        require(len(self.rides) < 2, "the cabin is full")
        self.rides[int(number)] = goal[2] if goal else ""

    def do_leave(self, number: str) -> None:
        """Let somebody out where he wants to go."""
        require(int(number) in self.rides and self.doors == "open", f"{number} can't leave")
        require(int(self.rides[int(number)]) == self.floor, f"{number} is not there yet")
        del self.rides[int(number)]
        del self.open[int(number)]

    @property
    def at_rest(self) -> bool:
        """Whether nobody waits or rides, and the doors are shut."""
        return not self.open and self.doors == "shut"


def elevator(floors: int, goals: int, seed: int = 1) -> Task:
    """People who want to go from one floor to another."""
    source = random.Random(1000 * seed + 10 * floors + goals)
    rides = [source.sample(range(1, floors + 1), 2) for _ in range(goals)]
    terms = [f"bring({start},{end},{number})" for number, (start, end) in enumerate(rides, 1)]
    return Task(_program("elevator", [f"floor(1..{floors})"]), terms, lambda: Elevator(floors))


def superfluous(world: World, deeds: Sequence[Deed]) -> Set[int]:
    """Return the places of actions that could be left out: without one, and those that it made possible, it is a plan.

    ``world`` is as before the first of ``deeds``; it is not changed. Raises RuleError where they are no plan at all.
    """
    import copy

    def leads_to_rest(left: Sequence[Deed], skipping: bool) -> bool:
        there = copy.deepcopy(world)
        for deed in left:
            try:
                there.do(*deed)
            except RuleError:
                if not skipping:
                    raise
        return there.at_rest

    require(leads_to_rest(deeds, skipping=False), "the plan does not meet all goals")
    return {place for place in range(len(deeds)) if leads_to_rest([*deeds[:place], *deeds[place + 1 :]], skipping=True)}
