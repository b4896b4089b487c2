"""The action sequences that encoding and translation allow for a control program in the domain of golog_programs."""

import re

import clingo
from golog_programs import TOY
from golog_text import atom, translated
from shipped import ENCODINGS

OPEN = re.compile(r"^#external \w+/\d\.", re.MULTILINE)
ENGINE = [OPEN.sub("", (ENCODINGS / "golog" / f"{name}.lp").read_text()) for name in ("transitions", "running")]

#: Every step except those after the last action has one; a program that is over does nothing any more.
WHOLE = """
#external event(F,V,t) : fluent(F), V = (yes;no).
acted(t) :- _action_lib(A,X,t).
:- acted(t), not acted(t-1), t > 1.
:- _action_lib(last,z,t), _action_lib(last,z,T), T < t, T = 1..t.
#program volatile(t).
:- _g_runs(g,t).
#program base.
#defined _g_halts/2. #defined _failed/3. #defined _return/3.
golog_does(z,last,z).
#show _action_lib/3.
"""


def encoded_traces(program, state, longest):
    """Return all sequences of at most ``longest`` actions after which the program can end.

    As a program ends as soon as it can, an action follows it.
    """
    starts = "".join(f"holds({atom(one)},1) :- t=1.\n" for one in state)
    control = clingo.Control(["0", "-Wnone"])
    for part in ENGINE:
        control.add("base", [], part)
    control.add("base", [], TOY + f"{translated({'main': program})}{starts}{WHOLE}")
    control.add("base", [], "_g_starts(g,seq(call(main),do(z)),1).")
    control.ground([("base", [])])
    for step in range(1, longest + 3):
        control.ground([("cumulative", [clingo.Number(step)])])
    control.ground([("volatile", [clingo.Number(longest + 2)])])
    found = []
    control.solve(on_model=lambda model: found.append(trace(model.symbols(shown=True))))
    assert len(found) == len(set(found))
    return set(found)


def trace(atoms):
    """Return the actions of a plan in order, without the last one."""
    actions = sorted((atom.arguments[2].number, atom.arguments[1]) for atom in atoms)
    assert actions[-1][1].name == "z"
    return tuple((one.name, *(part.number for part in one.arguments)) for _, one in actions[:-1])
