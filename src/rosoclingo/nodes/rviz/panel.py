"""The panel below the map in rviz: a title, and side by side the plan and the goals with their reasons."""

import textwrap
from typing import List, Sequence, Tuple

from rosoclingo.nodes.rviz.canvas import LINE_HEIGHT, Canvas, Point, text_width
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


def draw_panel(canvas: Canvas, top: Point, frame: str, title: str = "", plan: str = "", goals: str = "") -> None:
    """Draw the panel from the centre of its upper edge (m): the title, as large as fits, plan and goals."""
    size = min(TITLE_SIZE, WIDTH / text_width(title, 1.0)) if title else 0.0
    down = 2 * GAP + LINE_HEIGHT * TITLE_SIZE
    for group, text, right, below, height in (
        ("title", title, 0.0, GAP, size),
        ("plan", plan, -0.25 * WIDTH, down, WORDS_SIZE),
        ("goals", goals, 0.25 * WIDTH, down, WORDS_SIZE),
    ):
        if text:  # rviz centres a text at its position
            half = 0.5 * (text.count("\n") + 1) * LINE_HEIGHT * height
            place = (top[0] + canvas.factor * right, top[1] - canvas.factor * below - half, top[2])
            canvas.text(group, frame, text, place, size=height)


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
