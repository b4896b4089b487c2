"""Random tasks of the planning domains; the same arguments make the same task."""

import random
import re
from itertools import chain
from typing import Callable, Dict, Iterable, List, NamedTuple, Sequence, Tuple

from planning_domains.task import FOLDER, Action, Task, World, goal
from rosoclingo.oclingo.program.sources import Source

Edge = Tuple[str, str]


class Domain(NamedTuple):
    """A domain: a function that makes tasks, and its arguments for three sizes, without the seed."""

    make: Callable[..., Task]
    sizes: Dict[str, Tuple[int, ...]]


def sources_of(name: str, facts: Iterable[str]) -> List[Source]:
    """Return the program of a domain with the facts of an instance."""
    return [Source.from_file(FOLDER / f"{name}.lp"), instance(facts)]


def instance(facts: Iterable[str]) -> Source:
    """Return the program that consists of ``facts``."""
    return Source("instance.lp", "#program base.\n" + "".join(f"{fact}.\n" for fact in facts))


def numbered(word: str, count: int) -> List[str]:
    """Return names such as ``b1``, ``b2``."""
    return [f"{word}{number}" for number in range(1, count + 1)]


def both(edges: Iterable[Edge]) -> List[Edge]:
    """Return the edges in both directions."""
    return [pair for a, b in edges for pair in ((a, b), (b, a))]


# ---- Arrangements of things ------------------------------------------------------------------------------------------


def towers(blocks: Sequence[str], source: random.Random) -> Dict[str, str]:
    """Return random towers as block -> block or table below it."""
    order = source.sample(blocks, len(blocks))
    return {
        block: order[number - 1] if number and source.random() < 0.6 else "table" for number, block in enumerate(order)
    }


def blocks(count: int, seed: int = 1) -> Task:
    """Return a task of blocks world: a robot arm rearranges random towers of ``count`` blocks."""
    source, names = random.Random(1000 * seed + count), numbered("b", count)
    first, last = towers(names, source), towers(names, source)

    def lies(block: str, below: str) -> str:
        return f"on-table {block}" if below == "table" else f"on {block} {below}"

    ends = enumerate(sorted(last.items()), 1)
    goals = [goal(f"on({one},{at},{number})", [lies(one, at)]) for number, (one, at) in ends]
    init = ["free", *(lies(*one) for one in first.items())]
    init += [f"clear {one}" for one in names if one not in first.values()]
    actions = {"pick": "pick {0}", "pick-from-table": "pick {0}", "put": "put {1}", "put-on-table": "put table"}
    sources = sources_of("blocks", (f"lies({one},{at})" for one, at in first.items()))
    return Task("blocks", sources, goals, {"block": names}, init, actions, together=True)


def gripper(rooms: int, balls: int, seed: int = 1) -> Task:
    """Return a task of gripper: a robot with two arms takes balls from the hall to other rooms."""
    source = random.Random(1000 * seed + 100 * rooms + balls)
    places, names = ["hall", *numbered("room", rooms - 1)], numbered("ball", balls)
    ends = enumerate([(ball, source.choice(places[1:])) for ball in names], 1)
    goals = [goal(f"bring({ball},{room},{number})", [f"in {ball} {room}"]) for number, (ball, room) in ends]
    facts = [*(f"room({room})" for room in places), *(f"lies({ball},hall)" for ball in names)]
    objects = {"room": places, "ball": names, "arm": ["left", "right"]}
    init = ["at hall", "free left", "free right", *(f"in {ball} hall" for ball in names)]
    actions = {"go": "go {1}", "take": "{0} take({1})", "put": "{0} put({1})"}
    return Task("gripper", sources_of("gripper", facts), goals, objects, init, actions, together=True)


def hanoi(disks: int, seed: int = 1) -> Task:
    """Return a task of the towers of Hanoi, with disks on random pegs; the largest one has to move."""
    source, numbers = random.Random(1000 * seed + disks), range(1, disks + 1)
    first, last = ({disk: source.choice("abc") for disk in numbers} for _ in range(2))
    last[disks] = source.choice([peg for peg in "abc" if peg != first[disks]])

    def chains(pegs: Dict[int, str]) -> List[List[str]]:
        """Return each peg with its disks, the largest first."""
        return [[peg, *(f"d{disk}" for disk in reversed(numbers) if pegs[disk] == peg)] for peg in "abc"]

    def on(pegs: Dict[int, str]) -> List[str]:
        return [f"on {upper} {lower}" for one in chains(pegs) for lower, upper in zip(one, one[1:])]

    facts = [f"disk(1..{disks})", *(f"lies({disk},{peg})" for disk, peg in first.items())]
    facts += [f"target({disk},{peg})" for disk, peg in last.items()]
    init = [*on(first), *(f"clear {one[-1]}" for one in chains(first)), *(f"peg {peg}" for peg in "abc")]
    init += [f"in {thing} {one[0]}" for one in chains(first) for thing in one]
    init += [f"smaller d{disk} d{other}" for disk in numbers for other in range(disk + 1, disks + 1)]
    init += [f"smaller d{disk} {peg}" for disk in numbers for peg in "abc"]
    terms = {f"d{disk}": str(disk) for disk in numbers}
    objects = {"object": [*"abc", *terms]}
    goals = [goal("solve(1)", on(last))]
    actions = {"move": "arm move({0},{4})"}
    return Task("hanoi", sources_of("hanoi", facts), goals, objects, init, actions, terms, together=True)


def tiles(columns: int, rows: int, moves: int, seed: int = 1) -> Task:
    """Return a sliding puzzle whose start is ``moves`` random moves from its goal."""
    source = random.Random(1000 * seed + 10 * columns + rows)
    cells = [f"c{column}{row}" for row in range(rows) for column in range(columns)]
    near = {(a, b) for a in cells for b in cells if abs(int(a[1]) - int(b[1])) + abs(int(a[2]) - int(b[2])) == 1}
    last = {f"t{number}": cell for number, cell in enumerate(cells[1:], 1)}
    first, free, before = dict(last), cells[0], ""
    for _ in range(moves):  # no move undoes the previous one
        before = source.choice(sorted(tile for tile, cell in first.items() if (cell, free) in near and tile != before))
        first[before], free = free, first[before]
    facts = [*(f"near({a},{b})" for a, b in sorted(near)), *(f"lies({tile},{cell})" for tile, cell in first.items())]
    facts += [f"target({tile},{cell})" for tile, cell in last.items()]
    init = [f"free {free}", *(f"near {a} {b}" for a, b in sorted(near)), *(f"at {t} {c}" for t, c in first.items())]
    goals = [goal("solve(1)", [f"at {tile} {cell}" for tile, cell in last.items()])]
    objects = {"cell": cells, "tile": last}
    return Task("tiles", sources_of("tiles", facts), goals, objects, init, {"slide": "slide {2}"}, together=True)


def crates(rooms: int, crates: int, inspections: int, seed: int = 1) -> Task:
    """Return a task for two robots on a random tree of rooms; they lift, carry and drop crates together."""
    source = random.Random(1000 * seed + 100 * rooms + 10 * crates + inspections)
    names = ["dock", *numbered("r", rooms - 1)]
    ways = [(names[source.randrange(max(0, number - 3), number)], names[number]) for number in range(1, rooms)]
    moves = [source.sample(names, 2) for _ in range(crates)]
    goals = [goal(f"bring(c{one},{end},{one})", [f"in c{one} {end}"]) for one, (_, end) in enumerate(moves, 1)]
    for number, room in enumerate(source.sample(names, inspections), crates + 1):
        goals.append(goal(f"inspect({room},{number})", [f"seen {room}"], [f"unseen {room}"]))
    lies = {f"c{number}": start for number, (start, _) in enumerate(moves, 1)}
    facts = [f"way({a},{b})" for a, b in ways] + [f"lies({crate},{room})" for crate, room in lies.items()]
    init = ["empty", "at anna dock", "at otto dock", *(f"way {a} {b}" for a, b in both(ways))]
    init += [f"in {crate} {room}" for crate, room in lies.items()]
    actions = {
        "go": "{0} go({2})",
        "inspect": "{0} inspect({1})",
        "lift": "anna lift({1}) otto lift({1})",
        "carry": "anna go({1}) otto go({1})",
        "drop": "anna drop({1}) otto drop({1})",
    }
    objects = {"room": names, "crate": lies, "robot": ["anna", "otto"]}
    sources = sources_of("crates", facts)
    return Task("crates", sources, goals, objects, init, actions, together=True, robots=2)


# ---- Errands ---------------------------------------------------------------------------------------------------------


def elevator(floors: int, people: int, seed: int = 1) -> Task:
    """Return a task of people who want to go to other floors, with a cabin for two."""
    source = random.Random(1000 * seed + 10 * floors + people)
    rides = dict(enumerate((source.sample(range(1, floors + 1), 2) for _ in range(people)), 1))
    goals = [
        goal(f"bring({start},{end},{number})", [f"arrived p{number}"], [f"waits p{number} f{start}"])
        for number, (start, end) in rides.items()
    ]
    init = ["at f1", "closed", "free left", "free right"]
    init += [f"next f{f} f{g}" for f in range(1, floors + 1) for g in (f - 1, f + 1) if 1 <= g <= floors]
    init += [f"wants p{number} f{end}" for number, (_, end) in rides.items()]
    objects = {"floor": numbered("f", floors), "person": numbered("p", people), "room": ["left", "right"]}
    terms = {name: name[1:] for name in (*objects["floor"], *objects["person"])}
    actions = {"lift": "lift {1}", "doors-open": "doors open", "doors-shut": "doors shut"}
    actions.update(board="board {0}", leave="leave {0}")
    sources = sources_of("elevator", [f"floor(1..{floors})"])
    return Task("elevator", sources, goals, objects, init, actions, terms, final=["closed"])


def keys(rooms: int, things: int, seed: int = 1) -> Task:
    """Return a task of fetching things from a random tree of rooms, half of them locked, with two hands.

    Each key lies in a room with a lower number than the one that it unlocks.
    """
    source = random.Random(1000 * seed + 10 * rooms + things)
    names = ["start", *numbered("r", rooms)]
    ways: List[Edge] = []
    locks: Dict[str, Edge] = {}
    lies: Dict[str, str] = {}
    for room in range(1, rooms + 1):
        way = (names[source.randrange(max(0, room - 3), room)], names[room])
        if room % 2 == 0:
            locks[f"k{room}"] = way
            lies[f"k{room}"] = names[source.randrange(0, room)]
        else:
            ways.append(way)
    wanted = numbered("t", things)
    lies.update((thing, names[source.randrange(1, rooms + 1)]) for thing in wanted)
    facts = [f"way({a},{b})" for a, b in ways] + [f"lock({a},{b},{key})" for key, (a, b) in locks.items()]
    facts += [f"lies({thing},{room})" for thing, room in lies.items()]
    init = ["at start", "free left", "free right", *(f"in {thing} {room}" for thing, room in lies.items())]
    init += [f"way {a} {b}" for a, b in both(ways)]
    for key, way in locks.items():
        init += [f"closed {key}", *(f"adjacent {key} {room}" for room in way)]
        init += [f"lock {a} {b} {key}" for a, b in both([way])]
    actions = {"go": "go {1}", "go-through": "go {1}", "take": "take {0}", "put": "put {0}", "unlock": "unlock {0}"}
    goals = [goal(f"fetch({thing},{number})", [f"in {thing} start"]) for number, thing in enumerate(wanted, 1)]
    objects = {"room": names, "thing": lies, "hand": ["left", "right"]}
    return Task("keys", sources_of("keys", facts), goals, objects, init, actions)


class Disinfection(World):
    """A world whose atom ``left`` counts the urgent rooms."""

    def ask(self, number: int) -> None:
        super().ask(number)
        self._count()

    def cancel(self, number: int) -> None:
        super().cancel(number)
        self._count()

    def _count(self) -> None:
        urgent = sum(atom[0] == "urgent" for atom in self.state)
        self.state = {atom for atom in self.state if atom[0] != "left"} | {("left", f"c{urgent}")}


def disinfection(rooms: int, goals: int, seed: int = 1, full: int = 20) -> Task:
    """Return a task for a robot with a battery on a corridor with rooms on both sides; urgent rooms come first.

    Every third room is behind a door, and some rooms are joined.
    """
    source, halls = random.Random(1000 * seed + 10 * rooms + goals), -(-rooms // 3)
    ways = [("home", "h1"), *((f"h{one}", f"h{one + 1}") for one in range(1, halls))]
    doors: List[Edge] = []
    for room in range(1, rooms + 1):
        (doors if room % 3 == 2 else ways).append((f"h{-(-room // 3)}", f"r{room}"))
        if room % 3 == 0 and room < rooms:
            doors.append((f"r{room}", f"r{room + 1}"))
    chosen = [f"r{room}" for room in source.sample(range(1, rooms + 1), goals)]
    kinds = {room: "urgent" if number < goals // 3 else "normal" for number, room in enumerate(chosen)}
    asked = [
        goal(f"disinfect({room},{kind},{number})", [f"clean {room}"], [f"{kind} {room}"])
        for number, (room, kind) in enumerate(kinds.items(), 1)
    ]
    facts = [f"way({a},{b})" for a, b in ways] + [f"door({a},{b})" for a, b in doors]
    init = ["at home", "charge-at home", f"battery l{full}", f"full l{full}", f"left c{goals // 3}", "none c0"]
    init += [f"way {a} {b}" for a, b in both(ways)]
    init += [f"less l{level} l{level + 1}" for level in range(full)]
    init += [f"fewer c{count} c{count + 1}" for count in range(goals // 3)]
    for a, b in doors:
        door = f"door_{a}_{b}"
        init += [f"shut {door}", *(f"adjacent {door} {room}" for room in (a, b))]
        init += [f"door {one} {other} {door}" for one, other in both([(a, b)])]
    terms = {f"door_{a}_{b}": f"d({a},{b})" for a, b in doors}
    objects = {"room": sorted({*chain(*ways, *doors)}), "door": terms}
    objects.update(level=[f"l{one}" for one in range(full + 1)], count=[f"c{one}" for one in range(goals // 3 + 1)])
    actions = {"disinfect": "disinfect {0}", "disinfect-urgent": "disinfect {0}", "charge": "charge {0}"}
    for operator in ("move_base", "move_base-through", "open", "shut"):
        actions[operator] = f"{operator.split('-')[0]} {{1}}"
    sources = sources_of("disinfection", facts)
    more = {"final": ["at home"], "world_type": Disinfection}
    return Task("disinfection", sources, asked, objects, init, actions, terms, **more)


class Garden(World):
    """A world in which failures abort goals, like the tutorial's program."""

    def fail(self, action: Action) -> None:
        """Let an action fail: the program aborts the goal for the plant, or all goals if there is no water."""
        interface, parameter = action
        for number, one in list(self.open.items()):
            if interface == "fill" or one.term == f"water({parameter})":
                self.cancel(number)

    def can_fail(self, action: Action) -> bool:
        """Return whether ``action`` is not a drive; the program does not repeat a drive that failed."""
        return action[0] != "move_base"


def garden(plants: int, seed: int = 1, full: int = 2) -> Task:
    """Return a task for the gardener of doc/tutorial.md, whose program is the first one on that page."""
    names = ["fern", "palm", "cactus", *(f"plant{number}" for number in range(4, plants + 1))][:plants]
    thirsty = random.Random(1000 * seed + plants).sample(names, plants)
    text = (FOLDER.parents[1] / "doc" / "tutorial.md").read_text(encoding="utf-8")
    program = re.findall(r"```prolog\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)[0]
    goals = [goal(f"water({plant})", [f"watered {plant}"], [f"thirsty {plant}"]) for plant in thirsty]
    objects = {"place": ["home", "tap", *names], "level": [f"l{level}" for level in range(full + 1)]}
    init = ["at home", "tap tap", "can l0", f"full l{full}", *(f"less l{one} l{one + 1}" for one in range(full))]
    actions = {"move_base": "move_base {1}", "fill": "fill can", "water": "water {0}"}
    sources = [Source("garden.lp", program), instance(f"plant({plant})" for plant in names)]
    return Task("garden", sources, goals, objects, init, actions, world_type=Garden)


DOMAINS = {
    "blocks": Domain(blocks, {"small": (6,), "middle": (12,), "large": (20,)}),
    "gripper": Domain(gripper, {"small": (2, 4), "middle": (3, 8), "large": (4, 16)}),
    "elevator": Domain(elevator, {"small": (6, 4), "middle": (10, 7), "large": (15, 12)}),
    "hanoi": Domain(hanoi, {"small": (4,), "middle": (5,), "large": (6,)}),
    "tiles": Domain(tiles, {"small": (3, 3, 20), "middle": (4, 3, 40), "large": (4, 4, 60)}),
    "keys": Domain(keys, {"small": (6, 3), "middle": (12, 5), "large": (20, 8)}),
    "disinfection": Domain(disinfection, {"small": (10, 5), "middle": (20, 6), "large": (20, 10)}),
    "garden": Domain(garden, {"small": (3,), "middle": (8,), "large": (16,)}),
    "crates": Domain(crates, {"small": (5, 1, 3), "middle": (8, 2, 5), "large": (12, 3, 8)}),
}
"""The domains, with the arguments of `Domain.make`: numbers of rooms, things, people, moves or goals."""
