"""One goal on its way for one action."""

from typing import Any, Optional, Tuple

from clingo import Symbol

from rosoclingo.interfaces.action_runs import ActionLimits, Instant, Run
from rosoclingo.interfaces.answers import INTERRUPTED, LOST, SUCCEEDED, conclude
from rosoclingo.interfaces.doubt import Inquiry
from rosoclingo.interfaces.facts import Sender
from rosoclingo.interfaces.link import TAKEN, new_goal_id
from rosoclingo.interfaces.templates import Ended
from rosoclingo.reasoning.keywords import Action


class Attempt:
    """One goal on its way for one action.

    In doubt it has an inquiry: somebody has sent a goal for the action before, and nobody here has heard its end.
    """

    def __init__(self, action: Action, goal: Any, asked_by: Sender, limits: ActionLimits, now: Instant) -> None:
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
        self.unwanted = False  # cancelled, or the interface ends: nothing is sent again
        self.doubtful = False  # an earlier goal was sent, and its outcome is unknown
        self.former: Optional[Ended] = None  # the end of the previous goal, None if none was sent

    @property
    def conclusion(self) -> Ended:
        """The attempt's end. After an earlier goal of unknown outcome it is never that nothing has happened."""
        ended = conclude(self.run.verdict, self.ended)
        if self.run.unheeded:
            return ended._replace(text="its goal was cancelled, and the action server has not ended it")
        if self.doubtful and ended.status in TAKEN:
            return ended._replace(status=LOST, text="whether an earlier goal of the action was done is not known")
        never_sent = self.run.verdict == "preempted"
        return self.former if never_sent and self.former is not None else ended

    def is_worth_another(self, ended: Ended, value: Symbol, retry_on: Tuple[str, ...]) -> bool:
        """Tell whether to send another goal: this one failed for one of the reasons, and the server has ended it."""
        final = self.unwanted or self.run.unheeded or ended.status in (SUCCEEDED, INTERRUPTED, "interface_lost")
        return not final and self.limits.retries > 0 and str(value).partition("(")[0] in retry_on

    def again(self, ended: Ended, now: Instant) -> "Attempt":
        """Return the next attempt at the same action, after this one ended as ``ended``."""
        limits = self.limits._replace(retries=self.limits.retries - 1)
        following = Attempt(self.action, self.goal, self.asked_by, limits, now)
        sent = self.ended is not None or self.lost is not None or self.handle is not None
        following.doubtful, following.former = self.doubtful, ended if sent else self.former
        return following
