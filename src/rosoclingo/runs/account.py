"""The account of a run: a line of text for each event, and a summary."""

from dataclasses import dataclass, field
from typing import Any, Callable, Collection, Dict, List, Mapping, Optional

from rosoclingo.common.labels import Label, LabelTable
from rosoclingo.runs.believed_places import CARRIED, believed_places
from rosoclingo.runs.events import SAID, reason_suffix
from rosoclingo.runs.run_tables import Point, Record
from rosoclingo.runs.run_view import RunView
from rosoclingo.runs.sentences import Sentences
from rosoclingo.runs.topic_atoms import action_in

#: Limit of actions in a summary, the latest.
_LATEST = 40

#: Distance in metres below which the robot counts as at a label.
TOLERANCE = 0.5


@dataclass
class Summary:
    """The final state of a run.

    ``goals`` are records of :class:`RunView`. ``packages`` maps each package to its label, "carried", or the name of
    one of several robots; ``robot`` is empty if its place is unknown; ``robots`` has the places of several robots;
    ``seconds`` is the duration by the run's clock. ``sentences`` are the program's.
    """

    goals: List[Record] = field(default_factory=list)
    actions: List[str] = field(default_factory=list)
    packages: Dict[str, str] = field(default_factory=dict)
    robot: str = ""
    seconds: float = 0.0
    robots: Dict[str, str] = field(default_factory=dict)
    sentences: Sentences = field(default_factory=Sentences)

    def differences(
        self, expect: Mapping[str, Any], before: int = 0, sent: Optional[Collection[str]] = None
    ) -> List[str]:
        """Return the differences of the run from a scenario's ``expect``.

        ``before`` is the number of the core's cycles before the scenario, which is subtracted from cycles of actions.
        ``sent`` are the keys of the scenario's goals, None for all goals of the run.
        """
        found: Dict[str, Any] = {
            "goals": [one["states"][-1][1] for one in self.goals if sent is None or one["id"] in sent],
            "packages": {key: self.packages.get(key) for key in expect.get("packages", {})},
            "robot": self.robot,
            "robots": {name: self.robots.get(name) for name in expect.get("robots", {})},
            "actions": [_earlier(text, before) for text in self.actions] if before else self.actions,
        }
        return [f"{key}: expected {expect[key]}, found {found[key]}" for key in expect if expect[key] != found[key]]

    def lines(self) -> List[str]:
        """Return the summary as lines of text."""
        ends = ((one["words"], *one["states"][-1][1:3]) for one in self.goals)
        goals = [f"{words}: {SAID[status]}{reason_suffix(status, reason)}" for words, status, reason in ends]
        places = sorted(set(self.packages.values()))
        packages = ["packages {}: {}".format(place, ", ".join(self._at(place))) for place in places]
        robot = [f"robot: {self.robot}"] if self.robot else []
        robot += [f"robot {name}: {place}" for name, place in sorted(self.robots.items())]
        return [*goals, *packages, *robot, f"actions: {self._done()}"]

    def _done(self) -> str:
        """Return the text about the actions, or about the latest of many."""
        found = ((text, action_in(text)) for text in self.actions[-_LATEST:])
        words = (text if action is None else self.sentences.of(action) for text, action in found)
        actions = ", ".join(words) or "none"
        more = len(self.actions) > _LATEST
        return f"{len(self.actions)}, the last {_LATEST} of them {actions}" if more else actions

    def _at(self, place: str) -> List[str]:
        return sorted(key for key in self.packages if self.packages[key] == place)


class Account(RunView):
    """A view of a run that passes each line of its log to ``say``; ``with_state`` adds the program's beliefs.

    The robot's place is the program's label within TOLERANCE of its pose, or the shown place if there is no pose. The
    places of things come from the topic of packages, else from shown atoms.
    """

    def __init__(self, say: Callable[[str], None], with_state: bool = False) -> None:
        super().__init__(with_state=with_state)
        self._say = say

    def enter(self, time: float, cycle: int, kind: str, text: str, details: str) -> None:
        """Print a line of the log; an update as it was fed."""
        self._say(f"{time:7.1f} s  cycle {cycle:<3d} {kind:8s} {details or text if kind == 'update' else text}")

    @property
    def summary(self) -> Summary:
        """The summary up to now."""
        goals = [record for _, record in self.tables["goals"].changes_since(0)]
        places = self.tables["packages"].last
        believed = believed_places(self.believed, self.drawings, self.about["labels"].keys())
        packages = believed.things
        if places is not None:
            packages = {key: place or CARRIED for key, place in places["places"]}
        position, actions = self.positions.get(""), list(self.dispatched_actions)
        robot = self._place(position) if position is not None and self.about["labels"] else believed.robot
        robots = {name: self._place(position) for name, position in self.positions.items() if name}
        robots = robots or dict(believed.robots)
        return Summary(goals, actions, packages, robot, self.seconds, robots, self.sentences)

    def _place(self, position: Point) -> str:
        labels = LabelTable(tuple(Label(name, *pose) for name, pose in self.about["labels"].items()))
        label = labels.nearest(*position, TOLERANCE)
        return "away from every label" if label is None else label.name


def _earlier(text: str, cycles: int) -> str:
    action = action_in(text)
    return text if action is None else str(action._replace(cycle=action.cycle - cycles).atom)
