"""The mailbot's world in plain Python, written from the paper and not from the encoding, and a robot in it.

A state is the robot's office and each package's place: ``("waits", from, to)``, ``("rides", goal)`` or ``None`` when nothing
is left to do for it. The distance of a state is found by breadth-first search over all states.
"""

from collections import deque
from pathlib import Path

from rosoclingo.oclingo import (
    ReactiveProgram,
    ReactiveSolver,
    SolveOutcome,
    StreamUpdate,
    commitment,
    fact,
    parse_term,
)
from rosoclingo.oclingo.sources import Source

ENCODINGS = Path(__file__).resolve().parents[2] / "encodings"
_PROGRAMS = {}


def atom(text, *values):
    return fact(parse_term(text.format(*values)))


def neighbours(corridors):
    """Return office to offices that a corridor leads to, from pairs of offices."""
    found = {}
    for a, b in corridors:
        found.setdefault(a, set()).add(b)
        found.setdefault(b, set()).add(a)
    return found


def fewest_steps(graph, capacity, office, packages):
    """Return the length of a shortest plan from ``office`` with ``packages``, a tuple of their places."""
    first = (office, tuple(packages))
    seen, queue = {first: 0}, deque([first])
    while queue:
        state = queue.popleft()
        if not any(state[1]):
            return seen[state]
        for following in _successors(graph, capacity, *state):
            if following not in seen:
                seen[following] = seen[state] + 1
                queue.append(following)
    raise AssertionError("a connected floor has a plan for everything")


def _successors(graph, capacity, office, packages):
    for other in graph.get(office, ()):
        yield other, packages
    load = sum(place is not None and place[0] == "rides" for place in packages)
    for index, place in enumerate(packages):
        after = None
        if place and place[0] == "waits" and place[1] == office and load < capacity:
            after = ("rides", place[2])
        elif not (place and place[0] == "rides" and place[1] == office):
            continue
        yield office, packages[:index] + (after,) + packages[index + 1 :]


def program(count, corridors, start, capacity):
    """Return the reactive program of a floor with offices o1 .. o``count``; corridors are pairs of numbers."""
    key = (count, corridors, start, capacity)
    if key not in _PROGRAMS:
        facts = [f"office(o{number})." for number in range(1, count + 1)]
        facts += [f"corridor(o{a},o{b})." for a, b in corridors] + [f"start(o{start})."]
        sources = [Source.from_file(ENCODINGS / "mailbot.lp"), Source("floor", "#program base. " + " ".join(facts))]
        _PROGRAMS.clear()
        _PROGRAMS[key] = ReactiveProgram(sources, {"capacity": str(capacity)})
    return _PROGRAMS[key]


class Mailbot:
    """A robot in its world, told what to do by the encoding, cycle by cycle.

    Attributes:
        places: Id to the package's place, as above.
        origins: Id to the office where its package waited.
        ends: Id to how its request ended, ``succeeded`` or ``canceled``.

    """

    def __init__(self, count, corridors, start=1, capacity=3):
        self.graph = neighbours([(f"o{a}", f"o{b}") for a, b in corridors])
        self.capacity, self.office = capacity, f"o{start}"
        self.places, self.origins, self.ends, self.cancelled = {}, {}, {}, set()
        self.cycle, self._items, self._done = 0, [], None
        self.solver = ReactiveSolver(program(count, corridors, start, capacity), horizon_limit=300, shortest=True)
        assert self.solver.solve().outcome is SolveOutcome.SATISFIABLE

    def request(self, identifier, source, target):
        """A new request, told with the next update."""
        source, target = f"o{source}", f"o{target}"
        self._items.append(atom("_request(goal({},{},{}),{})", source, target, identifier, self.cycle + 2))
        self.places[identifier], self.origins[identifier] = ("waits", source, target), source
        self.ends.pop(identifier, None)
        self.cancelled.discard(identifier)

    def cancel(self, identifier):
        """Cancel a request, with the next update."""
        self._items.append(atom("_request(cancel({}),{})", identifier, self.cycle + 1))
        place = self.places.get(identifier)
        if place and identifier not in self.cancelled:
            self.cancelled.add(identifier)
            self.places[identifier] = None if place[0] == "waits" else ("rides", self.origins[identifier])
            if place[0] == "waits":
                self.ends[identifier] = "canceled"

    def plan(self):
        """Start the next cycle; return the actions planned for it and later, after checking that they are the fewest."""
        items = [commitment(self._done)] if self._done is not None else []
        if self.cycle:
            self.solver.close_cycle(self.cycle, [] if self._done is None else [self._done])
        self.cycle += 1
        result = self.solver.update(StreamUpdate(self.cycle, None, tuple(items + self._items)))
        self._items, self._done = [], None
        assert result.outcome is SolveOutcome.SATISFIABLE, result
        assert not result.warnings
        actions = {one.arguments[2].number: one for one in result.answers[0] if one.name == "_action_lib"}
        self._check_statuses(result.answers[0])
        ahead = [actions[cycle] for cycle in sorted(actions) if cycle >= self.cycle]
        needed = fewest_steps(self.graph, self.capacity, self.office, self.places.values())
        assert [one.arguments[2].number for one in ahead] == list(range(self.cycle, self.cycle + needed))
        return ahead

    def _check_statuses(self, answer):
        found = {str(one.arguments[0]): str(one.arguments[1]) for one in answer if self._is_status_now(one)}
        told = {str(identifier): "accepted" for identifier, place in self.places.items() if place}
        told.update((str(identifier), end) for identifier, end in self.ends.items())
        assert found == told

    def _is_status_now(self, one):
        return one.name == "_status" and one.arguments[2].number == self.cycle

    def act(self, action, reason=None):
        """Execute ``action``; it fails, changing nothing, where a ``reason`` is given."""
        name, what, _ = action.arguments
        self._done = action
        self._items.insert(0, atom("_return({},{},{})", name, reason or what, self.cycle))
        if reason is None:
            getattr(self, "_" + name.name)(what.name if name.name == "move_base" else what.number)

    def _move_base(self, office):
        assert office in self.graph[self.office]
        self.office = office

    def _pickup(self, identifier):
        state, source, target = self.places[identifier]
        assert (state, source) == ("waits", self.office)
        self.places[identifier] = ("rides", target)
        assert sum(place is not None and place[0] == "rides" for place in self.places.values()) <= self.capacity

    def _deliver(self, identifier):
        assert self.places[identifier] == ("rides", self.office)
        self.places[identifier] = None
        self.ends[identifier] = "canceled" if identifier in self.cancelled else "succeeded"
