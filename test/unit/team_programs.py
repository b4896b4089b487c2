"""Programs for several machines whose actions go on from cycle to cycle."""

from shipped import DATA

#: Goals job(Machine,Id); see the file.
TEAM = (DATA / "team.lp").read_text()

#: As TEAM, but a plan can leave out a running action.
FREE = TEAM.replace("_action_lib(A,P,t) :- _running(A,P,t-1).\n", "")
