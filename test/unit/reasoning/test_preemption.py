"""With preempt, an action under way that the new plan does not contain ends at once; all others are awaited."""

from core_driver import ERRANDS, FaultyDriver
from core_scripts import play, scripts

from rosoclingo.reasoning.settings import CoreSettings

#: Several errands are done at once.
TOGETHER = ERRANDS.replace("W != quick } 1.", "W != quick }.")

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


#: The program observes which actions are ended; no action returns ``preempted`` otherwise.
HEARS = ERRANDS + "#external _cancel/3.\n#program cumulative(t).\n:- _return(W,preempted,t), not _cancel(W,_,t).\n"

PREEMPTIONS = {
    "action that nobody wants": (ERRANDS, """
        goal a do(walk,1); cancel a; ends walk,1,1; does walk,1,1; cycle 1; unsent ...cancel...; run; facts _seen(ball)
        ends walk,1,1; facts _return(walk,preempted,1); is a preempted; does"""),
    "program that hears of the actions that are ended": (HEARS, """
        goal a do(walk,1); cancel a; ends walk,1,1; facts _return(walk,preempted,1); is a preempted; problems 0
        sends :- not _action_lib(walk,1,1). _request(cancel(1),2). _cancel(walk,1,1). _return(walk,preempted,1)."""),
    "action that is still wanted, with other plans as short": (ERRANDS, """
        goal a do(walk,1); goal b do(run,2); facts _seen(ball); ends; cancel b; finish; is a succeeded; ends"""),
    "one of two actions": (TOGETHER, """
        add a do(walk,1); goal b do(run,2); does run,2,1 walk,1,1; cancel a; ends walk,1,1
        facts _return(walk,preempted,1); does run,2,1; cancel b; ends walk,1,1 run,2,1"""),
    "shorter way opens": (WAYS, """
        goal a go(1); does far,1,1; facts _open(near); ends far,1,1; facts _return(far,preempted,1); does near,1,2"""),
    "way that is as short but better opens": (WAYS + ":~ _action_lib(far,I,C). [1,I,C]", """
        goal a go(1); facts _open(side); ends"""),
}  # fmt: skip


@scripts(PREEMPTIONS)
def test_preemption_follows_the_script(row):
    text, script = row
    play(FaultyDriver(text, CoreSettings(horizon_limit=8, preempt=True)), script)
