"""An account of a run for people: a line for each event, and a summary."""

from contextlib import suppress
from dataclasses import dataclass, field
from typing import (
    Any,
    Callable,
    Collection,
    Dict,
    Iterable,
    List,
    Mapping,
    NamedTuple,
    Optional,
    Sequence,
    Set,
    Tuple,
)

from clingo import Symbol

from rosoclingo.common.labels import LabelError, LabelTable
from rosoclingo.oclingo import OclingoError, ProgressionError, Statement, parse_term, parse_update
from rosoclingo.reasoning.keywords import (
    ACTION_LIB,
    CANCEL_ACTION,
    REQUEST,
    RETURN,
    STATUS,
    is_keyword,
    name_of,
)
from rosoclingo.runs.believed_places import CARRIED, believed_places
from rosoclingo.runs.drawing import Drawings, drawings_of
from rosoclingo.runs.events import GoalTold, RunEvents
from rosoclingo.runs.recorded_run import RecordingError, RunProgram
from rosoclingo.runs.sentences import Sentences, sentences_of
from rosoclingo.runs.topic_atoms import action_in, return_in

#: Words for actionlib's status numbers (actionlib_msgs/GoalStatus), as a summary uses them.
STATUS_WORDS = (
    "pending",
    "active",
    "canceled",
    "succeeded",
    "aborted",
    "rejected",
    "canceling",
    "canceling",
    "canceled",
    "lost",
)

#: The words that end a goal.
ENDED = frozenset({"canceled", "succeeded", "aborted", "rejected", "lost"})

#: What the state has of plan and goals, which are told otherwise.
_TOLD = (ACTION_LIB + "(", STATUS + "(")

#: What the first plan gives: which cycle it is.
_BEGUN = "begun"

#: So many of the actions a summary names.
_LATEST = 40

#: Metres from a label in which the robot is there.
TOLERANCE = 0.5

#: Seconds of the run's clock for which a line waits for one that belongs before it: topics overtake each other.
PATIENCE = 1.0

Enter = Callable[[float, int, str, str], None]


@dataclass
class GoalAccount:
    """What became of one goal, with actionlib's id as its ``key``."""

    text: str
    status: str = "pending"
    message: str = ""
    key: str = ""


@dataclass
class Summary:
    """The totals of a run.

    ``packages`` maps each package to its label or "carried"; ``robot`` is empty where nobody has told its place;
    ``seconds`` are of the run's clock.
    """

    goals: List[GoalAccount] = field(default_factory=list)
    actions: List[str] = field(default_factory=list)
    returns: List[str] = field(default_factory=list)
    updates: List[str] = field(default_factory=list)
    packages: Dict[str, str] = field(default_factory=dict)
    robot: str = ""
    seconds: float = 0.0

    def differences(
        self, expect: Mapping[str, Any], before: int = 0, sent: Optional[Collection[str]] = None
    ) -> List[str]:
        """Return the differences of the run from a scenario's ``expect``; empty for none.

        ``before`` is the number of the core's cycles before the scenario; it is subtracted from those of actions.
        ``sent`` are the keys of its goals, None for all of the run.
        """
        found: Dict[str, Any] = {
            "goals": [goal.status for goal in self.goals if sent is None or goal.key in sent],
            "packages": {key: self.packages.get(key) for key in expect.get("packages", {})},
            "robot": self.robot,
            "actions": [_earlier(text, before) for text in self.actions] if before else self.actions,
        }
        return [f"{key}: expected {expect[key]}, found {found[key]}" for key in expect if expect[key] != found[key]]

    def lines(self) -> List[str]:
        """The summary as text."""
        goals = [f"{one.text}: {one.status}{_because(one)}" for one in self.goals]
        places = sorted(set(self.packages.values()))
        packages = ["packages {}: {}".format(place, ", ".join(self._at(place))) for place in places]
        robot = [f"robot: {self.robot}"] if self.robot else []
        return [*goals, *packages, *robot, f"actions: {self._done()}"]

    def _done(self) -> str:
        """The actions, or the latest of many."""
        actions = ", ".join(_action(text) for text in self.actions[-_LATEST:]) or "none"
        more = len(self.actions) > _LATEST
        return f"{len(self.actions)}, the last {_LATEST} of them {actions}" if more else actions

    def _at(self, place: str) -> List[str]:
        return sorted(key for key in self.packages if self.packages[key] == place)


class _Line(NamedTuple):
    time: float  # seconds of the run's clock
    kind: str
    text: str
    after: Set[str]
    gives: str
    cycle: int = 0  # which begins with it, 0 for none


class Account(RunEvents):
    """Says each event of a run as one line.

    Lines count seconds since the first request, fact or action, as reports and pages do.

    It may begin in the midst of a run: then with what the latched topics have, in whatever order. ``with_state`` it
    says what the program believes as well.

    The robot's place is the program's label within TOLERANCE of its pose, or the shown place if there is no pose.
    Places of things come from the event ``packages``, else from shown atoms.

    Attributes:
        sentences: how actions are said.

    """

    def __init__(self, say: Callable[[str], None], enter: Optional[Enter] = None, with_state: bool = False) -> None:
        """``say`` gets each line, ``enter`` what is in it: seconds since the run began, cycle, kind and text."""
        self._say = say
        self._enter = enter
        self.sentences = Sentences()
        self._with_state = with_state
        self._atoms: Sequence[str] = ()
        self._labels = LabelTable()
        self._drawings: Optional[Drawings] = None  # of the program, once received
        self._pose: Optional[Tuple[float, float]] = None
        self._has_packages = False
        self._planned = self._met = False  # whether a plan, and the goals, were told
        self._goals: Dict[str, GoalAccount] = {}
        self._start: Optional[float] = None
        self._cycle = 0
        self._now = 0.0
        self._held: List[_Line] = []
        self._said: Set[str] = set()
        self._run = ""
        self._sent: Set[str] = set()  # the actions of that run
        self.summary = Summary()

    def begin(self, run: str) -> None:
        """Take the name of the core's run: the actions of another one are others, whatever their cycles."""
        if run != self._run:
            self._run, self._sent = run, set()

    def goal(self, time: float, key: str, text: str) -> None:
        """Record a goal that a client sent; once, whoever tells of it."""
        if key in self._goals:
            return
        self._goals[key] = GoalAccount(text, key=key)
        self.summary.goals.append(self._goals[key])
        self._line(time, "request", text, gives=_as_fed(text))

    def program(self, time: float, text: str) -> None:
        """Record the program: its words, and where its labels are."""
        with suppress(RecordingError, LabelError):
            program = RunProgram.parse(text)
            self.sentences, self._drawings = sentences_of(program), drawings_of(program)
            self._labels = LabelTable.from_mapping(program.settings.get("labels", {}))
        self._place()

    def goals(self, time: float, told: Sequence[GoalTold]) -> None:
        """Record how all goals stand.

        What the account has not heard of itself is new, but at first: then it goes on already, or is history.
        """
        for key, text, number, message, _ in told:
            if self._met:
                self.goal(time, key, text)
            elif key not in self._goals:
                self._goals[key] = GoalAccount(text, key=key)
                if STATUS_WORDS[number] in ENDED:
                    self._goals[key].status = STATUS_WORDS[number]
                    continue
                self.summary.goals.append(self._goals[key])
                self._goals[key].status = ""
            self._status(time, key, number, message, () if self._met else (_BEGUN,))
        self._met = True

    def beliefs(self, time: float, cycle: int, atoms: Sequence[str]) -> None:
        """Record the program's beliefs, and say which are new, except for plan and goals."""
        before, now = frozenset(self._atoms), frozenset(atoms)
        words = [sign + one for sign, found in (("+", now - before), ("-", before - now)) for one in sorted(found)]
        news = [one for one in words if not one[1:].startswith(_TOLD)]
        if news and self._with_state:
            self._line(time, "state", " ".join(news), {_BEGUN}, begins=False)
        self._atoms = atoms
        self._place()

    def cancel(self, time: float, key: str) -> None:
        """Record that a client cancelled a goal; an empty key stands for all of them."""
        self._line(time, "cancel", self._goals[key].text if key in self._goals else "every goal")

    def status(self, time: float, key: str, number: int, message: str) -> None:
        """Record a goal's status, as often as it is published."""
        self._status(time, key, number, message)

    def _status(self, time: float, key: str, number: int, message: str, after: Iterable[str] = ()) -> None:
        goal = self._goals.get(key)
        word = STATUS_WORDS[number]
        if goal is None or goal.status == word or goal.status in ENDED:
            return
        goal.status, goal.message = word, message
        self._line(time, "goal", f"{goal.text}: {word}{_because(goal)}", after)

    def update(self, time: float, text: str) -> None:
        """Record a stream update that the core fed."""
        self.summary.updates.append(text)
        step, sources, plain = _read_update(text)
        self._line(time, "update", " ".join(plain.split()), sources, f"update {step}", step or self._cycle + 1)

    def plan(
        self, time: float, cycle: int, horizon: int, actions: Sequence[str], times: Optional[Tuple[float, float]] = None
    ) -> None:
        """Record the plan of a cycle; what is past is left out of the line."""
        ahead = ", ".join(_action(text) for text in actions if _cycle_of(text) >= cycle) or "nothing to do"
        first = not self.summary.updates and not actions
        late = not self._planned and (cycle > 1 or bool(actions)) and not self.summary.updates
        self._planned = True
        after = set() if first or late else {f"update {cycle}"}
        self._line(time, "plan", ahead, after, "" if first else f"plan {cycle}", cycle if late else 0, begins=False)

    def dispatched(self, time: float, facts: Sequence[str]) -> None:
        """Record actions on out_rosoclingo, once each however often they are sent, and what ends them early."""
        for text in facts:
            if text.startswith(CANCEL_ACTION):
                self._line(time, "preempt", self._sentence(ACTION_LIB + text[len(CANCEL_ACTION) :]))
            elif text not in self._sent:
                self._sent.add(text)
                self.summary.actions.append(text)
                self._line(time, "action", self._sentence(text), {f"plan {_cycle_of(text)}"})

    def returned(self, time: float, origin: str, facts: Sequence[str]) -> None:
        """Record facts on in_rosoclingo."""
        for text in facts:
            answer = return_in(text)
            if answer is None:
                self._line(time, "fact", f"{text} from {origin}")
            else:
                self.summary.returns.append(text)
                words = f"{name_of(answer.interface)} {name_of(answer.value)}"
                self._line(time, "return", words, gives=str(answer.atom))

    def packages(self, time: float, packages: Iterable[Tuple[str, str]]) -> None:
        """Record where all packages are."""
        self._has_packages = True
        self.summary.packages = {key: place or CARRIED for key, place in packages}

    def pose(self, time: float, x: float, y: float, yaw: float) -> None:
        """Record where the robot is."""
        self._pose = x, y
        self._place()

    def _place(self) -> None:
        """Find the places of robot and things."""
        if self._drawings is None:
            return
        labels = {label.name for label in self._labels}
        believed = believed_places(self._atoms, self._drawings, labels)
        if not self._has_packages:
            self.summary.packages = dict(believed.things)
        self.summary.robot = believed.robot
        if self._pose is not None and labels:
            label = self._labels.nearest(*self._pose, TOLERANCE)
            self.summary.robot = "away from every label" if label is None else label.name

    def note(self, time: float, text: str) -> None:
        """Record anything else worth a line."""
        self._line(time, "note", text, begins=False)

    def clock(self, time: float) -> None:
        """Write the lines that have been held back for long enough at a time, though nothing else came."""
        while self._release(time):
            pass

    def finish(self) -> None:
        """Write the lines that are still held back."""
        for line in self._held:
            self._print(line)
        self._held = []

    def _sentence(self, text: str) -> str:
        action = action_in(text)
        return text if action is None else self.sentences.of(action)

    def _line(
        self,
        time: float,
        kind: str,
        text: str,
        after: Iterable[str] = (),
        gives: str = "",
        cycle: int = 0,
        begins: bool = True,
    ) -> None:
        """Take a line; a request, fact or action ``begins`` a run."""
        if self._start is None and begins:
            self._start = time
        self.summary.seconds = max(self.summary.seconds, self._elapsed(time))
        self._held.append(_Line(time, kind, text, set(after), gives, cycle))
        self.clock(time)

    def _elapsed(self, time: float) -> float:
        return 0.0 if self._start is None else max(0.0, time - self._start)

    def _release(self, now: float) -> bool:
        for line in self._held:
            if line.after <= self._said or now - line.time > PATIENCE:
                self._held.remove(line)
                self._said.update({line.gives, _BEGUN} if line.kind == "plan" else {line.gives})
                self._print(line)
                return True
        return False

    def _print(self, line: _Line) -> None:
        self._cycle = line.cycle or self._cycle
        self._now = max(self._now, self._elapsed(line.time))
        cycle = max(1, self._cycle)
        self._say(f"{self._now:7.1f} s  cycle {cycle:<3d} {line.kind:8s} {line.text}")
        if self._enter is not None:
            self._enter(self._now, cycle, line.kind, line.text)


def _because(goal: GoalAccount) -> str:
    """The reason of an end that went against the goal; success and cancellation speak for themselves."""
    if goal.status not in ("aborted", "rejected", "lost"):
        return ""
    text = reason_of(goal.text, goal.message)
    return f" ({text})" if text else ""


def reason_of(request: str, message: str) -> str:
    """A status' message without the goal that it begins with."""
    return (message[len(request) :] if message.startswith(request) else message).strip()


def _read_update(text: str) -> Tuple[Optional[int], Set[str], str]:
    """An update's step if it has one, the requests and returns in it that other topics had before, and what it says."""
    try:
        update = parse_update(text)
    except OclingoError:
        return None, set(), text
    heads = [item.head for item in update.items if isinstance(item, Statement) and item.head is not None]
    return update.step, {_source(head) for head in heads} - {""}, str(update.plain)


def _source(head: Symbol) -> str:
    if is_keyword(head, REQUEST):
        goal = head.arguments[0]
        return "" if is_keyword(goal, "cancel") else str(goal)
    return str(head) if is_keyword(head, RETURN) else ""


def _as_fed(text: str) -> str:
    """A goal as an update has it, where its client wrote it with other spaces."""
    try:
        return str(parse_term(text))
    except ProgressionError:
        return text


def _action(text: str) -> str:
    action = action_in(text)
    return text if action is None else f"{action.interface_name} {name_of(action.parameter)}"


def _earlier(text: str, cycles: int) -> str:
    action = action_in(text)
    return text if action is None else str(action._replace(cycle=action.cycle - cycles).atom)


def _cycle_of(text: str) -> int:
    action = action_in(text)
    return 0 if action is None else action.cycle
