"""Places of a map as a logic program sees them, with connections and distances."""

from typing import Dict, List, NamedTuple, Tuple

import numpy as np

from rosoclingo.common.labels import Label, LabelError, LabelTable
from rosoclingo.common.reading import read_yaml
from rosoclingo.robot.navigation.costmap import Costmap, CostmapLimits
from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.navigation.grid import load_map
from rosoclingo.robot.navigation.grid_planner import GridPlanner, PlanOutcome
from rosoclingo.robot.navigation.inflated_ways import navfn_lengths

#: Maximum relative detour at which a place counts as lying between two others.
DETOUR = 0.1

Pair = Tuple[str, str]

#: Comments that keep the linter from reporting facts that a program does not use.
_WAYS = "% check: ok unused (for programs that drive from place to place)"
_DISTANCES = "% check: ok unused (for programs that prefer short drives)"
_START = "% check: ok unused (for programs with a start of their own)"


class FloorError(ValueError):
    """Labels that do not fit the map. The text lists all faults, each with a remedy."""


class Floor(NamedTuple):
    """Places of a map: sorted labels, path lengths between them, and connections.

    ``distances`` (m) contains each reachable pair once, in sorted order. ``connections`` are the pairs without a third
    place between them. ``start`` is the initial place of the robot, or empty if unknown.
    """

    places: Tuple[str, ...]
    distances: Dict[Pair, float]
    connections: Tuple[Pair, ...]
    start: str = ""

    def facts(self) -> str:
        """Return the facts place/1, connection/2, distance/3 (decimetres, in both directions) and start/1."""
        lines = [" ".join(f"place({place})." for place in self.places), ""]
        lines += [_WAYS, *(f"connection({a},{b})." for a, b in self.connections)] if self.connections else []
        lines += ["", _DISTANCES, *(f"distance({a},{b},{d}). distance({b},{a},{d})." for a, b, d in self._decimetres())]
        lines += ["", _START, f"start({self.start})."] if self.start else []
        return "\n".join(lines) + "\n"

    def _decimetres(self) -> List[Tuple[str, str, int]]:
        return [(a, b, max(1, round(10 * metres))) for (a, b), metres in self.distances.items()]


def floor_of(costmap: Costmap, labels: LabelTable, detour: float = DETOUR) -> Floor:
    """Plan paths between all pairs of labels on the static map. Raises FloorError.

    Paths are as long as those of navfn, which keep away from walls according to the inflation of the costmap's limits.
    ``detour`` is the maximum relative detour at which a place counts as lying between two others.
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
    """Return the places of a map file and a labels file (YAML) as a program.

    ``limits`` configure the costmap on which paths are planned. ``start`` is the label of the robot's initial place, if
    known. Raises MapError, LabelError, FloorError.
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
    """Return whether a third place lies between two others. A place at one of the ends does not count."""
    most = (1.0 + detour) * distances[ends]
    parts = [[distances.get((min(place, end), max(place, end)), np.inf) for end in ends] for place in names]
    return any(max(part) < distances[ends] and sum(part) <= most for part in parts)


def _fault(planner: GridPlanner, costmap: Costmap, label: Label) -> str:
    """Return why the robot cannot be at a label; empty if it can."""
    found = planner.plan(costmap, _pose(label), _pose(label), 0.0).outcome
    return (
        "" if found is PlanOutcome.FOUND else f"{label.name}: ({label.x:g}, {label.y:g}): {found.value}: move the label"
    )


def _pose(label: Label) -> Pose2D:
    return Pose2D(label.x, label.y, label.yaw)
