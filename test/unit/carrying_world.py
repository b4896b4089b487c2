"""A simulated world in which a robot carries things, with late, repeated and false messages.

It plays the interfaces and the clients of a core, knows nothing of encodings except the words of their facts, and
judges each action and the end of each goal. Beliefs of a robot are not modelled exactly: a goal can be aborted only
if some reported fact can be the reason.
"""

import re
from dataclasses import dataclass, field
from random import Random
from typing import Callable, Dict, FrozenSet, List, Optional, Protocol, Set, Tuple

ROBOT, CAPACITY, TRIES, MEMORY = "robot", 3, 3, 6
BLOCKED, MISSING = ("blocked", "unreachable"), ("not_here", "unknown_package", "not_carried")
PLAIN = ("failed", "timeout", "server_lost", "stuck(door,1)", '"no idea"', "77")
DONE = ("succeeded", "canceled", "aborted", "rejected")
Way = FrozenSet[str]


class Port(Protocol):
    """The core, as the world sees it."""

    def send(self, key: str, text: str) -> None:
        """Send a goal."""

    def cancel(self, key: str) -> None:
        """Cancel a goal."""

    def tell(self, facts: List[str]) -> None:
        """Send facts as an interface."""


@dataclass(frozen=True)
class Domain:
    """Places and ways, positions of things, and the form of a request."""

    ways: Tuple[Tuple[str, str], ...]
    start: str
    things: Dict[str, str]
    ask: Callable[[str, str, str], str]  # thing, its place, destination -> goal
    sightings: bool

    @property
    def places(self) -> List[str]:
        """Return all places."""
        return sorted({place for way in self.ways for place in way})


OFFICE = Domain(
    (("office1", "office2"), ("office2", "office3"), ("office3", "office4")),
    "office1",
    {str(number): f"office{number % 4 + 1}" for number in range(1, 9)},
    lambda thing, origin, to: f"goal({origin},{to},{thing})",
    sightings=False,
)
HOUSE = Domain(
    (
        ("hallway", "kitchen"),
        ("hallway", "living_room"),
        ("kitchen", "living_room"),
        ("hallway", "bathroom"),
        ("hallway", "study"),
        ("hallway", "bedroom"),
        ("study", "bedroom"),
    ),
    "hallway",
    {"cup": "kitchen", "tray": "kitchen", "book": "study", "newspaper": "living_room", "towel": "bathroom"},
    lambda thing, origin, to: f"bring({to},{thing})",
    sightings=True,
)


@dataclass
class Thing:
    """The place of a thing, the place where the robot picked it up, and the reports about it."""

    place: str
    origin: str = ""
    slips: int = 0  # failures in a row
    missed: bool = False  # it was reported missing, and nobody has seen it since


@dataclass
class Wish:
    """A goal and its course.

    ``heard`` says that the core has it, ``known`` that the core had it before it chose the next action.
    """

    key: str
    text: str
    thing: str
    to: str
    home: str
    bad: bool = False
    cancelled: bool = False
    missed: bool = False
    slipped: bool = False
    heard: bool = False
    known: bool = False


@dataclass
class Rumours:
    """Reports that can keep the robot away from a place."""

    closed: List[List[object]] = field(default_factory=list)  # way, cycle, returns until it is forgotten
    misses: Dict[Way, int] = field(default_factory=dict)
    unknown: Set[str] = field(default_factory=set)
    takes: int = 0

    def close(self, way: Way, cycle: int) -> None:
        """Note that a way was reported closed in a cycle, perhaps a future one."""
        self.closed.append([way, cycle, MEMORY + 2])

    def returned(self, cycle: int) -> None:
        """Note that an action has returned."""
        for one in self.closed:
            one[2] -= cycle > one[1]  # type: ignore[operator]
        self.closed = [one for one in self.closed if one[2] > 0]  # type: ignore[operator]

    def shut(self) -> Set[Way]:
        """Return all ways that are barred."""
        return {one[0] for one in self.closed} | {  # type: ignore[misc]
            way for way, times in self.misses.items() if times >= TRIES
        }


class Play:
    """Plays until ``goals`` have ended. ``faults`` is empty while everything is right; ``ends`` counts ends."""

    def __init__(self, domain: Domain, port: Port, draw: Random, goals: int) -> None:
        self.domain, self._port, self._draw, self._left = domain, port, draw, goals
        self.robot, self.astray, self.cycle = domain.start, False, 1
        self.things = {name: Thing(place) for name, place in domain.things.items()}
        self.live: Dict[str, Wish] = {}
        self.ends: Dict[str, int] = dict.fromkeys(DONE, 0)
        self.faults: List[str] = []
        self.log: List[str] = []
        self.calm = False
        self._acting = False  # an action is under way: the core is in its cycle
        self._answers: List[str] = []  # the latest returns, all of which the core has accepted
        self._together = False  # the ended goal conflicted with others
        self._number = 0
        self._rumours = Rumours()
        self._put_back: Dict[str, str] = {}  # goals whose end must be on its way, otherwise this is wrong

    # ---- clients and sensors ------------------------------------------------------------------------------------

    @property
    def over(self) -> bool:
        """Return whether all goals have ended."""
        return not self._left and not self.live

    @property
    def story(self) -> str:
        """Return the events before the first fault, or the latest ones."""
        first = next((place for place, line in enumerate(self.log) if "FAULT" in line), len(self.log))
        return "\n".join(self.log[max(0, first - 50) : first + 10])

    def stir(self) -> None:
        """Draw an event, or none."""
        while self._left and len(self.live) < self._draw.choice([1, 1, 2, 3]):
            self.wish()
        if self.calm:
            return
        for wish in list(self.live.values()):
            if self._draw.random() < 0.04 and not wish.cancelled:
                wish.cancelled = True
                self._say(f"cancel {wish.text}")
                self._port.cancel(wish.key)
        if self._draw.random() < 0.2:
            self._tell(self._rumour())

    def wish(self, thing: Optional[str] = None) -> None:
        """Send a random request."""
        taken = {one.thing for one in self.live.values()}
        free = [name for name in self.things if name not in taken]
        if not free:
            return
        self._left, self._number = max(0, self._left - 1), self._number + 1
        name = thing or self._draw.choice(free)
        one, to = self.things[name], self._draw.choice(self.domain.places)
        home = one.origin if one.place == ROBOT else one.place
        bad = not self.calm and self._draw.random() < 0.08
        asked = self._draw.choice(["nowhere", "f(x)", f'"{to}"', "7"]) if bad else to
        one.slips = 0
        if one.missed and one.place != ROBOT and self.domain.sightings and self._draw.random() < 0.7:
            self._tell([f"_seen({name},{one.place},now)"])
        wish = Wish(f"g{self._number}", self.domain.ask(name, home, asked), name, to, home, bad)
        self.live[wish.key] = wish
        self._say(f"ask {wish.key} {wish.text}")
        self._port.send(wish.key, wish.text)

    def acknowledged(self, key: str) -> None:
        """Note that the core has the goal; earlier messages of the core can have crossed it."""
        if key in self.live:
            self.live[key].heard = True

    def _rumour(self) -> List[str]:
        """Return a fact that can be late, early, false or repeated."""
        when = self._draw.choice([self.cycle, self._draw.randint(1, self.cycle), self.cycle - 1, self.cycle + 3])
        when = max(1, when if self._draw.random() < 0.9 else self.cycle + self._draw.randint(1, 15))
        kind = self._draw.choice(["_blocked", "_blocked", "_opened", "nonsense", "_seen", "_seen"])
        a, b = self._draw.choice(self.domain.ways) if self._draw.random() < 0.9 else (self.robot, self.robot)
        fact = f"{kind}({a},{b},{when})" if kind in ("_blocked", "_opened") else "hello(there)"
        if kind == "_blocked":
            self._rumours.close(frozenset((a, b)), when)
        if kind == "_seen" and self.domain.sightings:
            name = self._draw.choice(sorted(self.things))
            place, reported = self.things[name].place, self._draw.choice(self.domain.places)
            reported = place if place != ROBOT and self._draw.random() < 0.7 else reported
            fact = f"_seen({name},{reported},{when})"
        elif kind == "nonsense":
            # the fact of a cycle that has begun by then would be the true one
            cycle = self.cycle + (self._draw.choice([-1, 1]) if self._acting else -1)
            fact = self._draw.choice(
                ["((", f"_return(move_base,{a},{cycle})", f"_action_lib(pickup,1,{cycle})", "_seen"]
            )
        return [fact] * self._draw.choice([1, 1, 2])

    # ---- the robot ----------------------------------------------------------------------------------------------

    def command(self, text: str) -> None:
        """Judge an action of the core, execute it or let it fail, and answer."""
        found = re.fullmatch(r"_action_lib\((\w+),(\w+),(\d+)\)", text)
        if found is None:
            self._fault(f"{text} is not an action")
            return
        interface, what, self.cycle = found[1], found[2], int(found[3])
        for key in [key for key in self._put_back if key in self.live]:
            self._fault(self._put_back[key])
        self._put_back.clear()
        self._say(text)
        reason = self._reason(interface, what)
        self._rumours.returned(self.cycle)
        getattr(self, "_" + interface)(what, reason)
        for wish in self.live.values():
            wish.known = wish.heard
        self._rumours.takes = 0 if reason is None else self._rumours.takes + (reason == "preempted")
        self._acting = True
        self.stir()
        self._acting = False
        self._answer(interface, what, what if reason is None else reason)

    def _answer(self, interface: str, what: str, value: str) -> None:
        """Send the end of an action, perhaps repeatedly, late or contradictory; only the first one counts."""
        again = 1.0 if self.calm else self._draw.random()
        if again < 0.05 and self._answers:
            self._tell([self._draw.choice(self._answers)])
        answer = f"_return({interface},{value},{self.cycle})"
        self._answers = [*self._answers[-4:], answer]
        other = f"_return({interface},{self._draw.choice(['failed', what])},{self.cycle})"
        self._tell([answer, other] if 0.05 < again < 0.1 else [answer])
        if 0.1 < again < 0.15:
            self._tell([other])

    def _reason(self, interface: str, what: str) -> Optional[str]:
        """Return why the action fails, None if it succeeds."""
        if interface == "pickup" and self.things[what].place != self.robot:
            return "not_here"
        if self.calm or self._draw.random() < 0.85:
            return None
        others = [one for one in (*self.domain.places, *self.things) if one != what]
        own = (*BLOCKED, "unknown_label") if interface == "move_base" else (*MISSING, "not_at_label", "full")
        return self._draw.choice([*PLAIN, *own, *own, "preempted", "preempted", self._draw.choice(others)])

    def _move_base(self, what: str, reason: Optional[str]) -> None:
        way = frozenset((self.robot, what))
        if not self.astray if len(way) == 1 else way not in map(frozenset, self.domain.ways):
            self._fault(f"no way leads from {self.robot} to {what}")
        if not self.live and not any(one.place == ROBOT for one in self.things.values()):
            self._fault(f"nobody wants it to drive to {what}")
        if reason is None:
            self.robot, self.astray = what, False
            self._rumours.misses.pop(way, None)
            self._rumours.unknown.discard(what)
        elif reason != "preempted":
            self._rumours.misses[way] = self._rumours.misses.get(way, 0) + 1
            if reason in BLOCKED:
                self._rumours.close(way, self.cycle)
            if reason == "unknown_label":
                self._rumours.unknown.add(what)

    def _pickup(self, what: str, reason: Optional[str]) -> None:
        thing, wish = self.things[what], self._wish_for(what)
        if wish is None:
            self._fault(f"nobody wants it to pick up {what}")
        if thing.place != self.robot and not self.domain.sightings:
            self._fault(f"{what} is at {thing.place}, not at {self.robot}")
        if self.astray or sum(one.place == ROBOT for one in self.things.values()) >= CAPACITY:
            self._fault(f"it cannot pick up {what}: astray {self.astray}, or full")
        if reason is None:
            thing.place, thing.origin, thing.slips, thing.missed = ROBOT, self.robot, 0, False
        else:
            self._fail(what, reason)

    def _deliver(self, what: str, reason: Optional[str]) -> None:
        thing, wish = self.things[what], self._wish_for(what)
        right = set() if wish is None else {wish.to}
        if wish is None or wish.cancelled or not wish.known:
            right.add(thing.origin)
        wrong = f"{what}, which is at {thing.place}, is to be put down at {self.robot}, but belongs to {right}"
        if thing.place != ROBOT or self.astray or self.robot not in {*right, thing.origin}:
            self._fault(wrong)
        elif wish is not None and self.robot not in right:  # an action and the end of a goal can overtake each other
            self._put_back[wish.key] = wrong
        if reason is None:
            thing.place, thing.slips, thing.missed = self.robot, 0, False
        else:
            self._fail(what, reason)

    def _fail(self, what: str, reason: str) -> None:
        thing, wish = self.things[what], self._wish_for(what)
        if reason in MISSING:  # either somebody has taken it away, or it was never there
            if thing.place in (self.robot, ROBOT):
                thing.place = self._draw.choice(self.domain.places)
            thing.missed, thing.slips = True, 0
            if wish is not None:
                wish.missed = True
        elif reason != "preempted":
            thing.slips += 1
            if wish is not None:
                wish.slipped |= thing.slips >= TRIES
        self.astray |= reason == "not_at_label"

    def _wish_for(self, what: str) -> Optional[Wish]:
        return next((wish for wish in self.live.values() if wish.thing == what), None)

    # ---- ends of goals ------------------------------------------------------------------------------------------

    def ended(self, key: str, status: str, message: str) -> None:
        """Judge the end of a goal."""
        wish = self.live.pop(key)
        wrong = self._put_back.pop(key, None)
        if wrong is not None and status != "aborted":
            self._fault(wrong)
        if status not in DONE:
            self._fault(f"{wish.text} ended as {status}: {message}")
            return
        self.ends[status] += 1
        self._say(f"{wish.text} {status}: {message}")
        self._together = "together with" in message
        undecided = status == "aborted" and "perhaps" in message  # there was no time for diagnosis
        if not undecided and not getattr(self, "_is_" + status)(wish, self.things[wish.thing]):
            self._fault(f"{wish.text} {status} is untrue: {message}")

    def _is_succeeded(self, wish: Wish, thing: Thing) -> bool:
        return thing.place == wish.to and not wish.bad

    def _is_canceled(self, wish: Wish, thing: Thing) -> bool:
        back = thing.place == wish.home or thing.place == thing.origin
        return wish.cancelled and (
            wish.bad or back or thing.missed or (thing.place == ROBOT and self._kept_from(thing.origin))
        )

    def _is_rejected(self, wish: Wish, thing: Thing) -> bool:
        return wish.bad or (self.domain.sightings and thing.missed)

    def _is_aborted(self, wish: Wish, thing: Thing) -> bool:
        stuck = [name for name, one in self.things.items() if one.place == ROBOT and self._wish_for(name) is None]
        needed = {wish.to, wish.home} | ({thing.origin} if thing.place == ROBOT else set())
        if self._together:  # one of them leads to a dead end
            needed |= {place for other in self.live.values() for place in (other.to, other.home)}
        hopeless = any(self._kept_from(place) for place in needed)
        if self.domain.sightings:  # the core can search for it anywhere
            hopeless |= any(self._kept_from(place) for place in self.domain.places)
        return wish.missed or wish.slipped or hopeless or len(stuck) >= CAPACITY

    def _kept_from(self, place: str) -> bool:
        """Return whether reports can keep the robot away from a place."""
        shut = self._rumours.shut()
        if self._rumours.takes >= TRIES:
            return True
        reached, queue = {self.robot}, [self.robot]
        while queue:
            here = queue.pop()
            for way in map(frozenset, self.domain.ways):
                if here in way and way not in shut and not (way - {here}) & self._rumours.unknown:
                    (other,) = way - {here}
                    queue += [] if other in reached else [other]
                    reached.add(other)
        if self.astray and self.robot in self._rumours.unknown:  # it has not quite arrived
            reached.discard(self.robot)
        stays = self.astray and frozenset((self.robot,)) in shut and len(reached) <= 1
        return stays or place not in reached

    # ---- the end ------------------------------------------------------------------------------------------------

    def request_all_things_on_board(self) -> bool:
        """Stop all failures and ask for a thing on the robot; return False if none is left on it."""
        self.calm = True
        name = next((name for name, one in self.things.items() if one.place == ROBOT), None)
        if name is not None:
            self.wish(name)
        return name is not None

    def _tell(self, facts: List[str]) -> None:
        self._say("tell " + " ".join(facts))
        self._port.tell(facts)

    def _say(self, text: str) -> None:
        self.log.append(f"{self.cycle} at {self.robot}: {text}")

    def _fault(self, text: str) -> None:
        self.faults.append(f"cycle {self.cycle}: {text}")
        self._say("FAULT " + text)
