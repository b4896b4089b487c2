#!/usr/bin/env python3
"""Measures fleets: several robots, whose drives take different times, serve many requests.

The core runs without ROS, with encodings/fleet.lp and its solver in worker processes. A world in plain Python executes
the actions. It draws the duration of each around its mean, the same for the same seed, and refuses actions that break a
rule: robots hold both ends of the connection that they drive on. Each place has room for two robots.

The routing solver of OR-Tools gets the same requests, the mean durations, and 5 s. It minimizes the makespan and
ignores collisions.

A row is a floor (number of offices in a row, or loops), the numbers of robots and of requests, and "once" (all
requests are known at the start) or "stream" (one more every 15 s). Figures of a row:
  first     seconds of processor time until the first action
  makespan  simulated seconds until the last delivery
  delay     simulated seconds from a request to its delivery, on average
  paper     both without _running, in the paper's cycle
  drive     seconds of driving, of all robots
  or        the makespan of OR-Tools' plan, for requests that are known at the start
  idle      longest time in seconds that a robot had no task although it could have been at a waiting package sooner
            than the robot that was to pick it up

Run it in the built workspace: ./dev exec python3 bench/fleet.py
./dev bench fleet installs OR-Tools.
"""

import heapq
import math
from itertools import product
from statistics import mean

import peers
from acting_core import PooledCore
from deliveries import floor_named, random_requests
from figures import Option, main, row_figures
from fleet_world import DRIVE, HANDLE, FleetWorld, fleet_program

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.oclingo.program.sources import Source
from rosoclingo.reasoning.events import ActionsDispatched

ROOM = 2  # number of robots for which a place has room
GAP = 15.0  # seconds between two requests of a stream
PLAN_TIME = 0.3  # seconds of processor time to shorten a plan before its first action, as in fleet.launch
SHARE = 0.5  # seconds of processor time for each simulated second to improve and prefetch plans between two events
OR_SECONDS = 5.0  # OR-Tools' time for a plan

UNITS = {
    "first [s]": "s of processor",
    **dict.fromkeys(["makespan", "delay", "paper: makespan", "paper: delay", "drive", "or", "idle"], "s"),
}

RUNNING = "#external _running/3.\n"
"""The declaration in encodings/fleet/rules.lp that gives a program the finer cycle."""


def starts(floor, robots):
    """Return the initial offices of the robots r1, r2 ..., spread over the floor."""
    return {f"r{number + 1}": 1 + (2 * number + 1) * floor.offices // (2 * robots) for number in range(robots)}


def in_papers_cycle(program):
    """Return the program of a fleet in which an action ends with all others, as in the paper."""
    texts = [Source(one.name, one.text.replace(RUNNING, "#defined _running/3.\n")) for one in program.texts]
    return ReactiveProgram(texts, whole=True)


class FleetCore(PooledCore):
    """A core whose actions a world executes, each for its own time; all of them succeed.

    Attributes:
        now: the simulated time in seconds.
        idle: the longest time that a robot had no task while another one was to pick up a package later than it could.
        first: the processor time in seconds at which the first action was sent.
        delays: the simulated seconds from each request to its delivery.

    """

    def __init__(self, program, world):
        super().__init__(program, PLAN_TIME)
        self.world, self.now, self.idle, self.first = world, 0.0, 0.0, None
        self.delays = []
        self._ends, self._rests, self._asked = [], {}, {}

    def ask(self, requests):
        """Send goals; their packages wait on the floor."""
        self.world.ask(requests)
        for one in requests:
            self._asked[one.number] = self.now
            self.core.add_goal(str(one.number), one.goal)

    def note(self, event):
        """Begin the actions that the core sends, and check that no goal fails."""
        super().note(event)
        if isinstance(event, ActionsDispatched):
            self.first = self.first or self.used
            for action in event.actions:
                robot, verb, what = act_of(action)
                duration = self.world.begin(robot, verb, what)
                heapq.heappush(self._ends, (self.now + duration, len(self._ends), robot, action))
        self.check_success()

    def play(self, arrivals):
        """Serve the requests, each at its time; improve plans between events."""
        while arrivals or self.world.open:
            self._rest()
            if arrivals and (not self._ends or arrivals[0][0] <= self._ends[0][0]):
                self.now = max(self.now, arrivals[0][0])
                self.ask(arrivals.pop(0)[1])
            elif self._ends:
                self.now, _, robot, action = heapq.heappop(self._ends)
                self.world.end(robot)
                _, verb, what = act_of(action)
                if verb == "deliver":
                    self.delays.append(self.now - self._asked[what])
                self.answer(actions=[action])
            else:
                self.now += 1.0
            self.core.poll(self.now)
            self.advance(self.now)
            self._improve(min([one[0] for one in (*self._ends[:1], *arrivals[:1])], default=self.now))

    def _improve(self, end):
        """Improve the plan until the time of the next event, and prefetch a plan with queued goals."""
        seconds = SHARE * (end - self.now)
        self.core.prepare()
        for _ in self.better_plans(seconds):
            self.core.prepare()  # from the better plan
        self.await_standby(seconds)

    def _rest(self):
        """Measure how long robots are without a task while a package waits that they could pick up sooner."""
        self.idle = max([self.idle, *(self.now - since for since in self._rests.values())])
        world, rests = self.world, {}
        busy, pickups = self._plan_times()
        for robot in world.at.keys() - busy.keys():
            moves = world.floor.distances_from(world.at[robot])
            times = [(DRIVE * moves[one.start], pickups.get(one.number, math.inf)) for one in world.waiting.values()]
            if not world.load[robot] and any(sooner < planned for sooner, planned in times):
                rests[robot] = self._rests.get(robot, self.now)
        self._rests = rests

    def _plan_times(self):
        """Return the mean seconds until robots with a task end the last one, and until packages are picked up."""
        acts = self.world.acts
        busy = {robot: end - self.now for end, _, robot, _ in self._ends}
        pickups = {what: 0.0 for verb, what in acts.values() if verb == "pickup"}
        for action in self.core.plan.remaining(self.core.cycle):
            robot, verb, what = act_of(action)
            if acts.get(robot) != (verb, what) or action.cycle > self.core.cycle:  # it is not under way
                begin = busy.get(robot, 0.0)
                busy[robot] = begin + (DRIVE if verb == "move_base" else HANDLE)
                if verb == "pickup":
                    pickups[what] = begin
        return busy, pickups


def act_of(action):
    """Return robot, verb and office or package of an action."""
    what = int(str(action.parameter).replace("office", ""))
    return str(action.interface.arguments[0]), action.interface.name, what


# ---- Measurements ----------------------------------------------------------------------------------------------------


def routed(floor, robots, requests):
    """Return the makespan in seconds of OR-Tools' plan for several robots; raises RoutingError."""
    places, ends = list(starts(floor, robots).values()), []
    for place, visits in zip(places, peers.routes(floor, places, requests, (), OR_SECONDS, (int(DRIVE), int(HANDLE)))):
        way = [place, *map(peers.place_of, visits)]
        moves = sum(floor.distances_from(here)[there] for here, there in zip(way, way[1:]))
        ends.append(DRIVE * moves + HANDLE * len(visits))
    return max(ends)


def drive(program, world, requests, gap):
    """Serve the requests; return figures of the run."""
    batches = [(gap * number, [one]) for number, one in enumerate(requests)] if gap else [(0.0, requests)]
    with FleetCore(program, world) as core:
        begin = core.used
        core.play(batches)
        times = {"makespan": core.now, "delay": mean(core.delays), "drive": world.driven, "idle": core.idle}
        return {"first [s]": core.first - begin, **times}


def measure_row(name, robots, count, how, seed, paper):
    """Return the figures of a row, with the paper's cycle if ``paper``."""
    floor = floor_named(name)
    requests, places, gap = random_requests(floor, count, seed), starts(floor, robots), GAP if how == "stream" else 0.0
    program = fleet_program(floor, places, ROOM)
    cells = drive(program, FleetWorld(floor, places, ROOM, seed), requests, gap)
    if paper:
        other = drive(in_papers_cycle(program), FleetWorld(floor, places, ROOM, seed), requests, gap)
        cells.update({f"paper: {column}": other[column] for column in ("makespan", "delay")})
    if not gap and peers.folder_of(peers.OR_TOOLS):
        cells["or"] = routed(floor, robots, requests)
    return cells


def measure(options):
    """Yield the figures of all rows."""
    for row in product(options.floors, options.robots, options.requests, options.how):
        cells = measure_row(*row, options.seed, row[1] in options.paper)
        yield from row_figures("{}/{}/{} {}".format(*row), cells, UNITS)


if __name__ == "__main__":
    main(
        __doc__,
        measure,
        floors=Option(["20", "loops"], "floors", ["loops"]),
        robots=Option([1, 2, 4, 8], "numbers of robots", [2, 4]),
        requests=Option([20, 50], "numbers of requests", [20]),
        how=Option(["once", "stream"], "arrival of requests", ["once"], ["once", "stream"]),
        paper=Option([4], "numbers of robots that act in the paper's cycle as well"),
        seed=Option(1, "seed of requests and durations"),
    )
