#!/usr/bin/env python3
"""Measures the preference for short drives (encodings/delivery/short_drives.lp): metres driven and processor time.

The requests are between the rooms of the shipped house. Connections and distances are computed from the map, as by the
command places. The solver plans with the settings of the core, with and without the preference. Each plan is executed
to its end.

Run it in the built workspace: ./dev exec python3 bench/short_drives.py
"""

import random
import time

import numpy as np
from acting_core import ENCODINGS
from figures import Figure, Option, main

from rosoclingo.common.labels import LabelError, LabelTable
from rosoclingo.common.reading import read_yaml
from rosoclingo.oclingo import ReactiveProgram, parse_update
from rosoclingo.oclingo.program.sources import Source
from rosoclingo.planning.history import Plan
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.robot.navigation import Costmap, CostmapLimits, load_map
from rosoclingo.robot.navigation.floor import floor_of

ROOT = ENCODINGS.parent
FILES = {"without": ["mailbot.lp"], "with": ["mailbot.lp", "delivery/short_drives.lp"]}


def house():
    """Return the floor of the shipped house."""
    labels = LabelTable.read(read_yaml(ROOT / "config" / "house_labels.yaml", "labels", LabelError))
    floor = floor_of(Costmap(load_map(ROOT / "worlds" / "house.yaml"), CostmapLimits()), labels)
    return floor._replace(start=floor.places[0])


def drive(program, floor, requests):
    """Plan for some requests; return the metres and steps of the plan, and the processor time (s) of the search."""
    solver = PlanSolver(program, plan_time=1.0)
    facts = " ".join(f"_request(goal({a},{b},{number}),2)." for number, (a, b) in enumerate(requests, 1))
    begin = time.process_time()
    result = solver.update(parse_update(f"#step 1. {facts} #endstep."))
    seconds = time.process_time() - begin
    actions = sorted((one.arguments for one in Plan.from_result(result).actions), key=lambda one: one[2].number)
    way = [floor.start, *(str(place) for kind, place, _ in actions if kind.name == "move_base")]
    return sum(floor.distances[min(pair), max(pair)] for pair in zip(way, way[1:])), len(actions), seconds


def measure(options):
    """Play the same sets of requests with both programs, in turns; yield the means."""
    floor = house()
    facts, programs = Source("floor.lp", f"#program base.\n{floor.facts()}"), {}
    for kind, names in FILES.items():
        programs[kind] = ReactiveProgram([*(Source.from_file(ENCODINGS / name) for name in names), facts])
        PlanSolver(programs[kind], plan_time=1.0).solve()
    for count in (2, 4, 6):
        source, sums = random.Random(count), {kind: np.zeros(3) for kind in programs}
        for _ in range(options.rounds):
            requests = [tuple(source.sample(floor.places, 2)) for _ in range(count)]
            for kind, program in programs.items():
                sums[kind] += drive(program, floor, requests)
        for kind, (metres, steps, seconds) in sums.items():
            what = f"house, {count} requests, {kind} the preference: "
            yield Figure(what + "metres", metres / options.rounds, "m")
            yield Figure(what + "steps", steps / options.rounds, "steps")
            yield Figure(what + "time", 1000 * seconds / options.rounds, "ms of processor")


if __name__ == "__main__":
    main(__doc__, measure, rounds=Option(20, "sets of requests for each number", 3))
