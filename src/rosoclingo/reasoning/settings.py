"""How far to plan and how long to wait: the defaults of the core's parameters."""

from dataclasses import dataclass

#: Seconds of wall time that the next action waits for a plan with new goals while the plan in force goes on.
JOINING = 0.3


@dataclass(frozen=True)
class CoreSettings:
    """How far to plan and how long to wait.

    ``horizon_limit``: steps that a plan for one goal may reach beyond the current cycle. ``action_timeout``: seconds
    until an action that has not returned counts as failed with the value ``timeout``; 0 waits for ever. ``preempt``:
    whether an action under way that a new plan does not want is ended at once. ``goals_at_once``: goals that the
    program is told of at the same time; more of them wait, the oldest first; 0 for no limit. ``overtaking_limit``: so
    many goals may come later than a goal and end before it, or as many as it was planned for together with, if that is
    more; then no newer one is fed until it has ended; 0: any number.
    ``search_timeout``: seconds of processor time after which the watch over a search ends it, 0 for never: so many
    goals are planned for at a time as that is far from.
    """

    horizon_limit: int = 100
    action_timeout: float = 600.0
    preempt: bool = False
    goals_at_once: int = 0
    overtaking_limit: int = 20
    search_timeout: float = 10.0
