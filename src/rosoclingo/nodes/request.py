"""One goal sent from the command line."""

from typing import Callable

import rospy

from rosoclingo.nodes.goal_client import CoreClient, SentGoal

#: Exit codes by outcome.
EXIT_CODES = {"succeeded": 0, "canceled": 2, "rejected": 3, "aborted": 4, "lost": 5}

#: Seconds of wall time between two looks at a goal that has no news.
_TURN = 0.2


def request(text: str, server: str, wait: float, say: Callable[[str], None]) -> int:
    """Send a goal, say its feedback and its end; Ctrl-C cancels it. Returns the exit code of EXIT_CODES.

    A server that is not there within ``wait`` seconds of wall time, or gone later, makes it lost.

    Actions called:
        SERVER (rosoclingo/ROSoClingoAction): that of ``server``.
    """
    client = CoreClient(server)
    if not client.wait_for_server(wait):
        still = "" if rospy.get_time() else "; ROS time has not begun, and the core tells its status by it"
        say(f"no action server '{server}' within {wait:g} s: is the core running?{still}")
        return EXIT_CODES["lost"]
    goal = client.send(text)
    cancelled = False
    while True:
        try:
            _follow(client, goal, say)
            break
        except KeyboardInterrupt:
            if cancelled:
                say("not waiting any longer; the goal was asked to be cancelled")
                return EXIT_CODES["lost"]
            cancelled = True
            say(f"cancelling {text} (Ctrl-C again: do not wait)")
            goal.cancel()
    say(f"{goal.outcome}: {goal.message}")
    return EXIT_CODES[goal.outcome]


def _follow(client: CoreClient, goal: SentGoal, say: Callable[[str], None]) -> None:
    """Say feedback, each line once, until the goal has ended."""
    shown = ""
    while not goal.ended:
        if goal.feedback is not None:
            line = _line(goal)
            if line != shown:
                say(line)
            shown = line
        client.wait(_TURN)
        client.check()


def _line(goal: SentGoal) -> str:
    feedback = goal.feedback
    plan = " ".join(feedback.task_plan[feedback.position :]) or "nothing to do"
    return f"cycle {feedback.cycle}, {feedback.status}: {plan}"
