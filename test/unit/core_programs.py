"""Small programs for tests of the core."""

from pathlib import Path

from core_driver import ERRANDS

DATA = Path(__file__).resolve().parents[1] / "data"

#: Errands do(What,Id), none in a cycle in which the battery is low. Nothing is remembered of those that are over.
BATTERY = (DATA / "battery.lp").read_text() + "#program cumulative(t).\n"

#: What was done in cycle 1 cannot have been in cycle 3.
IMPOSSIBLE = BATTERY + ":- _action_lib(walk,1,t-2).\n"

#: Nothing can follow this fact.
DOOMED = ERRANDS + ":- _seen(end).\n"

#: No answer before this fact.
DARK = ERRANDS + "#program base.\n:- not _seen(sun).\n"

#: Goals go(Room,Id). A door seen shut in a cycle can't have been gone through in the next.
DOORS = """
#external _request/2. #external _return/3. #external _shut/2.
#program base.
room(hall). room(den). door(hall,den). door(den,hall). at(hall,0).
#program cumulative(t).
wanted(R,I,t) :- _request(go(R,I),t+1).
wanted(R,I,t) :- wanted(R,I,t-1), not at(R,t-1), not _request(cancel(I),t).
{ _action_lib(go,R,t) : door(Q,R), at(Q,t-1) } 1 :- wanted(_,_,t).
at(R,t) :- _action_lib(go,R,t), not failed(t).
at(R,t) :- at(R,t-1), not moved(t).
moved(t) :- _action_lib(go,R,t), not failed(t).
failed(t) :- _return(go,V,t), not room(V).
:- _action_lib(go,R,t), _shut(R,t-1).
#program volatile(t).
:- wanted(R,I,t), not at(R,t).
#program base.
#show _action_lib/3.
"""

#: Goals fetch(Thing,Id), which an arm has or not; HEEDED says how a failure counts, ONE how many it grasps at once.
FETCH = """
#external _request/2. #external _return/3. #external _seen/1. #external _loud/2.
#program cumulative(t).
wanted(X,I,t) :- _request(fetch(X,I),t+1).
wanted(X,I,t) :- wanted(X,I,t-1), not have(X,t-1), not _request(cancel(I),t).
{ _action_lib(arm,X,t) : wanted(X,I,t) } ONE.
have(X,t) :- have(X,t-1).
have(X,t) :- _action_lib(arm,X,t)HEEDED.
noise(t) :- _seen(X), _loud(X,t).
#program volatile(t).
:- wanted(X,I,t), not have(X,t).
#program base.
#show _action_lib/3. #show _status/3. #show held(X,t) : have(X,t). #defined _status/3.
#program cumulative(t).
"""

#: What it says of its goals.
STATUS = """
_status(I,accepted,t) :- wanted(X,I,t).
_status(I,succeeded,t) :- wanted(X,I,t-1), have(X,t-1).
_status(I,canceled,t) :- _request(cancel(I),t), wanted(X,I,t-1), not have(X,t-1).
"""

FAILED = "failed(t) :- _return(A,V,t), not _action_lib(A,V,t).\n"


def fetch(heeded="", one="1", rules=""):
    """The program of FETCH."""
    return FETCH.replace("HEEDED", heeded).replace("ONE", one) + rules
