"""The panel below the map in rviz: a title, and side by side the plan and the goals with their reasons."""

import textwrap
from typing import List, NamedTuple, Sequence, Tuple

from rosoclingo.nodes.rviz.plain_shapes import LINE_HEIGHT, Point, Shape, text_shape, text_width
from rosoclingo.reasoning.keywords import Action, shortened
from rosoclingo.runs.events import ENDED, SAID, STATUS_WORDS, reason_suffix, status_word
from rosoclingo.runs.sentences import Sentences

TITLE_SIZE = 0.5
WORDS_SIZE = 0.28
GAP = 0.15  # below the map, and below the title

#: Limits of lines of plan and goals, below their headings, and of characters of a line.
LINES, LETTERS = 8, 44

#: Size of the panel in m, for a map of 16 m.
WIDTH = 16.0
HEIGHT = 2 * GAP + LINE_HEIGHT * (TITLE_SIZE + (LINES + 1) * WORDS_SIZE)

#: A goal as reported by the core: request, status as in actionlib_msgs/GoalStatus, and reason.
GoalRow = Tuple[str, int, str]


class Panel(NamedTuple):
    """The layout of the panel: the centre of its upper edge (m), and its scale, 1 for a map of 16 m."""

    top: Point
    frame: str
    factor: float = 1.0

    def title(self, text: str) -> List[Shape]:
        """Return the title, centred, as large as fits."""
        if not text:
            return []
        return [self._words("title", text, 0.0, GAP, min(TITLE_SIZE, WIDTH / text_width(text, 1.0)))]

    def plan(self, text: str) -> Shape:
        """Return the plan, on the left."""
        return self._words("plan", text, -0.25 * WIDTH, 2 * GAP + LINE_HEIGHT * TITLE_SIZE, WORDS_SIZE)

    def goals(self, text: str) -> Shape:
        """Return the goals, on the right."""
        return self._words("goals", text, 0.25 * WIDTH, 2 * GAP + LINE_HEIGHT * TITLE_SIZE, WORDS_SIZE)

    def _words(self, group: str, text: str, right: float, down: float, size: float) -> Shape:
        """Return a text with its upper edge at a place; rviz centres a text at its position."""
        x, y, z = self.top
        half = 0.5 * (text.count("\n") + 1) * LINE_HEIGHT * size
        place = (x + self.factor * right, y - self.factor * down - half, z)
        return text_shape(group, self.frame, text, place, size=size)


def plan_text(actions: Sequence[Action], cycle: int, sentences: Sentences) -> str:
    """Return the plan in words, a line for each action, with the current action marked and distant actions omitted."""
    lines = [f"{one.cycle}. {sentences.of(one)}{_mark(one, cycle)}" for one in actions]
    first = max(0, min(sum(action.cycle < cycle for action in actions) - 1, len(lines) - LINES))
    shown = lines[first : first + LINES]
    if len(lines) - first > LINES:
        shown[-1] = f"... {len(lines) - first - LINES + 1} more"
    state = "plan" if any(action.cycle >= cycle for action in actions) else "idle"
    return "\n".join([f"cycle {cycle}: {state}", *shown])


def _mark(action: Action, cycle: int) -> str:
    return "  done" if action.cycle < cycle else "  now" if action.cycle == cycle else ""


def goals_text(goals: Sequence[GoalRow], sentences: Sentences) -> str:
    """Return the goals in words, with the reasons why they wait or failed: open goals first, then the latest ended."""
    known = [(text, status_word(number, why), why) for text, number, why in goals if number < len(STATUS_WORDS)]
    still = [one for one in known if one[1] not in ENDED]
    ended = [one for one in known if one[1] in ENDED][::-1]
    lines: List[str] = []
    shown = 0
    for one in (*still, *ended):
        words = _goal(*one, sentences)
        if len(lines) + len(words) > LINES - (shown + 1 < len(known)):
            break
        lines, shown = lines + words, shown + 1
    more = [f"... {len(known) - shown} more"] if shown < len(known) else []
    counted = f"{len(still)} open, {len(ended)} ended" if known else "none"
    return "\n".join([f"goals: {counted}", *lines, *more])


def _goal(request: str, word: str, message: str, sentences: Sentences) -> List[str]:
    """Return the lines of a goal, at most half of LINES."""
    reason = sentences.reason(request, message)
    said = f"{SAID[word]}{reason_suffix(word, shortened(reason, 3 * LETTERS))}"
    text = f"{shortened(sentences.goal(request), LETTERS)}: {said}"
    return textwrap.wrap(text, LETTERS, subsequent_indent="    ", break_long_words=True)[: LINES // 2]
