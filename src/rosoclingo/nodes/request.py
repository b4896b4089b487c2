"""The command ``request``: sends a goal to the core."""

from typing import Callable, Optional

import rospy

from rosoclingo.nodes.goal_client import GoalClient
from rosoclingo.nodes.missing_ros import Beginning
from rosoclingo.nodes.words import words_of
from rosoclingo.runs.events import SAID, reason_suffix
from rosoclingo.runs.sentences import Sentences

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
    goal.send(text)
    return _follow(goal, words, say)


def _follow(goal: GoalClient, words: Optional[Sentences], say: Callable[[str], None]) -> int:
    """Print news of a goal until it has ended; return the exit code."""
    said, cancelled, beginning = "", False, Beginning()
    while not goal.outcome:
        try:
            text = beginning.line() or _line(goal, words)
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
    say(_end(goal, words))
    return EXIT_CODES[goal.outcome]


def _line(goal: GoalClient, words: Optional[Sentences]) -> str:
    """Return the latest feedback: the plan, or with ``words`` the current actions; empty before the first."""
    feedback = goal.feedback
    if feedback is None:
        return ""
    plan = feedback.task_plan[feedback.position :]
    if words is not None:
        return words.now(feedback.cycle, feedback.status, plan)
    return f"cycle {feedback.cycle}, {feedback.status}: {' '.join(plan) or 'nothing to do'}"


def _end(goal: GoalClient, words: Optional[Sentences]) -> str:
    if words is None:
        return f"{goal.outcome}: {goal.message}"
    reason = words.reason(goal.text, goal.message)
    return f"{words.goal(goal.text)}: {SAID[goal.outcome]}{reason_suffix(goal.outcome, reason)}"
