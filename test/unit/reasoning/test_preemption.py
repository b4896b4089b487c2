"""With preempt, an action under way that the new plan does not contain ends at once; all others are awaited."""

import pytest
from core_driver import ERRANDS, Driver, FaultyDriver
from core_scripts import play, preempted, scripts
from office_world import World
from shipped import shipped

from rosoclingo.reasoning.settings import CoreSettings

#: Each goal has a drive and an arm movement in one cycle; the arm is useful only while the light is on.
TOGETHER = """
#external _request/2. #external _return/3.
#program cumulative(t).
#external _dark(t).
dim(t) :- _dark(t-1).
dim(t) :- dim(t-1).
open(I,t) :- _request(go(I),t+1), not gone(I,t).
open(I,t) :- open(I,t-1), not driven(I,t-1), not gone(I,t).
gone(I,t) :- _request(cancel(I),t).
_action_lib(drive,I,t) :- open(I,t).
_action_lib(arm,I,t) :- open(I,t), not dim(t).
failed(t) :- _return(drive,V,t), not open(V,t).
driven(I,t) :- open(I,t), not failed(t).
#program volatile(t).
:- open(I,t), not driven(I,t).
#program base.
#show _action_lib/3.
"""

#: One way leads through two actions, ``far`` and ``end``. After ``_open`` the action ``near`` is enough, and
#: ``side(1..5)`` equal ``far``.
WAYS = """
#external _request/2. #external _return/3. #external _open/1.
#program cumulative(t).
asked(I,t) :- _request(go(I),t+1).
asked(I,t) :- asked(I,t-1).
{ _action_lib(far,I,t); _action_lib(end,I,t) : half(I,t-1); _action_lib(near,I,t) : _open(near);
  _action_lib(side(1..5),I,t) : _open(side) } 1 :- asked(I,t).
failed(A,t) :- _return(A,preempted,t).
half(I,t) :- _action_lib(far,I,t), not failed(far,t).
half(I,t) :- _action_lib(side(N),I,t), not failed(side(N),t).
half(I,t) :- half(I,t-1).
there(I,t) :- _action_lib(end,I,t), not failed(end,t).
there(I,t) :- _action_lib(near,I,t), not failed(near,t).
there(I,t) :- there(I,t-1).
#program volatile(t).
:- asked(I,t), not there(I,t).
#program base.
#show _action_lib/3.
"""

#: Any number of actions can be executed at once, except two of one kind in later cycles.
FREE_WAYS = WAYS.replace(
    " 1 :- asked(I,t).", " :- asked(I,t).\n:- _action_lib(X,I,t), _action_lib(Y,I,t), X != Y, t > 1."
)

#: The program observes which actions are ended; no action returns ``preempted`` otherwise.
HEARS = ERRANDS + "#external _cancel/3.\n#program cumulative(t).\n:- _return(W,preempted,t), not _cancel(W,_,t).\n"

PREEMPTIONS = {
    "action that nobody wants": (ERRANDS, """
        goal a do(walk,1); cancel a; ends walk,1,1; does walk,1,1; cycle 1; unsent ...cancel...; run; facts _seen(ball)
        ends walk,1,1; facts _return(walk,preempted,1); is a preempted; does"""),
    "program that hears of the actions that are ended": (HEARS, """
        goal a do(walk,1); cancel a; ends walk,1,1; facts _return(walk,preempted,1); is a preempted; problems 0
        sends :- not _action_lib(walk,1,1). _request(cancel(1),2). _cancel(walk,1,1). _return(walk,preempted,1)."""),
    "place named preempted": (ERRANDS, """
        goal a do(walk,preempted); facts _seen(ball); ends ; succeed; is a succeeded"""),
    "action that is still wanted, with other plans as short": (ERRANDS, """
        goal a do(walk,1); goal b do(run,2); facts _seen(ball); ends; cancel b; finish; is a succeeded; ends"""),
    "actions of two cycles": (ERRANDS, """
        goal a do(walk,1); goal b do(run,2); cancel a; facts _return(walk,preempted,1); does run,2,2; cancel b
        ends walk,1,1 run,2,2"""),
    "one of two actions": (TOGETHER, """
        goal a go(1); does arm,1,1 drive,1,1; facts _dark(1); ends arm,1,1; facts _return(arm,preempted,1)
        does drive,1,1; cancel a; ends arm,1,1 drive,1,1"""),
    "shorter way opens": (WAYS, """
        goal a go(1); does far,1,1; facts _open(near); ends far,1,1; facts _return(far,preempted,1); does near,1,2"""),
    "ways that are as short open": (WAYS, "goal a go(1); facts _open(side); ends; finish; done far,1,1 end,1,2"),
    "way that is as short but better opens": (WAYS + ":~ _action_lib(far,I,C). [1,I,C]", """
        goal a go(1); facts _open(side); ends"""),
    "no plan begins in the past": (FREE_WAYS, "goal a go(1); does far,1,1; facts _open(side); ends"),
    "solver that refuses the question": (ERRANDS, """
        fault refused preempted; goal a do(walk,1); cancel a; ends; succeed; is a preempted"""),
    "program that does not know the return": (
        ERRANDS.replace("#external _return/3.", "#external _return(walk,(1;failed),1..9)."), """
        goal a do(walk,1); cancel a; ends; succeed; is a preempted"""),
    "no plan preempts nothing": (ERRANDS, "goal a do(walk,1); goal b do(never,2); ends; finish; is b aborted"),
    "question that is left for an arrival": (ERRANDS, "goal a do(walk,1); leave 1; cancel a; ends; run; ends walk,1,1"),
}  # fmt: skip


@scripts(PREEMPTIONS)
def test_preemption_follows_the_script(row):
    text, script = row
    play(FaultyDriver(text, CoreSettings(horizon_limit=8, preempt=True)), script)


def test_preemption_leaves_the_stream_unchanged():
    runs = [Driver(settings=CoreSettings(horizon_limit=8, preempt=preempt)) for preempt in (True, False)]
    for one in runs:
        play(one, "goal a do(walk,1); cancel a; goal b do(run,2); facts _return(walk,preempted,1); finish")
    assert len({(one.journal.stream, *one.journal.actions) for one in runs}) == 1


# -- a goal of the mailbot is cancelled in every phase of its life


class Office(Driver):
    """A driver whose actions change a world."""

    def __init__(self, preempt=False):
        self.world, self.preempt = World(), preempt
        super().__init__(settings=CoreSettings(preempt=preempt), program=shipped("mailbot.lp", "office.lp"))

    def ask(self, start, end, package):
        """Send a goal, whose key is the package's number, and create its package."""
        self.world.places[package] = f"office{start}"
        return self.goal(package, f"goal(office{start},office{end},{package})")

    def succeed(self):
        for action in self.core.awaited:
            self.world.do(action)
        return super().succeed()

    def until(self, action):
        """Let all actions succeed until an action of this interface and parameter is under way."""
        while not any(one.startswith(f"_action_lib({action},") for one in self.awaited):
            assert self.awaited, f"{action} is never under way"
            self.succeed()
        return self

    def preempts(self, *actions):
        """Expect these actions to be preempted by now."""
        assert preempted(self) == [f"_cancel({one})" for one in actions if self.preempt]

    def obey(self):
        """End the actions under way early with preempt."""
        return self.fail("preempted") if self.preempt else self.succeed()

    def lies(self, package, office):
        """Expect a package in an office."""
        assert self.world.places[package] == f"office{office}"


PHASES = {
    "before it was fed": """
        ask 3 2 1; ask 4 1 2; cancel 2; all 2 recalling recalled; finish; lies 1 2; lies 2 4; is 1 succeeded
        unsent ...office4...; preempts""",
    "driving to the pickup": """
        ask 3 2 1; until move_base,office3; cancel 1; preempts move_base,office3,2; does move_base,office3,2; obey
        is 1 preempted; does; lies 1 3""",
    "between pickup and delivery": """
        ask 3 1 1; until pickup,1; succeed; cancel 1; preempts move_base,office2,4; obey; is 1 preempting; finish
        is 1 preempted; lies 1 3""",
    "twice, and after the end": """
        ask 3 2 1; cancel 1; cancel 1; cancel nobody; preempts move_base,office2,1; obey; is 1 preempted; cancel 1
        is 1 preempted; sends ..._request(cancel(1),2)...; cycle 2""",
    "with an action that serves another goal": """
        ask 3 2 1; ask 3 2 2; succeed; does move_base,office3,2; cancel 1; preempts; finish; is 2 succeeded""",
}


@pytest.mark.sampled(4)
@pytest.mark.mostly_slow
@pytest.mark.parametrize("preempt", [False, True])
@scripts(PHASES)
def test_preemption_by_cancel_in_each_phase(preempt, row):
    play(Office(preempt), row)


@pytest.mark.slow
@pytest.mark.once
def test_preemption_by_the_core_is_no_failure():
    office = Office(preempt=True)
    for package in range(1, 6):
        play(office, f"ask 3 2 {package}; cancel {package}; fail preempted; is {package} preempted")
    play(office, "ask 3 2 6; finish; is 6 succeeded; problems 0")
    assert len(preempted(office)) == 5
