"""The command ``request``: sends a goal to the core."""

from functools import partial
from typing import Callable

import rospy

from rosoclingo.msg import ROSoClingoFeedback
from rosoclingo.nodes.goal_client import GoalClient
from rosoclingo.nodes.server_watch import Beginning
from rosoclingo.nodes.words import words_of
from rosoclingo.runs.events import SAID, reason_of, reason_suffix
from rosoclingo.runs.sentences import Sentences

Line = Callable[[ROSoClingoFeedback], str]
End = Callable[[GoalClient], str]

#: Exit codes by outcome.
EXIT_CODES = {"succeeded": 0, "canceled": 2, "rejected": 3, "aborted": 4, "lost": 5}

#: Seconds of wall time between two checks of a goal without news.
_TURN = 0.2


def request(text: str, server: str, wait: float, say: Callable[[str], None], plain: bool = False) -> int:
    """Send a goal, print its feedback and its end, and return an exit code of EXIT_CODES; Ctrl-C cancels the goal.

    The feedback is the plan. With ``plain`` it is the current actions in the program's words, or a missing interface,
    and the end is in these words, too.

    The goal is lost if its server does not start within ``wait`` seconds of wall time, or disappears later. A server
    that waits for ROS time to begin counts as present.

    Subscribes:
        CORE/program (std_msgs/String): the program, once, for its words.
    Actions called:
        SERVER (rosoclingo/ROSoClingoAction): the action server ``server``.
    """
    goal = GoalClient(server)
    try:
        there = goal.wait_for_server(wait)
    except KeyboardInterrupt:
        say(f"stopped waiting for the action server '{server}'; nothing was sent")
        return EXIT_CODES["lost"]
    if not there:
        still = "" if rospy.get_time() else "; ROS time has not begun, so the core publishes no status"
        say(f"no action server '{server}' within {wait:g} s: is the core running?{still}")
        return EXIT_CODES["lost"]
    words = words_of(goal.node) if plain else None
    line = _line if words is None else partial(_plain_line, words)
    end = _end if words is None else partial(_plain_end, words)
    goal.send(text)
    return _follow(goal, line, end, say)


def _follow(goal: GoalClient, line: Line, end: End, say: Callable[[str], None]) -> int:
    """Print news of a goal until it has ended; return the exit code."""
    said, cancelled, beginning = "", False, Beginning()
    while not goal.outcome:
        try:
            text = beginning.line() or (line(goal.feedback) if goal.feedback is not None else "")
            if text and text != said:
                said = text
                say(text)
            goal.wait(_TURN)
            goal.check()
        except KeyboardInterrupt:
            if cancelled:
                say("stopped waiting; the cancel request was sent")
                return EXIT_CODES["lost"]
            cancelled = True
            say(f"cancelling {goal.text} (Ctrl-C again: do not wait)")
            goal.cancel()
    say(end(goal))
    return EXIT_CODES[goal.outcome]


def _plain_line(words: Sentences, feedback: ROSoClingoFeedback) -> str:
    return words.now(feedback.cycle, feedback.status, feedback.task_plan[feedback.position :])


def _line(feedback: ROSoClingoFeedback) -> str:
    plan = " ".join(feedback.task_plan[feedback.position :]) or "nothing to do"
    return f"cycle {feedback.cycle}, {feedback.status}: {plan}"


def _end(goal: GoalClient) -> str:
    return f"{goal.outcome}: {goal.message}"


def _plain_end(words: Sentences, goal: GoalClient) -> str:
    reason = words.reason(goal.text, reason_of(goal.text, goal.message))
    return f"{words.goal(goal.text)}: {SAID[goal.outcome]}{reason_suffix(goal.outcome, reason)}"
