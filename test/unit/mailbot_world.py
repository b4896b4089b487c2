"""The mailbot's world in plain Python, written from the documents instead of the encoding, and a robot in it.

A state is the robot's office, whether it has lost its way (then it has to reach an office before it handles a
package), and each package's place: ``("waits", from, to)``, ``("rides", goal)``, ``("stuck",)`` on the robot, or
``None`` when nothing is left to do for it. The distance of a state is found by breadth-first search over all states.
"""

from collections import deque
from functools import lru_cache

from shipped import ENCODINGS

from rosoclingo.oclingo import (
    ReactiveProgram,
    SolveOutcome,
    StreamUpdate,
    commitment,
    fact,
    parse_term,
)
from rosoclingo.oclingo.program.sources import Source
from rosoclingo.oclingo.progression.updates import CloseCycles
from rosoclingo.planning.solver import PlanSolver

TRIES, MEMORY, TOLD = 3, 6, 20
BLOCKED = ("blocked", "unreachable")
MISSING = ("not_here", "unknown_package", "not_carried")


def atom(text, *values):
    return fact(parse_term(text.format(*values)))


def neighbours(corridors):
    """Return a map from each office to the offices that a corridor leads to, given pairs of offices."""
    found = {}
    for a, b in corridors:
        found.setdefault(a, set()).add(b)
        found.setdefault(b, set()).add(a)
    return found


def fewest_steps(graph, capacity, office, packages, astray=False, shut=frozenset(), spared=frozenset()):
    """Return the length of a shortest plan, None without one.

    ``packages`` is a tuple of places, those with an index in ``spared`` can stay in place; ``shut`` holds connections
    as frozensets of their ends, one office alone for the way back to it.
    """
    first = (office, astray, tuple(packages))
    seen, queue = {first: 0}, deque([first])
    while queue:
        state = queue.popleft()
        if not any(one and one[0] != "stuck" and number not in spared for number, one in enumerate(state[2])):
            return seen[state]
        for following in _successors(graph, capacity, shut, *state):
            if following not in seen:
                seen[following] = seen[state] + 1
                queue.append(following)
    return None


def _successors(graph, capacity, shut, office, astray, packages):
    for other in [*graph.get(office, ()), *([office] if astray else [])]:
        if frozenset((office, other)) not in shut:
            yield other, False, packages
    if astray:
        return
    load = sum(place is not None and place[0] != "waits" for place in packages)
    for index, place in enumerate(packages):
        after = None
        if place and place[0] == "waits" and place[1] == office and load < capacity:
            after = ("rides", place[2])
        elif not (place and place[0] == "rides" and place[1] == office):
            continue
        yield office, False, (*packages[:index], after, *packages[index + 1 :])


def reachable(graph, shut, office):
    """Return the reachable offices."""
    found, queue = {office}, [office]
    while queue:
        here = queue.pop()
        for other in graph.get(here, ()):
            if other not in found and frozenset((here, other)) not in shut:
                found.add(other)
                queue.append(other)
    return found


@lru_cache(maxsize=16)
def program(count, corridors, start, capacity):
    """Return the reactive program of a floor with offices o1 .. o``count``; corridors are pairs of numbers."""
    facts = [f"office(o{number})." for number in range(1, count + 1)]
    facts += [f"corridor(o{a},o{b})." for a, b in corridors] + [f"start(o{start})."]
    sources = [Source.from_file(ENCODINGS / "mailbot.lp"), Source("floor", "#program base. " + " ".join(facts))]
    return ReactiveProgram(sources, {"capacity": str(capacity)})


class Ways:
    """The robot's beliefs about the connections."""

    def __init__(self):
        self.misses, self.avoided, self.unknown = {}, {}, set()
        self.noticed = False

    def returned(self, way=None, reason=None):
        """Note the return of an action; ``way`` is None unless it was a move, ``reason`` None if it succeeded."""
        failed = way is not None and reason not in (None, "preempted")
        closed = failed and reason in BLOCKED
        if way is not None and reason is None and way in self.misses:
            del self.misses[way]
            self.avoided.pop(way, None)
        self.avoided = {one: left - 1 for one, left in self.avoided.items() if left > 1 and not (closed and one == way)}
        self.noticed = failed
        if failed:
            self.misses[way] = self.misses.get(way, 0) + 1
        if closed:
            self.avoided[way] = MEMORY

    def asked(self):
        """Note a request for a place that seems to be cut off."""
        self.misses, self.avoided, self.unknown = {}, {}, set()

    def shut(self, graph):
        """Return the blocked connections."""
        lost = {frozenset((one, other)) for one in self.unknown for other in [one, *graph.get(one, ())]}
        return frozenset({*self.avoided, *lost, *(way for way, times in self.misses.items() if times >= TRIES)})


class Mailbot:
    """A robot in its world, controlled by the encoding, cycle by cycle.

    Attributes:
        places: Id to the package's place, as above.
        origins: Id to the office where its package waited.
        ends: Id to the end of its request, and the first cycle that reported it.
    """

    def __init__(self, count, corridors, start=1, capacity=3):
        self.graph = neighbours([(f"o{a}", f"o{b}") for a, b in corridors])
        self.capacity, self.office, self.astray = capacity, f"o{start}", False
        self.places, self.origins, self.ends, self.cancelled = {}, {}, {}, set()
        self.ways, self.slips, self.shut, self._reached = Ways(), {}, frozenset(), set(self.graph)
        self.cycle, self._items, self._done = 0, [], None
        self.takes = 0  # how often in a row somebody else has driven the robot
        self._refused = set()
        self.solver = PlanSolver(program(count, corridors, start, capacity), horizon_limit=1000)
        assert self.solver.solve().outcome is SolveOutcome.SATISFIABLE

    def request(self, identifier, source, target):
        """Add a request to the next update; packages on the robot continue from there."""
        source, target = f"o{source}", f"o{target}"
        self._items.append(atom("_request(goal({},{},{}),{})", source, target, identifier, self.cycle + 2))
        self.ends.pop(identifier, None)
        held = (self.places.get(identifier) or ("waits",))[0] != "waits"
        if held and source != self.origins[identifier]:
            self._refused.add(identifier)
            return
        self.places[identifier] = ("rides", target) if held else ("waits", source, target)
        self.origins[identifier], self.takes = source, 0
        source = target if held else source
        self.slips.pop(identifier, None)
        self.cancelled.discard(identifier)
        if self.shut and not {source, target} <= self._reached and not self.ways.noticed:
            self.ways.asked()

    def cancel(self, identifier):
        """Cancel a request with the next update."""
        self._items.append(atom("_request(cancel({}),{})", identifier, self.cycle + 1))
        place = self.places.get(identifier)
        if place and place[0] != "stuck" and identifier not in self.cancelled:
            self.cancelled.add(identifier)
            self.places[identifier] = None if place[0] == "waits" else ("rides", self.origins[identifier])
            if place[0] == "waits":
                self.ends[identifier] = ("canceled", self.cycle + 1)

    def plan(self):
        """Start the next cycle; return its actions and later ones, after checking that they are the fewest.

        Return None without a plan, after checking that none exists.
        """
        items = [CloseCycles(self.cycle, self.cycle)] if self.cycle else []
        items += [commitment(self._done)] if self._done is not None else []
        self.cycle += 1
        if self._done is None:
            self.ways.noticed = False
        self.shut = self.ways.shut(self.graph)
        self._reached = reachable(self.graph, self.shut, self.office)
        needed = self._fewest()
        bound = None if needed is not None else 30
        result = self.solver.update(StreamUpdate(self.cycle, bound, tuple(items + self._items)))
        self._items, self._done, refused, self._refused = [], None, self._refused, set()
        assert not result.warnings
        if needed is None:
            assert result.outcome is SolveOutcome.UNSATISFIABLE, result
            return None
        assert result.outcome is SolveOutcome.SATISFIABLE, result
        self.answer = result.answers[0]
        self._check_statuses(self.answer, refused)
        actions = {one.arguments[2].number: one for one in self.answer if one.name == "_action_lib"}
        ahead = [actions[cycle] for cycle in sorted(actions) if cycle >= self.cycle]
        assert [one.arguments[2].number for one in ahead] == list(range(self.cycle, self.cycle + needed))
        return ahead

    def _fewest(self):
        spared = frozenset(number for number, one in enumerate(self.places) if self._is_cut_off(one))
        if self.takes >= TRIES:
            waits = [one for number, one in enumerate(self.places.values()) if number not in spared]
            return None if any(one and one[0] != "stuck" for one in waits) else 0
        places = tuple(self.places.values())
        return fewest_steps(self.graph, self.capacity, self.office, places, self.astray, self.shut, spared)

    def _is_cut_off(self, identifier):
        place = self.places[identifier]
        rides = place is not None and place[0] == "rides"
        lost = self.takes >= TRIES or (place is not None and place[1:] and place[1] not in self._reached)
        return rides and identifier in self.cancelled and lost

    def hopeless(self):
        """Return the requests for which there is no plan, regardless of the others."""
        found = []
        for identifier, place in self.places.items():
            if place and place[0] != "stuck" and not self._is_cut_off(identifier):
                stuck = [one for one in self.places.values() if one == ("stuck",)]
                kept = [("stuck",) for one in self.places if self._is_cut_off(one)]
                packages = (place, *stuck, *kept)
                if (
                    self.takes >= TRIES
                    or fewest_steps(self.graph, self.capacity, self.office, packages, self.astray, self.shut) is None
                ):
                    found.append(identifier)
        return found

    def _check_statuses(self, answer, refused):
        found = {}
        for one in answer:
            if one.name == "_status" and one.arguments[2].number == self.cycle:
                identifier, status = one.arguments[0].number, str(one.arguments[1])
                if identifier in refused and status.startswith("rejected"):
                    where = f'" is on the robot, which picked it up at ",{self.origins[identifier]}'
                    assert status == f'rejected(("package ",{identifier},{where}))'
                    refused = refused - {identifier}
                else:
                    assert identifier not in found
                    found[identifier] = status
        assert not refused
        reported = {}
        for identifier, place in self.places.items():
            if place and place[0] != "stuck":
                reported[identifier] = "canceled" if self._is_cut_off(identifier) else "accepted"
        for identifier, (end, since) in self.ends.items():
            if self.cycle < (since // TOLD + 2) * TOLD:
                reported[identifier] = end
        assert found == reported

    def act(self, action, reason=None):
        """Execute ``action``; it fails if a ``reason`` is given."""
        name, what, _ = action.arguments
        self._done = action
        self._items.insert(0, atom("_return({},{},{})", name, reason or what, self.cycle))
        self.takes = 0 if reason is None else self.takes + (reason == "preempted")
        if name.name == "move_base":
            self._move(what.name, reason)
        elif reason is None:
            self.ways.returned()
            getattr(self, "_" + name.name)(what.number)
        else:
            self.ways.returned()
            self._fail_to_handle(what.number, name.name, reason)

    def called_off(self):
        """Note that the core has ended the last action."""
        name, what, _ = self._done.arguments
        self._items.insert(0, atom("_cancel({},{},{})", name, what, self.cycle))
        self.takes = 0

    def _move(self, office, reason):
        assert office in self.graph[self.office] or (office == self.office and self.astray)
        way = frozenset((self.office, office))
        assert way not in self.shut
        self.ways.returned(way, reason)
        if reason is None:
            self.office, self.astray = office, False
            self.ways.unknown.discard(office)
        elif reason == "unknown_label":
            self.ways.unknown.add(office)

    def _pickup(self, identifier):
        state, source, target = self.places[identifier]
        assert (state, source, self.astray) == ("waits", self.office, False)
        self.places[identifier] = ("rides", target)
        self.slips.pop(identifier, None)
        assert sum(place is not None and place[0] != "waits" for place in self.places.values()) <= self.capacity

    def _deliver(self, identifier):
        assert self.places[identifier] == ("rides", self.office)
        assert not self.astray
        self.places[identifier] = None
        self.ends[identifier] = ("canceled" if identifier in self.cancelled else "succeeded", self.cycle + 1)

    def _fail_to_handle(self, identifier, name, reason):
        if reason == "not_at_label":
            self.astray = True
        if reason == "preempted":
            return
        riding = name == "deliver"
        if reason in MISSING:
            text = '" is not on the robot"' if riding else f'" is not at ",{self.office}'
            self._give_up(identifier, text, None)
            return
        self.slips[identifier] = self.slips.get(identifier, 0) + 1
        if self.slips[identifier] >= TRIES:
            done = "put down" if riding else "picked up"
            text = f'" could not be {done} at ",{self.office},": ",{reason}'
            self._give_up(identifier, text, ("stuck",) if riding else None)

    def _give_up(self, identifier, text, place):
        self.places[identifier] = place
        self.ends[identifier] = (f'aborted(("package ",{identifier},{text}))', self.cycle + 1)
        self.slips.pop(identifier, None)
