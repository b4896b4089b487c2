#!/usr/bin/env python3
"""Measures the preference for short drives (encodings/delivery/short_drives.lp): metres driven and processor time.

The requests are between the rooms of the shipped house, and between random places on a floor with doors and clutter.
Connections and distances are computed from the map, as by the command places. The solver plans with the settings of the
core, with and without the preference. Each plan is executed to its end.

Run it in the built workspace: ./dev exec python3 bench/short_drives.py
"""

import argparse
import random
import sys
import time
from pathlib import Path

import numpy as np
from figures import Figure, parse, write

ROOT = Path(__file__).resolve().parents[1]
sys.path.append(str(ROOT / "test" / "unit"))

from tour_floors import small_floor  # noqa: E402

from rosoclingo.common.labels import Label, LabelError, LabelTable  # noqa: E402
from rosoclingo.common.reading import read_yaml  # noqa: E402
from rosoclingo.oclingo import ReactiveProgram, parse_update  # noqa: E402
from rosoclingo.oclingo.program.sources import Source  # noqa: E402
from rosoclingo.planning.history import Plan  # noqa: E402
from rosoclingo.planning.solver import PlanSolver  # noqa: E402
from rosoclingo.robot.navigation import Costmap, CostmapLimits, load_map  # noqa: E402
from rosoclingo.robot.navigation.floor import FloorError, floor_of  # noqa: E402

MAILBOT, PREFERENCE = (ROOT / "encodings" / name for name in ("mailbot.lp", "delivery/short_drives.lp"))


def house():
    """Return the floor of the shipped house."""
    labels = LabelTable.read(read_yaml(ROOT / "config" / "house_labels.yaml", "labels", LabelError))
    return floor_of(Costmap(load_map(ROOT / "worlds" / "house.yaml"), CostmapLimits()), labels)


def strewn(count=10, seed=1):
    """Return a floor of 10 m x 10 m with ``count`` random places."""
    costmap, source = Costmap(small_floor(np.random.default_rng(seed)).grid, CostmapLimits()), random.Random(seed)
    labels = []
    while len(labels) < count:
        label = Label(f"p{len(labels)}", source.uniform(0.5, 9.5), source.uniform(0.5, 9.5))
        try:
            floor = floor_of(costmap, LabelTable((*labels, label)))
        except FloorError:
            continue
        if len(floor.distances) == len(labels) * (len(labels) + 1) // 2:  # the new place is reachable
            labels.append(label)
    return floor


class Planner:
    """The mailbot's program on a floor, with or without the preference."""

    def __init__(self, floor, prefers):
        self._floor = floor._replace(start=floor.places[0])
        text = f"#program base.\n{self._floor.facts()}"
        files = [MAILBOT, *([PREFERENCE] if prefers else [])]
        self._program = ReactiveProgram([*map(Source.from_file, files), Source("floor.lp", text)])
        PlanSolver(self._program, plan_time=1.0).solve()

    def drive(self, requests):
        """Plan for some requests; return the metres and steps of the plan, and the processor time (s) of the search."""
        solver = PlanSolver(self._program, plan_time=1.0)
        facts = " ".join(f"_request(goal({a},{b},{number}),2)." for number, (a, b) in enumerate(requests, 1))
        begin = time.process_time()
        result = solver.update(parse_update(f"#step 1. {facts} #endstep."))
        seconds = time.process_time() - begin
        actions = sorted((one.arguments for one in Plan.from_result(result).actions), key=lambda one: one[2].number)
        way = [self._floor.start, *(str(place) for kind, place, _ in actions if kind.name == "move_base")]
        metres = sum(self._floor.distances[min(pair), max(pair)] for pair in zip(way, way[1:]))
        return metres, len(actions), seconds


def measure(name, floor, count, rounds):
    """Play ``rounds`` of ``count`` requests each with both programs, in turns; print and return the figures."""
    source, planners = random.Random(count), {prefers: Planner(floor, prefers) for prefers in (False, True)}
    sums = {prefers: np.zeros(3) for prefers in planners}
    for _ in range(rounds):
        requests = [tuple(source.sample(floor.places, 2)) for _ in range(count)]
        for prefers, planner in planners.items():
            sums[prefers] += planner.drive(requests)
    (any_metres, any_steps, any_seconds), (metres, steps, seconds) = sums[False] / rounds, sums[True] / rounds
    print(f"{name}, {count} requests: {metres:.1f} m, {steps:.1f} steps, {1000 * seconds:.0f} ms with the preference,")
    print(f"    {any_metres:.1f} m, {any_steps:.1f} steps, {1000 * any_seconds:.0f} ms without")
    case = f"{name}, {count} requests"
    return [
        Figure(f"{case}: metres with over without", metres / any_metres, ""),
        Figure(f"{case}: steps with over without", steps / any_steps, ""),
        Figure(f"{case}: processor time with", 1000 * seconds, "ms"),
    ]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=20, help="sets of requests for each case (default: %(default)s)")
    options = parse(parser, rounds=3)
    found = []
    for name, floor in (("house", house()), ("strewn", strewn())):
        for count in (2, 4, 6):
            found += measure(name, floor, count, options.rounds)
    write(options.json, found)


if __name__ == "__main__":
    main()
