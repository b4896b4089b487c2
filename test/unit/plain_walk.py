"""A robot on a line, and a reference that solves each question about its stream from scratch."""

from dataclasses import dataclass, field
from typing import FrozenSet, List, Optional, Sequence, Set

import clingo

from rosoclingo.oclingo import StreamUpdate, commitment, fact, parse_atom, parse_update
from rosoclingo.oclingo.progression.updates import CloseCycles, Item
from rosoclingo.planning.history import cycle_of
from rosoclingo.planning.planning_solver import PlanningSolver
from rosoclingo.planning.prediction import success_of

BASE = "at(0,0)."
STEP = """
{{ _action_lib(move,X,{t}) : X = (P-1;P+1), at(P,{t}-1) }} 1.
moves({t}) :- _action_lib(move,X,{t}), not fail({t}).
at(X,{t})  :- _action_lib(move,X,{t}), moves({t}).
at(X,{t})  :- at(X,{t}-1), not moves({t}).
wanted(X,{t})  :- _request(X,{t}).
wanted(X,{t})  :- wanted(X,{t}-1).
reached(X,{t}) :- wanted(X,{t}), at(X,{t}).
reached(X,{t}) :- reached(X,{t}-1), not _request(X,{t}).
"""
GOAL = ":- wanted(X,{t}), not reached(X,{t}).\n"
ADVICE = """
#heuristic _action_lib(move,X,t) : wanted(Y,t), not reached(Y,t-1), at(P,t-1), X = P+1, Y > P. [2,true]
#heuristic _action_lib(move,X,t) : wanted(Y,t), not reached(Y,t-1), at(P,t-1), X = P-1, Y < P. [1,true]
"""

#: A second robot, which forgets the places that it has visited, and whose moves can fail.
LINE = """
#program base. at(0,0). #show _action_lib/3.
#program cumulative(t).
#external _request/2. #external _return/3.
{ _action_lib(go,X+1,t); _action_lib(go,X-1,t) } 1 :- at(X,t-1), wanted(Y,t).
at(X,t) :- _action_lib(go,X,t), not failed(t).
at(X,t) :- at(X,t-1), not moved(t).
moved(t) :- _action_lib(go,X,t), not failed(t).
wanted(X,t) :- _request(X,t).
wanted(X,t) :- wanted(X,t-1), not at(X,t-1).
#program volatile(t).
:- wanted(X,t), not at(X,t).
#program cumulative(t).
"""
FAILS = "failed(t) :- _action_lib(A,X,t), _return(A,Y,t), X != Y.\n"
#: A robot that can also rest.
RESTING = LINE.replace("} 1", "; _action_lib(rest,now,t) } 1") + FAILS
#: It also accepts requests one step before they start.
EARLY = RESTING + "wanted(X,t) :- _request(X,t+1).\n"


def onward(step: int, value: object, place: Optional[int] = None) -> StreamUpdate:
    """Return the update of ``step`` with the return of the previous action, a move to ``place``."""
    done = f"_action_lib(go,{place or step - 1},{step - 1}). _return(go,{value},{step - 1})."
    return parse_update(f"#step {step} : 50. #closed {step - 1}. :- not {done} #endstep.")


def next_update(solver: PlanningSolver, *facts: str, fails: bool = False, further: Sequence[Item] = ()) -> StreamUpdate:
    """Return the update of the next step: planned actions were executed, with success or failure; and more facts."""
    step, plan = solver.step, solver.log.plan
    done = sorted(one for one in plan.actions if cycle_of(one) == step) if plan else []
    returns = [parse_atom(f"_return({one.arguments[0]},no,{step})") if fails else success_of(one) for one in done]
    items = [*map(commitment, done), *map(fact, [*returns, *map(parse_atom, facts)])]
    return StreamUpdate(step + 1, 20, (CloseCycles(step, step), *items, *further))


def program_text(advice: bool = True) -> str:
    """Return the reactive program, with or without ``#heuristic`` statements."""
    steps = "#program cumulative(t).\n#external _request/2.\n#external fail(t)." + STEP.format(t="t")
    return f"#program base. {BASE}\n{steps}{ADVICE if advice else ''}#program volatile(t).\n{GOAL.format(t='t')}"


@dataclass
class Walk:
    """The history of the robot.

    Attributes:
        step: the step of the last update.
        facts: requests and failures.
        done: the actions that were executed.

    """

    step: int = 0
    facts: Set[clingo.Symbol] = field(default_factory=set)
    done: Set[clingo.Symbol] = field(default_factory=set)

    def update(self, wanted: List[int], fails: bool, actions: Set[clingo.Symbol], bound: Optional[int]) -> StreamUpdate:
        """Return the update of the next step, with requests and executed ``actions``, which failed if it ``fails``."""
        self.step += 1
        self.done |= actions
        facts = [parse_atom(f"_request({place},{self.step})") for place in wanted]
        facts += [parse_atom(f"fail({self.step - 1})")] if fails and actions else []
        self.facts.update(facts)
        past = (CloseCycles(self.step - 1, self.step - 1),) if self.step > 1 else ()
        return StreamUpdate(self.step, bound, (*past, *map(commitment, actions), *map(fact, facts)))

    def allows(self, horizon: int, plan: Optional[FrozenSet[clingo.Symbol]] = None) -> bool:
        """Return whether ``horizon`` has an answer; ``plan``: all actions from now on, if given."""
        text = BASE + "".join(STEP.format(t=step) for step in range(1, horizon + 1)) + GOAL.format(t=horizon)
        text += "".join(f"{one}.\n" for one in self.facts)
        actions = self.done | (plan or frozenset())
        text += "".join(f":- not {one}.\n" for one in actions)
        closed = horizon if plan is not None else min(self.step - 1, horizon)
        text += "".join(
            f":- _action_lib(move,X,{cycle}), X != {own}.\n"
            for cycle in range(1, closed + 1)
            for own in [next((one.arguments[1] for one in actions if cycle_of(one) == cycle), "none")]
        )
        control = clingo.Control(["-Wnone"])
        control.add("base", [], text)
        control.ground([("base", [])])
        return bool(control.solve().satisfiable)

    def least(self, first: int, last: int) -> Optional[int]:
        """Return the lowest horizon in first..last with an answer."""
        return next((horizon for horizon in range(first, last + 1) if self.allows(horizon)), None)
