"""Programs of other domains as users could write them: correct ones, and faults for each."""

#: A vacuum cleaner drives through a ring of rooms and cleans the dirty ones; doors can be reported locked.
VACUUM = """
#program base.
cell(1..3). next(C,C+1) :- cell(C), cell(C+1). next(3,1).
pos(1,0).
#program cumulative(k).
#external _request/2. #external _return/3. #external _locked/2.
todo(C,k) :- _request(clean(C),k+1), cell(C), not _request(cancel(C),k).
todo(C,k) :- todo(C,k-1), not clean(C,k-1), not hopeless(k-1), not _request(cancel(C),k).
some(k) :- todo(C,k).
{ _action_lib(drive,D,k) : pos(C,k-1), next(C,D); _action_lib(suck,C,k) : pos(C,k-1), todo(C,k) } 1 :- some(k).
locked(C,k) :- _locked(C,k), cell(C).
bad(A,k) :- _action_lib(A,P,k), _return(A,V,k), V != P.
pos(D,k) :- _action_lib(drive,D,k), not bad(drive,k).
left(k) :- _action_lib(drive,D,k), not bad(drive,k).
pos(C,k) :- pos(C,k-1), not left(k).
clean(C,k) :- _action_lib(suck,C,k), not bad(suck,k).
hopeless(k) :- bad(A,k).
_status(C,accepted,k) :- todo(C,k).
_status(C,succeeded,k) :- todo(C,k-1), clean(C,k-1).
_status(C,aborted,k) :- todo(C,k-1), hopeless(k-1), not clean(C,k-1).
_status(C,canceled,k) :- _request(cancel(C),k), not clean(C,k-1), not hopeless(k-1).
#show _action_lib/3. #show _status/3. #show locked/2.
#program volatile(k).
:- todo(C,k), not clean(C,k), not hopeless(k).
"""

#: Two grippers: one of them takes a ball and puts it into the other room.
GRIPPER = """
#program base.
hand(left). hand(right). ball(red). ball(blue). room(a). room(b).
in(R,a,0) :- R = robot.
#program cumulative(t).
#external _request/2. #external _return/3. #external _slippery/2.
fetch(B,t) :- _request(fetch(B),t+1), ball(B), not _request(cancel(B),t).
fetch(B,t) :- fetch(B,t-1), not there(B,t-1), not gave_up(t-1), not _request(cancel(B),t).
{ _action_lib(walk,R,t) : room(R), not in(robot,R,t-1);
  _action_lib(take,(H,B),t) : hand(H), fetch(B,t), in(robot,a,t-1), not full(H,t-1), not carried(B,t-1);
  _action_lib(put,(H,B),t) : holds(H,B,t-1), fetch(B,t), in(robot,b,t-1) } 1 :- fetch(X,t).
slips(B,t) :- _slippery(B,t), ball(B).
wrong(t) :- _action_lib(A,P,t), _return(A,V,t), V != P.
in(robot,R,t) :- _action_lib(walk,R,t), not wrong(t).
gone(t) :- _action_lib(walk,R,t), not wrong(t).
in(robot,R,t) :- in(robot,R,t-1), not gone(t).
holds(H,B,t) :- _action_lib(take,(H,B),t), not wrong(t).
holds(H,B,t) :- holds(H,B,t-1), not dropped(B,t).
full(H,t) :- holds(H,B,t).
carried(B,t) :- holds(H,B,t).
dropped(B,t) :- _action_lib(put,(H,B),t), not wrong(t).
there(B,t) :- dropped(B,t).
gave_up(t) :- wrong(t).
_status(B,accepted,t) :- fetch(B,t).
_status(B,succeeded,t) :- fetch(B,t-1), there(B,t-1).
_status(B,aborted,t) :- fetch(B,t-1), gave_up(t-1), not there(B,t-1).
_status(B,canceled,t) :- _request(cancel(B),t), not there(B,t-1), not gave_up(t-1).
#show _action_lib/3. #show _status/3. #show slips/2.
#program volatile(t).
:- fetch(B,t), not there(B,t), not gave_up(t).
"""

#: A lift moves between floors and opens its door where it is called; somebody can hold the door.
LIFT = """
#const top = 2.
#program base.
floor(0..top). floor_of(lift,0,0).
#program cumulative(t).
#external _request/2. #external _return/3. #external _held/1.
call(F,t) :- _request(ride(F),t+1), floor(F), not _request(cancel(F),t).
call(F,t) :- call(F,t-1), not served(F,t-1), not broken(t-1), not _request(cancel(F),t).
{ _action_lib(up,F+1,t) : floor_of(lift,F,t-1), F < top;
  _action_lib(down,F-1,t) : floor_of(lift,F,t-1), F > 0;
  _action_lib(open,F,t) : floor_of(lift,F,t-1), call(F,t) } 1 :- call(G,t).
held(t) :- _held(t).
broken(t) :- _action_lib(A,P,t), _return(A,V,t), V != P.
rides(F,t) :- _action_lib(up,F,t), not broken(t).
rides(F,t) :- _action_lib(down,F,t), not broken(t).
moves(t) :- rides(F,t).
floor_of(lift,F,t) :- rides(F,t).
floor_of(lift,F,t) :- floor_of(lift,F,t-1), not moves(t).
served(F,t) :- _action_lib(open,F,t), not broken(t).
_status(F,accepted,t) :- call(F,t).
_status(F,succeeded,t) :- call(F,t-1), served(F,t-1).
_status(F,aborted,t) :- call(F,t-1), broken(t-1), not served(F,t-1).
_status(F,canceled,t) :- _request(cancel(F),t), not served(F,t-1), not broken(t-1).
#show _action_lib/3. #show _status/3. #show held/1.
#program volatile(t).
:- call(F,t), not served(F,t), not broken(t).
"""

#: A guard goes to posts; its battery lasts for two drives, then it needs charging at the dock.
PATROL = """
#program base.
post(gate). post(yard). spot(P) :- post(P). spot(dock).
stands(dock,0). charge(2,0).
#program cumulative(s).
#external _request/2. #external _return/3. #external _rain/2.
duty(P,s) :- _request(look(P),s+1), post(P), not _request(cancel(P),s).
duty(P,s) :- duty(P,s-1), not seen(P,s-1), not out(s-1), not _request(cancel(P),s).
{ _action_lib(goto,P,s) : spot(P), not stands(P,s-1), not charge(0,s-1);
  _action_lib(load,dock,s) : stands(dock,s-1), charge(0,s-1) } 1 :- duty(Q,s).
rains(P,s) :- _rain(P,s), post(P).
out(s) :- _action_lib(A,P,s), _return(A,V,s), V != P.
gone(s) :- _action_lib(goto,P,s), not out(s).
stands(P,s) :- _action_lib(goto,P,s), not out(s).
stands(P,s) :- stands(P,s-1), not gone(s).
loaded(s) :- _action_lib(load,dock,s), not out(s).
far(s) :- stands(P,s), P != dock.
charge(2,s) :- loaded(s).
charge(N-1,s) :- charge(N,s-1), N > 1, gone(s), far(s).
charge(1,s) :- charge(1,s-1), gone(s), far(s).
charge(0,s) :- charge(N,s-1), gone(s), not far(s).
charge(N,s) :- charge(N,s-1), not gone(s), not loaded(s).
seen(P,s) :- stands(P,s), post(P).
_status(P,accepted,s) :- duty(P,s).
_status(P,succeeded,s) :- duty(P,s-1), seen(P,s-1).
_status(P,aborted,s) :- duty(P,s-1), out(s-1), not seen(P,s-1).
_status(P,canceled,s) :- _request(cancel(P),s), not seen(P,s-1), not out(s-1).
#show _action_lib/3. #show _status/3. #show rains/2.
#program volatile(s).
:- duty(P,s), not seen(P,s), not out(s).
"""

SOUND = {
    "vacuum": (VACUUM, ("clean(2)", "clean(3)")),
    "gripper": (GRIPPER, ("fetch(red)",)),
    "lift": (LIFT, ("ride(1)", "ride(2)")),
    "patrol": (PATROL, ("look(gate)", "look(yard)")),
}
"""Programs without faults, each with goals."""
