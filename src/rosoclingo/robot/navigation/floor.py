"""The floor of a map as a program sees it: places, which are next to each other, and how far they are apart."""

from typing import Dict, List, NamedTuple, Tuple

import numpy as np

from rosoclingo.common.labels import Label, LabelError, LabelTable
from rosoclingo.common.reading import read_yaml
from rosoclingo.robot.navigation.costmap import Costmap, CostmapLimits
from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.navigation.grid import load_map
from rosoclingo.robot.navigation.grid_planner import GridPlanner, PlanOutcome
from rosoclingo.robot.navigation.inflated_ways import navfn_lengths

#: A place is on the way between two others where the way over it is longer by no more than this part.
DETOUR = 0.1

Pair = Tuple[str, str]

#: Marks of the facts that a program can ignore.
_WAYS = "% check: ok unused (for programs that drive from place to place)"
_DISTANCES = "% check: ok unused (for programs that prefer short drives)"
_START = "% check: ok unused (for programs with a start of their own)"


class FloorError(ValueError):
    """Labels that fit no floor; the text lists all faults with what to do."""


class Floor(NamedTuple):
    """Labels ``places``, in order, and ``distances`` (m) of the pairs of them, in order, between which there is a way.

    ``connections`` are the pairs with no third place on the way. ``start`` is where the robot is at first, empty where
    that is not told.
    """

    places: Tuple[str, ...]
    distances: Dict[Pair, float]
    connections: Tuple[Pair, ...]
    start: str = ""

    def facts(self) -> str:
        """The floor as facts: place/1, connection/2, distance/3, in decimetres and both directions, and start/1."""
        lines = [" ".join(f"place({place})." for place in self.places), ""]
        lines += [_WAYS, *(f"connection({a},{b})." for a, b in self.connections)] if self.connections else []
        lines += ["", _DISTANCES, *(f"distance({a},{b},{d}). distance({b},{a},{d})." for a, b, d in self._decimetres())]
        lines += ["", _START, f"start({self.start})."] if self.start else []
        return "\n".join(lines) + "\n"

    def _decimetres(self) -> List[Tuple[str, str, int]]:
        return [(a, b, max(1, round(10 * metres))) for (a, b), metres in self.distances.items()]


def floor_of(costmap: Costmap, labels: LabelTable, detour: float = DETOUR) -> Floor:
    """Plan between all pairs of labels on the map alone, with the costmap's limits; raises FloorError.

    Ways are as long as those of navfn, which keep away from walls as the limits' inflation tells. A place is on the way
    between two others where the way over it is longer by the part ``detour`` at most.
    """
    planner, faults = GridPlanner(), []
    for label in labels:
        fault = _fault(planner, costmap, label)
        faults += [fault] if fault else []
    if faults:
        raise FloorError("\n".join(faults))
    names, distances = tuple(sorted(labels.names)), {}
    for number, a in enumerate(names):
        others = names[number + 1 :]
        lengths = navfn_lengths(costmap, _pose(labels[a]), [_pose(labels[b]) for b in others])
        for b, length in zip(others, lengths):
            plan = planner.plan(costmap, _pose(labels[a]), _pose(labels[b]), 0.0)
            if plan.outcome is PlanOutcome.FOUND:
                distances[a, b] = plan.length if length is None else length
    return Floor(names, distances, tuple(pair for pair in distances if not _between(names, distances, pair, detour)))


def floor_program(
    map_file: str, labels_file: str, limits: CostmapLimits, detour: float = DETOUR, start: str = ""
) -> str:
    """The floor of files (YAML) as a program, with ways on a costmap with these limits.

    The robot is at the label ``start`` at first, if one is named. Raises MapError, LabelError, FloorError.
    """
    for measure in ("robot_radius", "inflation_radius", "cost_scaling_factor"):
        if not 0.0 <= getattr(limits, measure) < np.inf:
            raise FloorError(f"{measure} is {getattr(limits, measure):g}, but must be a number from 0 on")
    labels = read_yaml(labels_file, "labels", LabelError)
    table = LabelTable.read(labels)
    labels.check(LabelError)
    if start and start not in table.names:
        raise FloorError(f"{labels_file}: there is no label {start}: it has {', '.join(sorted(table.names))}")
    floor = floor_of(Costmap(load_map(map_file), limits), table, detour)
    head = f"% The floor of {map_file} with {labels_file}, made by rosoclingo's command places."
    return f"{head}\n\n#program base.\n\n{floor._replace(start=start).facts()}"


def _between(names: Tuple[str, ...], distances: Dict[Pair, float], ends: Pair, detour: float) -> bool:
    """Whether some place is on the way between two others, and not where one of them is."""
    most = (1.0 + detour) * distances[ends]
    parts = [[distances.get((min(place, end), max(place, end)), np.inf) for end in ends] for place in names]
    return any(max(part) < distances[ends] and sum(part) <= most for part in parts)


def _fault(planner: GridPlanner, costmap: Costmap, label: Label) -> str:
    """Why nobody can be at a label; empty where one can."""
    found = planner.plan(costmap, _pose(label), _pose(label), 0.0).outcome
    return (
        "" if found is PlanOutcome.FOUND else f"{label.name}: ({label.x:g}, {label.y:g}): {found.value}: move the label"
    )


def _pose(label: Label) -> Pose2D:
    return Pose2D(label.x, label.y, label.yaw)
