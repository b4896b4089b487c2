"""One goal on its way for one action."""

from typing import Any, Optional

from rosoclingo.interfaces.action_runs import Instant, Limits, Run
from rosoclingo.interfaces.doubt import Inquiry
from rosoclingo.interfaces.inbox import Sender
from rosoclingo.interfaces.link import new_goal_id
from rosoclingo.interfaces.templates import Ended
from rosoclingo.reasoning.keywords import Action


class Attempt:
    """One goal on its way for one action.

    In doubt it has an inquiry: somebody has sent a goal for the action before, and nobody here has heard its end.
    """

    def __init__(self, action: Action, goal: Any, asked_by: Sender, limits: Limits, now: Instant) -> None:
        self.action = action
        self.goal = goal
        self.asked_by = asked_by
        self.limits = limits
        self.run = Run(limits, now)
        self.goal_id = new_goal_id()
        self.handle: Optional[Any] = None
        self.ended: Optional[Ended] = None
        self.inquiry: Optional[Inquiry] = None
        self.stale_status: Any = None  # the server's last status message before the inquiry
        self.lost: Optional[Ended] = None  # how it ended without a word of its server
        self.unwanted = False  # cancelled while in doubt, or the interface ends: nothing is sent again

    def again(self, now: Instant) -> "Attempt":
        """The next attempt at the same action."""
        limits = self.limits._replace(retries=self.limits.retries - 1)
        return Attempt(self.action, self.goal, self.asked_by, limits, now)
