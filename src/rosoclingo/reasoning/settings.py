"""Settings of the core, with the defaults of its parameters."""

from dataclasses import dataclass

#: Seconds of wall time that the next action waits for a plan with new goals while the current plan continues.
JOINING = 0.3


@dataclass(frozen=True)
class CoreSettings:
    """Limits of planning and waiting.

    Attributes:
        horizon_limit: maximum number of steps of a plan for one goal, from the current cycle on.
        action_timeout: seconds after which an action without a return fails with ``timeout``; 0 waits for ever.
        preempt: whether running actions that a new plan does not contain are ended at once.
        goals_at_once: maximum number of goals that the program has at a time; further goals are queued, and the oldest
            is admitted first. 0 for no limit.
        overtaking_limit: maximum number of newer goals that can end before a goal. Once it is reached, no newer goal is
            admitted until this one has ended. A goal in a plan with more goals has their number as its limit.
            0 for no limit.
        search_timeout: seconds of processor time after which a search is ended, 0 for never. Admission chooses the
            number of goals so that searches stay well below it.
        learn_durations: whether the median durations of successful actions are stated to a program that declares
            ``#external _takes/3``.
        interface_timeout: seconds of wall time without a message, after which an interface is silent; 0 for never. Used
            if the program declares ``_lost/2``.
        lost_timeout: seconds of wall time for which an action of a silent interface can still return; then it fails
            with ``lost``. 0 waits for ``action_timeout``.

    """

    horizon_limit: int = 100
    action_timeout: float = 600.0
    preempt: bool = False
    goals_at_once: int = 0
    overtaking_limit: int = 20
    search_timeout: float = 10.0
    learn_durations: bool = True
    interface_timeout: float = 10.0
    lost_timeout: float = 60.0
