"""Programs for several machines whose actions go on from cycle to cycle."""

from pathlib import Path

#: Goals job(Machine,Id); see the file.
TEAM = (Path(__file__).resolve().parents[1] / "data" / "team.lp").read_text()

#: As TEAM, but a plan can leave out a running action.
FREE = TEAM.replace("_action_lib(A,P,t) :- _running(A,P,t-1).\n", "")
