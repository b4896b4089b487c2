"""The account of a run: a line of text for each event, and a summary."""

from typing import Any, Callable, Collection, Dict, List, Mapping, Optional

from rosoclingo.common.labels import Label, LabelTable
from rosoclingo.runs.believed_places import CARRIED, Places, believed_places
from rosoclingo.runs.events import SAID, reason_suffix
from rosoclingo.runs.run_tables import Point
from rosoclingo.runs.run_view import RunView
from rosoclingo.runs.topic_atoms import action_in

#: Limit of actions in a summary, the latest.
_LATEST = 40

#: Distance in metres below which the robot counts as at a label.
TOLERANCE = 0.5


class Account(RunView):
    """A view of a run that passes each line of its log to ``say``; ``with_state`` adds the program's beliefs."""

    def __init__(self, say: Callable[[str], None], with_state: bool = False) -> None:
        super().__init__(with_state=with_state)
        self._say = say

    def enter(self, time: float, cycle: int, kind: str, text: str, details: str) -> None:
        """Print a line of the log; an update as it was fed."""
        super().enter(time, cycle, kind, text, details)
        self._say(f"{time:7.1f} s  cycle {cycle:<3d} {kind:8s} {details or text if kind == 'update' else text}")

    @property
    def places(self) -> Places:
        """The present places.

        A robot's place is the program's label within TOLERANCE of its pose, or the shown place if there is no pose. The
        places of things come from the topic of packages, else from shown atoms.
        """
        shown = believed_places(self.believed, self.drawings, self.about["labels"].keys())
        reported, position = self.tables["packages"].last, self.positions.get("")
        things = shown.things if reported is None else {key: place or CARRIED for key, place in reported["places"]}
        robot = shown.robot if position is None or not self.about["labels"] else self._place(position)
        robots = {name: self._place(position) for name, position in self.positions.items() if name}
        return Places(robot, things, robots or shown.robots)

    def _place(self, position: Point) -> str:
        labels = LabelTable(tuple(Label(name, *pose) for name, pose in self.about["labels"].items()))
        label = labels.nearest(*position, TOLERANCE)
        return "away from every label" if label is None else label.name

    def differences(
        self, expect: Mapping[str, Any], before: int = 0, sent: Optional[Collection[str]] = None
    ) -> List[str]:
        """Return the differences of the run from a scenario's ``expect``.

        ``before`` is the number of the core's cycles before the scenario, which is subtracted from cycles of actions.
        ``sent`` are the keys of the scenario's goals, None for all goals of the run.
        """
        robot, things, robots = self.places
        found: Dict[str, Any] = {
            "goals": [one["states"][-1][1] for one in self.tables["goals"] if sent is None or one["id"] in sent],
            "packages": {key: things.get(key) for key in expect.get("packages", {})},
            "robot": robot,
            "robots": {name: robots.get(name) for name in expect.get("robots", {})},
            "actions": [_earlier(text, before) for text in self.dispatched_actions],
        }
        return [f"{key}: expected {expect[key]}, found {found[key]}" for key in expect if expect[key] != found[key]]

    def summary(self) -> List[str]:
        """Return the final state of the run as lines of text."""
        ends = ((one["words"], *one["states"][-1][1:3]) for one in self.tables["goals"])
        goals = [f"{words}: {SAID[status]}{reason_suffix(status, reason)}" for words, status, reason in ends]
        robot, things, robots = self.places
        there = {place: sorted(key for key in things if things[key] == place) for place in sorted(set(things.values()))}
        packages = ["packages {}: {}".format(place, ", ".join(names)) for place, names in there.items()]
        own = [f"robot: {robot}"] if robot else []
        own += [f"robot {name}: {place}" for name, place in sorted(robots.items())]
        return [*goals, *packages, *own, f"actions: {self._executed()}"]

    def _executed(self) -> str:
        """Return the text about the actions, or about the latest of many."""
        texts = self.dispatched_actions
        found = ((text, action_in(text)) for text in texts[-_LATEST:])
        words = (text if action is None else self.sentences.of(action) for text, action in found)
        actions = ", ".join(words) or "none"
        return f"{len(texts)}, the last {_LATEST} of them {actions}" if len(texts) > _LATEST else actions


def _earlier(text: str, cycles: int) -> str:
    action = action_in(text)
    return text if action is None or not cycles else str(action._replace(cycle=action.cycle - cycles).atom)
