"""The view of a run for pages: tables of goals, cycles, actions, places and log lines, as JSON.

Times are seconds of the run's clock since the first request, fact or action.
"""

import json
import math
from collections import defaultdict
from typing import Any, DefaultDict, Dict, Iterable, List, Mapping, Optional, Sequence, Set, Tuple, Union

from rosoclingo.common.labels import LabelError, LabelTable
from rosoclingo.oclingo import OclingoError, ProgressionError, StreamUpdate, parse_term, parse_update
from rosoclingo.planning.history import History
from rosoclingo.reasoning.keywords import (
    ACTION_LIB,
    CANCEL_ACTION,
    REQUEST,
    RETURN,
    STATUS,
    Action,
    Return,
    is_keyword,
    name_of,
    return_of,
    shortened,
)
from rosoclingo.runs.action_records import ActionRecords
from rosoclingo.runs.drawing import Drawings, drawings_of
from rosoclingo.runs.events import (
    ENDED,
    PENDING,
    SAID,
    STATUS_WORDS,
    WAITING,
    GoalReport,
    reason_of,
    reason_suffix,
    status_word,
)
from rosoclingo.runs.log_lines import BEGUN, RunLog
from rosoclingo.runs.recorded_run import RecordingError, RunCollector, RunProgram
from rosoclingo.runs.run_tables import PlannedActions, Point, Record, Revision, Table, Track, Words, thinned
from rosoclingo.runs.sentences import Sentences, sentences_of
from rosoclingo.runs.topic_atoms import action_in, return_in

#: Limit of characters of an external text on a page.
SHOWN = 2000

#: Limit of actions of a plan in a line of the log.
LISTED = 8

#: The mode of a core that dispatches actions, and the words for all modes.
RUNNING = "running"
MODES = {RUNNING: "continued", "paused": "paused: no action begins", "stopped": "stopped: the next goal continues"}

#: Minimum interval in seconds between two recorded paths to the same place.
PATHS_APART = 5.0

#: The status of a lost goal, which can still be followed by another status.
LOST = "lost"

#: Beliefs that other log lines report.
_REPORTED = (ACTION_LIB + "(", STATUS + "(")

#: A page's note about the parts of a run that a journal lacks.
LACKS = "a journal has no poses, map or packages, no lines of the core's log and no times of the solver"

#: Limit of records of all tables together, above which a live page begins again with the present state.
MOST = 50000


class RunView:
    """Collects the events of a run, in order, in tables; ``about`` has further texts of the page (title, verdict).

    A view can begin in the middle of a run, with the messages of the latched topics in any order. The log counts
    seconds since the first request, fact or action; ``with_state`` adds the program's beliefs to the log.

    Goals, actions, facts, reasons and lines of the log are in the program's sentences. A goal has ``words`` and its
    term as ``request``, an action ``words``, its ``deed`` without the robots, its ``kind`` without the parameter, and
    its terms. A state of a goal is [seconds, status, reason, details], a problem [seconds, text, details]; ``details``
    is the text with terms, empty if it is the same.

    Attributes:
        about: all data outside the tables.
        tables: the tables by name.
        seconds: the present time of the run's clock.
        drawings: the program's declarations of drawings.
        mode_word: whether the core dispatches actions: running, paused or stopped.
        believed: the program's beliefs.
        positions: x and y (m) of each of several robots by name, of an only robot by an empty name.
        dispatched_actions: the atoms of all dispatched actions, once each.

    """

    def __init__(self, about: Optional[Mapping[str, Any]] = None, with_state: bool = False) -> None:
        empty: Record = {"labels": {}, "titles": {}, "map": None, "run": 1, "pace": None}
        self.about: Record = {**empty, **(about or {}), "statuses": SAID}
        self._revision = Revision()
        self._about_changed = 1
        self.tables = {
            name: Table(self._revision)
            for name in (
                "goals",
                "cycles",
                "words",
                "actions",
                "packages",
                "terms",
                "beliefs",
                "shapes",
                "poses",
                "paths",
                "scans",
                "log",
            )
        }
        self._terms = Words(self.tables["terms"], lambda text: {"text": text})
        self._shapes = Words(self.tables["shapes"], json.loads)
        self._planned_actions = PlannedActions(self.tables["words"])
        self._sentences, self.drawings = Sentences(), Drawings()
        self.mode_word = RUNNING
        self.believed: Sequence[str] = ()
        self.positions: Dict[str, Point] = {}
        self._tracks: DefaultDict[str, Track] = defaultdict(Track)
        self._scans: Dict[str, int] = {}
        self._log, self._with_state = RunLog(self.enter), with_state
        self._goals: Dict[str, int] = {}
        self._history: Set[str] = set()  # goals that ended before this view
        self._met = self._planned = self._updated = False  # whether ~goals, a plan, an update has arrived
        self._cycles: Dict[int, int] = {}
        self._sent: Set[str] = set()
        self.dispatched_actions: List[str] = []
        self._actions = ActionRecords(self.tables["actions"], self._planned_actions)
        self._run = ""
        self._start: Optional[float] = None
        self._wall: Optional[Tuple[float, float]] = None
        self.seconds = 0.0

    # ---- events -----------------------------------------------------------------------------------------------------

    def describe(self, **values: Any) -> None:
        """Change the data in ``about``."""
        self.about.update(values)
        self._about_changed = self._revision.next()

    def program(self, time: float, text: str) -> None:
        """Record the program of a core."""
        try:
            found = RunProgram.parse(text)
            table = LabelTable.from_mapping(found.settings.get("labels", {}))
        except (RecordingError, LabelError):
            return
        self.begin(found.run)
        known = self.drawings.faults
        self.sentences, self.drawings = sentences_of(found), drawings_of(found)
        for fault in self.drawings.faults if self.drawings.faults != known else ():
            self._log.add(self._now(time), "note", shortened(fault, SHOWN))
        labels = {one.name: [one.x, one.y, one.yaw] for one in table}
        self.describe(labels=labels, titles=self.sentences.titles)
        beliefs, shapes = self.tables["beliefs"], self._drawn_shapes()
        if beliefs.last is None:
            beliefs.add(time=0.0, cycle=1, atoms=[], shapes=shapes)
        elif beliefs.last["shapes"] != shapes:
            beliefs.change(len(beliefs) - 1)["shapes"] = shapes

    def resume(self, _history: History, cycle: int) -> None:
        """Begin with a journal, after the update of a cycle."""
        self.describe(lacks=f"{LACKS}; it begins with cycle {cycle}" if cycle > 1 else LACKS)

    def begin(self, run: str) -> None:
        """Record the id of the core's run; a new run starts with cycle 1 again."""
        if self._run and run != self._run:
            self._cycles, self._sent = {}, set()
            self._actions.forget()
            self.describe(run=self.about["run"] + 1)
            for key in [key for key, number in self._goals.items() if self.tables["goals"][number]["ended"] is None]:
                self._state((self._start or 0.0) + self.seconds, key, LOST, "the core was restarted")
        self._run = run

    def goal(self, time: float, key: str, text: str, heard: Optional[float] = None, after: Iterable[str] = ()) -> None:
        """Record a goal of a client, once; ``heard`` is the time of the first report, if that is later.

        ``after``: what the line of the log has to follow.
        """
        if key not in self._goals:
            now, shown, words = self._now(time, begins=True), shortened(text, SHOWN), self._goal_words(text)
            self._goals[key] = self.tables["goals"].add(
                id=key, request=shown, words=words, sent=now, ended=None, states=[[now, PENDING, "", ""]]
            )
            self._log.add(self._now(heard or time), "request", words, after, _as_fed(text), details=shown)

    def goals(self, time: float, reports: Sequence[GoalReport]) -> None:
        """Record the states of all goals; goals that ended before the first report are history."""
        after = () if self._met else (BEGUN,)  # lines about earlier goals wait for the first cycle
        for key, text, number, reason, came in reports:
            if key not in self._goals:
                if not self._met and 0 <= number < len(STATUS_WORDS) and STATUS_WORDS[number] in ENDED:
                    self._history.add(key)
                if key in self._history:
                    continue
                self.goal(came if 0.0 < came < time else time, key, text, time, after)
            self.status(time, key, number, reason, after)
        self._met = True

    def cancel(self, time: float, key: str) -> None:
        """Record a client's cancel of a goal; an empty key stands for all goals."""
        goal = self.tables["goals"][self._goals[key]] if key in self._goals else {"words": "every goal", "request": ""}
        self._log.add(self._now(time, begins=True), "cancel", goal["words"], details=goal["request"])

    def status(self, time: float, key: str, number: int, reason: str, after: Iterable[str] = ()) -> None:
        """Record a goal's status, also if it is repeated; a pending goal with a reason is queued.

        ``after``: what the line of the log has to follow.
        """
        if not 0 <= number < len(STATUS_WORDS):
            return
        word, before = status_word(number, reason), self.last_state(key)
        is_news = before is not None and before[0] != word and word not in (PENDING, WAITING)
        if self._state(time, key, word, reason) and is_news:
            goal = self.tables["goals"][self._goals[key]]
            _, _, said, details = goal["states"][-1]
            text = f"{goal['words']}: {SAID[word]}{reason_suffix(word, said)}"
            plain = f"{goal['request']}: {word}{reason_suffix(word, details or said)}"
            self._log.add(self._now(time), "goal", text, after, details=plain)

    def update(self, time: float, text: str) -> None:
        """Record an accepted stream update."""
        now = self._now(time, begins=True)
        step, sources, plain = None, set(), shortened(text, SHOWN)
        try:
            update = parse_update(text)
            step, sources, plain = update.step, self._sources(update), shortened(str(update.plain).strip(), 10 * SHOWN)
        except OclingoError:
            pass
        one = self._cycle(step if step is not None else self._last_cycle, now)
        one["updates"].append(plain)
        self._updated = True
        cycle = step or self._log.cycle + 1
        fed = " ".join(plain.split())
        self._log.add(now, "update", fed if step is None else f"step {step}", sources, f"update {step}", cycle, fed)

    def plan(
        self, time: float, cycle: int, horizon: int, actions: Sequence[str], times: Optional[Tuple[float, float]] = None
    ) -> None:
        """Record a plan, with the seconds of wall time for grounding and searching, if known."""
        now = self._now(time)
        planned = self._planned_actions.numbers(actions)
        ground, solve = (round(one, 4) if math.isfinite(one) else 0.0 for one in times) if times else (None, None)
        plan = {"time": now, "horizon": horizon, "actions": planned, "ground": ground, "solve": solve}
        self._cycle(cycle, now)["plans"].append(plan)
        ahead = [one for one in map(action_in, actions) if one is not None and one.cycle >= cycle]
        more = [f"and {len(ahead) - LISTED} more"] if len(ahead) > LISTED else []
        words = ", ".join([*map(self.sentences.of, ahead[:LISTED]), *more]) or "nothing to do"
        first = not self._updated and not actions
        late = not self._updated and not self._planned and (cycle > 1 or bool(actions))
        self._planned = True
        after = () if first or late else (f"update {cycle}",)
        self._log.add(now, "plan", words, after, "" if first else f"plan {cycle}", cycle if late else 0)

    def dispatched(self, time: float, facts: Sequence[str]) -> None:
        """Record dispatched actions, once each, and cancellations."""
        fresh = [text for text in facts if text.startswith((ACTION_LIB, CANCEL_ACTION)) and text not in self._sent]
        now = self._now(time, begins=bool(fresh))
        self._sent.update(fresh)
        self._actions.dispatched(now, fresh)
        for text in fresh:
            if text.startswith(CANCEL_ACTION):
                words = self._planned_actions.words(ACTION_LIB + text[len(CANCEL_ACTION) :])
                self._log.add(now, "preempt", words, details=text)
            else:
                self.dispatched_actions.append(text)
                action, words = action_in(text), self._planned_actions.words(text)
                self._log.add(now, "action", words, {f"plan {action.cycle if action else 0}"}, details=text)

    def returned(self, time: float, origin: str, facts: Sequence[str]) -> None:
        """Record facts of an interface."""
        for text in facts:
            now, answer = self._now(time, begins=True), return_in(text)
            if answer is None:
                words = f"{shortened(self.sentences.fact(text), SHOWN)} from {shortened(origin)}"
                self._log.add(now, "fact", words, details=f"{shortened(text, SHOWN)} from {shortened(origin)}")
            else:
                words = shortened(self._return_words(answer, self._actions.returned(now, answer)), SHOWN)
                self._log.add(now, "return", words, gives=str(answer.atom), details=text)

    def packages(self, time: float, packages: Iterable[Tuple[str, str]]) -> None:
        """Record the places of all packages: labels, the names of robots, or empty for the only robot."""
        places = sorted(packages)
        last = self.tables["packages"].last
        if last is None or last["places"] != places:
            self.tables["packages"].add(time=self._now(time), places=places)

    def beliefs(self, time: float, cycle: int, atoms: Sequence[str]) -> None:
        """Record the program's beliefs, with their drawings."""
        before, now = frozenset(self.believed), frozenset(atoms)
        self.believed = atoms
        terms, shapes = self._terms.numbers([shortened(atom) for atom in atoms]), self._drawn_shapes()
        last = self.tables["beliefs"].last
        if last is None or (last["atoms"], last["shapes"]) != (terms, shapes):
            self.tables["beliefs"].add(time=self._now(time), cycle=cycle, atoms=terms, shapes=shapes)
        words = [sign + one for sign, found in (("+", now - before), ("-", before - now)) for one in sorted(found)]
        news = [one for one in words if not one[1:].startswith(_REPORTED)]
        if news and self._with_state:
            self._log.add(self._now(time), "state", " ".join(news), (BEGUN,))

    def mode(self, time: float, mode: str) -> None:
        """Record whether the core dispatches actions, if it has changed."""
        if mode != self.mode_word:
            self.mode_word = mode
            self._log.add(self._now(time), "mode", shortened(MODES.get(mode, mode)))

    def problem(self, time: float, cycle: int, text: str) -> None:
        """Record a problem from the core's log."""
        now, plain = self._now(time), shortened(text, SHOWN)
        words = self.sentences.replace(plain)
        self._cycle(cycle, now)["problems"].append([now, words, plain if words != plain else ""])
        self._log.add(now, "note", words, details=plain)

    def pose(self, time: float, x: float, y: float, yaw: float, robot: str = "") -> None:
        """Record the robot's pose (m, rad), or that of one of several robots."""
        if not all(map(math.isfinite, (x, y, yaw))):
            return
        self.positions[robot] = x, y
        track = self._tracks[robot]
        if track.add(x, y, yaw):
            now = round(max(0.0, time - self._start), 2) if self._start is not None else 0.0
            pose = [round(one, 3) for one in (x, y, yaw)]
            self.tables["poses"].add(time=now, robot=robot, pose=pose, metres=round(track.metres, 2))

    def path(self, time: float, points: Sequence[Tuple[float, float]]) -> None:
        """Record the robot's planned path."""
        finite = [(x, y) for x, y in points if math.isfinite(x) and math.isfinite(y)]
        kept = [[round(x, 2), round(y, 2)] for x, y in thinned(finite)]
        now, last = self._now(time), self.tables["paths"].last
        if last is None or last["points"][-1:] != kept[-1:] or now - last["time"] >= PATHS_APART:
            self.tables["paths"].add(time=now, points=kept)

    def scan(self, time: float, topic: str, points: Sequence[Tuple[float, float]]) -> None:
        """Record the latest scan of a laser."""
        scan = {"time": self._now(time), "topic": topic, "points": [[round(x, 2), round(y, 2)] for x, y in points]}
        if topic in self._scans:
            self.tables["scans"].change(self._scans[topic]).update(scan)
        else:
            self._scans[topic] = self.tables["scans"].add(**scan)

    def floor(self, image: Optional[Record]) -> None:
        """Record the image of the map."""
        self.describe(map=image)

    def wall(self, time: float, seconds: float) -> None:
        """Measure the pace of the run's clock by wall time (s)."""
        if self._start is None or not math.isfinite(seconds):
            return
        self._wall = self._wall or (time, seconds)
        passed = seconds - self._wall[1]
        if passed >= 1.0:
            self.about["pace"] = round((time - self._wall[0]) / passed, 2)

    def clock(self, time: float) -> None:
        """Advance the run's clock without another event."""
        if self._start is not None:
            self._log.clock(self._now(time))

    def finish(self) -> None:
        """Write all delayed lines."""
        self._log.finish()

    @property
    def sentences(self) -> Sentences:
        """The program's sentences; new ones replace those of the known actions and goals."""
        return self._sentences

    @sentences.setter
    def sentences(self, sentences: Sentences) -> None:
        self._sentences = sentences
        self._planned_actions.reword(sentences)
        for number in self._goals.values():
            goal = self.tables["goals"][number]
            words = self._goal_words(goal["request"])
            if goal["words"] != words:
                self.tables["goals"].change(number)["words"] = words

    # ---- queries ----------------------------------------------------------------------------------------------------

    @property
    def revision(self) -> int:
        """The number of changes up to now."""
        return self._revision.number

    def has_ended(self, key: str) -> bool:
        """Return whether a goal is known and has ended."""
        number = self._goals.get(key)
        return key in self._history if number is None else self.tables["goals"][number]["ended"] is not None

    def last_state(self, key: str) -> Optional[Tuple[str, str]]:
        """Return the latest status of a goal and its reason; None for an unknown goal."""
        number = self._goals.get(key)
        if number is None:
            return None
        _, word, reason, _ = self.tables["goals"][number]["states"][-1]
        return word, reason

    @property
    def full(self) -> bool:
        """Whether the tables have more than MOST records."""
        return sum(map(len, self.tables.values())) > MOST

    def changes(self, revision: int = 0) -> Record:
        """Return the changes since a revision: records by table and number, and the present revision."""
        return {
            "revision": self._revision.number,
            "seconds": round(self.seconds, 2),
            "about": self.about if self._about_changed > revision else None,
            **{name: table.changes_since(revision) for name, table in self.tables.items()},
        }

    # ---- records ----------------------------------------------------------------------------------------------------

    def _now(self, time: float, begins: bool = False) -> float:
        """Return the time since the beginning of the run, 0 before; ``begins``: this event starts the run."""
        if self._start is None and not begins:
            return 0.0
        if self._start is None:
            self._start = time
        now = round(max(0.0, time - self._start), 2)
        self.seconds = max(self.seconds, now)
        return now

    @property
    def _last_cycle(self) -> int:
        return max(self._cycles, default=1)

    def _cycle(self, cycle: int, now: float) -> Record:
        if cycle not in self._cycles:
            self._cycles[cycle] = self.tables["cycles"].add(
                cycle=cycle, run=self.about["run"], time=now, updates=[], plans=[], problems=[]
            )
        return self.tables["cycles"].change(self._cycles[cycle])

    def _drawn_shapes(self) -> List[int]:
        """Return the numbers of the drawings of the program's beliefs."""
        found = self.drawings.of(self.believed, self.about["labels"].keys())
        texts = [
            json.dumps({"kind": one.kind.value, "labels": one.labels, "text": shortened(one.text)}) for one in found
        ]
        return self._shapes.numbers(texts)

    def _sources(self, update: StreamUpdate) -> Set[str]:
        """Return the requests and returns in an update, which other topics publish first."""
        heads = [one for one in update.heads if one is not None]
        requests = [one.arguments[0] for one in heads if is_keyword(one, REQUEST)]
        goals = {str(one) for one in requests if not is_keyword(one, "cancel")}
        answers = (return_of(one) for one in heads if is_keyword(one, RETURN))
        return goals | {str(self._actions.as_sent(one).atom) for one in answers}

    def _state(self, time: float, key: str, word: str, message: str) -> bool:
        """Record a goal's status if it has changed; return whether it has."""
        number = self._goals.get(key)
        if number is None:
            return False
        goal = self.tables["goals"][number]
        plain = shortened(reason_of(goal["request"], message), SHOWN)
        reason = self.sentences.reason(_as_fed(goal["request"]), plain)
        details = plain if reason != plain else ""
        last = goal["states"][-1]
        if last[1:] == [word, reason, details] or (goal["ended"] is not None and last[1] != LOST):
            return False
        now = self._now(time)
        goal = self.tables["goals"].change(number)
        goal["states"].append([now, word, reason, details])
        goal["ended"] = now if word in ENDED else None
        return True

    def _return_words(self, answer: Return, record: Optional[Record]) -> str:
        """Return the words for a return; without a ``record``, it arrived before its action, or has none."""
        value = name_of(answer.value)
        if record is not None:
            end = value if record["failed"] or record["preempted"] else "done"
            return f"{self._planned_actions[record['action']]['words']}: {end}"
        action = Action(answer.interface, answer.value, answer.cycle)  # the action that has succeeded, if it is planned
        done = str(action.atom) in self._planned_actions
        return f"{self.sentences.of(action)}: done" if done else f"{self.sentences.kind(action)}: {value}"

    def _goal_words(self, text: str) -> str:
        return shortened(self.sentences.goal(text), SHOWN)

    def enter(self, time: float, cycle: int, kind: str, text: str, details: str) -> None:
        """Add a line to the log: seconds since the beginning, cycle, kind, text and details."""
        line = {"text": shortened(text, SHOWN), "details": shortened(details, SHOWN)}
        self.tables["log"].add(time=round(time, 2), cycle=cycle, kind=kind, **line)


#: A consumer of the events of a run, whose sources are a core's topics, live or from a bag, and its journal: a view for
#: pages and accounts, or a collector of the cycles of a replay. Times are in seconds of the run's clock.
RunEvents = Union[RunView, RunCollector]


def _as_fed(text: str) -> str:
    """Return a goal in the form of an update, with normalized spaces."""
    try:
        return str(parse_term(text))
    except ProgressionError:
        return text
