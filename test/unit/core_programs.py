"""Small programs for tests of the core."""

from core_driver import ERRANDS
from shipped import DATA

#: Errands do(What,Id), except while the battery is low. Past ones are forgotten.
BATTERY = (DATA / "battery.lp").read_text() + "#program cumulative(t).\n"

#: The action of cycle 1 is impossible in cycle 3.
IMPOSSIBLE = BATTERY + ":- _action_lib(walk,1,t-2).\n"

#: No answer exists after this fact.
DOOMED = ERRANDS + ":- _seen(end).\n"

#: No answer exists before this fact.
DARK = ERRANDS + "#program base.\n:- not _seen(sun).\n"

#: Goals go(Room,Id). If a door is seen closed, nobody can pass it in the next cycle.
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

#: Goals fetch(Thing,Id), by an arm that grasps. HEEDED says how a failure counts, ONE how many things it grasps at
#: once.
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

#: The statuses of its goals.
STATUS = """
_status(I,accepted,t) :- wanted(X,I,t).
_status(I,succeeded,t) :- wanted(X,I,t-1), have(X,t-1).
_status(I,canceled,t) :- _request(cancel(I),t), wanted(X,I,t-1), not have(X,t-1).
"""

FAILED = "failed(t) :- _return(A,V,t), not _action_lib(A,V,t).\n"


def fetch(heeded="", one="1", rules=""):
    """Return the program of FETCH."""
    return FETCH.replace("HEEDED", heeded).replace("ONE", one) + rules


#: Goals ``reach(Room,Id)``: doors, which ``_shut(D)`` closes for good, lead to rooms. A room is entered at most once
#: where that failed, and never after a room that it clashes with.
ROOMS = """
#external _request/2. #external _return/3. #external _shut/1.
#program base.
{doors}
{clashes}
#program cumulative(t).
asked(R,I,t) :- _request(reach(R,I),t+1).
open(R,I,t) :- asked(R,I,t), not gone(I,t).
open(R,I,t) :- open(R,I,t-1), not entered(R,t-1), not gone(I,t).
gone(I,t) :- _request(cancel(I),t).
failed(R,t) :- _return(enter,V,t), V != R, _action_lib(enter,R,t).
entered(R,t) :- _action_lib(enter,R,t), not failed(R,t).
lost(R,t) :- failed(R,t).
lost(R,t) :- lost(R,t-1).
barred(R) :- door(R,D), _shut(D).
{{ _action_lib(enter,R,t) : open(R,I,t), not lost(R,t-1), not barred(R) }} 1.
been(R,t) :- entered(R,t).
been(R,t) :- been(R,t-1).
:- been(R,t), been(S,t), clash(R,S).
{words}
#program volatile(t).
:- open(R,I,t), not entered(R,t).
#program base.
#show _action_lib/3. #show _explain/3.
#defined door/2. #defined clash/2. #defined _explain/3.
"""


def rooms(doors=(), clashes=(), words=""):
    """Return the program of ROOMS with doors (room, door), pairs of rooms that clash, and further rules."""
    return ROOMS.format(
        doors=" ".join(f"door({room},{door})." for room, door in doors),
        clashes=" ".join(f"clash({one},{other})." for one, other in clashes),
        words=words,
    )
