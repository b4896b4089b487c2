"""An attempt at an action: one goal and its state."""

from typing import Any, Optional, Tuple

from clingo import Symbol

from rosoclingo.interfaces.action_runs import ActionLimits, Instant, Run
from rosoclingo.interfaces.answers import INTERRUPTED, LOST, SUCCEEDED, conclude
from rosoclingo.interfaces.facts import Sender
from rosoclingo.interfaces.inquiry import Inquiry
from rosoclingo.interfaces.link import CANCELLED, new_goal_id
from rosoclingo.interfaces.templates import GoalEnd
from rosoclingo.reasoning.keywords import Action


class Attempt:
    """One goal for one action, from its creation to its end.

    The attempt has an inquiry while the outcome of an earlier goal for the action is unknown.
    """

    def __init__(self, action: Action, goal: Any, sender: Sender, limits: ActionLimits, now: Instant) -> None:
        self.action = action
        self.goal = goal
        self.sender = sender
        self.limits = limits
        self.run = Run(limits, now)
        self.goal_id = new_goal_id()
        self.handle: Optional[Any] = None
        self.ended: Optional[GoalEnd] = None
        self.inquiry: Optional[Inquiry] = None
        self.stale_status: Any = None  # the server's last status message before the inquiry
        self.lost: Optional[GoalEnd] = None  # the end of the goal if its server was lost
        self.cancelled = False  # by the core or by a shutdown: no goal is sent any more
        self.uncertain = False  # an earlier goal was sent, and its outcome is unknown
        self.former: Optional[GoalEnd] = None  # the end of the previous goal, None if none was sent

    @property
    def conclusion(self) -> GoalEnd:
        """The end of the attempt; after an earlier goal of unknown outcome it is never `preempted`."""
        ended = conclude(self.run.verdict, self.ended)
        if self.run.cancel_ignored:
            return ended._replace(text="its goal was cancelled, and the action server has not ended it")
        if self.uncertain and ended.status in CANCELLED:
            return ended._replace(status=LOST, text="an earlier goal of the action has an unknown outcome")
        never_sent = self.run.verdict == "preempted"
        return self.former if never_sent and self.former is not None else ended

    def should_retry(self, ended: GoalEnd, value: Symbol, retry_on: Tuple[str, ...]) -> bool:
        """Return whether to send another goal: the server ended this goal, for a reason in ``retry_on``."""
        final = self.cancelled or self.run.cancel_ignored or ended.status in (SUCCEEDED, INTERRUPTED, "interface_lost")
        return not final and self.limits.retries > 0 and str(value).partition("(")[0] in retry_on

    def next_attempt(self, ended: GoalEnd, now: Instant) -> "Attempt":
        """Return the next attempt at the same action, after ``ended``, the end of this attempt."""
        limits = self.limits._replace(retries=self.limits.retries - 1)
        following = Attempt(self.action, self.goal, self.sender, limits, now)
        sent = self.ended is not None or self.lost is not None or self.handle is not None
        following.uncertain, following.former = self.uncertain, ended if sent else self.former
        return following
