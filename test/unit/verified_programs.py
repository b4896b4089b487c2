"""Small programs for verification, correct and faulty ones, and the replay of a finding on a core."""

from core_driver import Driver

from rosoclingo.checking.verifying.moves import CANCEL, GOAL
from rosoclingo.oclingo import Literal, Statement, StreamUpdate, Volatile, commitment
from rosoclingo.oclingo.program.action_rules import is_action_of
from rosoclingo.planning.history import AcceptedUpdate, Plan
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.reasoning.settings import CoreSettings

#: A robot drives to requested places; failed goals are aborted. A sensor reports closed places, which no rule uses.
VISITS = """
#program base.
place(home). place(hall). place(den). at(home,0).
#program cumulative(t).
#external _request/2. #external _return/3. #external _closed/2.
asked(P,t)  :- _request(visit(P),t+1), place(P).
wanted(P,t) :- asked(P,t), not at(P,t-1), not _request(cancel(P),t).
wanted(P,t) :- wanted(P,t-1), not at(P,t-1), not failed(P,t-1), not _request(cancel(P),t).
{ _action_lib(go,P,t) : wanted(P,t) } 1.
failed(P,t) :- _action_lib(go,P,t), _return(go,V,t), V != P.
moved(t) :- _action_lib(go,P,t), not failed(P,t).
at(P,t) :- _action_lib(go,P,t), not failed(P,t).
at(P,t) :- at(P,t-1), not moved(t).
_status(P,accepted,t) :- wanted(P,t).
_status(P,succeeded,t) :- wanted(P,t-1), at(P,t-1).
_status(P,succeeded,t) :- asked(P,t), at(P,t-1).
_status(P,aborted,t) :- wanted(P,t-1), failed(P,t-1).
_status(P,canceled,t) :- _request(cancel(P),t), not at(P,t-1), not failed(P,t-1).
seen(P,t) :- _closed(P,t), place(P).
#show _action_lib/3. #show _status/3. #show seen/2.
#program volatile(t).
:- wanted(P,t), not at(P,t), not failed(P,t).
"""

#: A robot grabs a thing, goes to the door and drops it there; if it cannot go, the goal is aborted and it keeps the
#: thing.
CARRIES = """
#program base.
thing(cup). thing(pen). spot(desk). spot(door). at(desk,0).
#program cumulative(t).
#external _request/2. #external _return/3.
wanted(X,t) :- _request(bring(X),t+1), thing(X), not _request(cancel(X),t).
wanted(X,t) :- wanted(X,t-1), not dropped(X,t-1), not failed(t-1), not _request(cancel(X),t).
{ _action_lib(go,S,t) : spot(S), not at(S,t-1);
  _action_lib(grab,X,t) : wanted(X,t), not held(X,t-1), at(desk,t-1);
  _action_lib(drop,X,t) : wanted(X,t), held(X,t-1), at(door,t-1) } 1 :- wanted(Y,t).
failed(t) :- _action_lib(A,P,t), _return(A,V,t), V != P.
moved(t) :- _action_lib(go,S,t), not failed(t).
at(S,t) :- _action_lib(go,S,t), not failed(t).
at(S,t) :- at(S,t-1), not moved(t).
held(X,t) :- _action_lib(grab,X,t), not failed(t).
held(X,t) :- held(X,t-1), not dropped(X,t).
dropped(X,t) :- _action_lib(drop,X,t), not failed(t).
_status(X,accepted,t) :- wanted(X,t).
_status(X,succeeded,t) :- wanted(X,t-1), dropped(X,t-1).
_status(X,aborted,t) :- wanted(X,t-1), failed(t-1).
_status(X,canceled,t) :- _request(cancel(X),t), not dropped(X,t-1), not failed(t-1).
#show _action_lib/3. #show _status/3.
#program volatile(t).
:- wanted(X,t), not dropped(X,t), not failed(t).
"""

#: The effects follow from the returns of the step before, whose values are compared.
ECHO = """
#program base.
job(wash). job(iron).
#program cumulative(t).
#external _request/2. #external _return/3.
wanted(J,t) :- _request(do(J),t+1), job(J), not _request(cancel(J),t).
wanted(J,t) :- wanted(J,t-1), not came(J,t), not failed(J,t), not _request(cancel(J),t).
{ _action_lib(run,J,t) : wanted(J,t) } 1.
came(J,t) :- _action_lib(run,J,t-1), _return(run,J,t-1).
failed(J,t) :- _action_lib(run,J,t-1), _return(run,V,t-1), V != J.
_status(J,accepted,t) :- wanted(J,t).
_status(J,succeeded,t) :- came(J,t).
_status(J,aborted,t) :- failed(J,t).
_status(J,canceled,t) :- _request(cancel(J),t), not came(J,t), not failed(J,t).
tried(J,t) :- _action_lib(run,J,t).
tried(J,t) :- tried(J,t-1), not _request(do(J),t+1).
#show _action_lib/3. #show _status/3.
#program volatile(t).
:- wanted(J,t), not tried(J,t).
"""

#: Two machines run at once, and a cycle ends with the first return; failed goals are aborted.
MACHINES = """
#program base.
machine(saw). machine(drill).
#program cumulative(t).
#external _request/2. #external _return/3. #external _running/3.
wanted(M,t) :- _request(use(M),t+1), machine(M), not _request(cancel(M),t).
wanted(M,t) :- wanted(M,t-1), not done(M,t-1), not failed(M,t-1), not _request(cancel(M),t).
{ _action_lib(M,on,t) } :- wanted(M,t).
_action_lib(M,on,t) :- _running(M,on,t-1).
failed(M,t) :- _action_lib(M,on,t), _return(M,V,t), V != on, not _running(M,on,t).
done(M,t) :- _action_lib(M,on,t), not failed(M,t), not _running(M,on,t).
_status(M,accepted,t) :- wanted(M,t).
_status(M,succeeded,t) :- wanted(M,t-1), done(M,t-1).
_status(M,aborted,t) :- wanted(M,t-1), failed(M,t-1).
_status(M,canceled,t) :- _request(cancel(M),t), not done(M,t-1), not failed(M,t-1).
#show _action_lib/3. #show _status/3.
#program volatile(t).
:- wanted(M,t), not done(M,t), not failed(M,t).
"""


def edited(text, *pairs):
    """Return a program in which each pair's first text is replaced by its second."""
    for old, new in pairs:
        assert old in text, old
        text = text.replace(old, new)
    return text


def more(text, rules):
    """Return a program with further rules in its cumulative part."""
    return text.replace("#show _action_lib/3.", f"{rules}\n#show _action_lib/3.")


class SteeredSolver(PlanSolver):
    """A solver that prefers, among the shortest plans, one that begins with the ``chosen`` actions."""

    def __init__(self, program, chosen):
        super().__init__(program)
        self._chosen = chosen

    def update(self, update, stopped=None):
        """Accept ``update`` as any solver does; if its answer begins otherwise, search for one of equal length."""
        before = self.log
        result = super().update(update, stopped)
        wanted, has = self._chosen.get(result.step), _actions_of(result)
        if wanted is None or not result.answers or has == wanted:
            return result
        demands = [commitment(one) for one in sorted(wanted)]
        forbidden = [Statement(None, (Literal(one, positive=True),)) for one in sorted(has - wanted)]
        steered = StreamUpdate(
            update.step, result.horizon - result.step, (*update.items, Volatile(), *demands, *forbidden)
        )
        self.restore(before)
        other = super().update(steered, stopped)
        found = other if other.answers else result
        self.restore(before.with_entries(AcceptedUpdate(update, found.horizon)).adopt(Plan.from_result(found)))
        return found


def _actions_of(result):
    return frozenset(filter(is_action_of(result.step), result.answers[0])) if result.answers else frozenset()


def play(program, way, steps=20):
    """Play a finding on the real core, with a solver that prefers its plan among the shortest ones."""
    chosen = {step.cycle: step.chosen for step in way if step.cycle}
    settings = CoreSettings(horizon_limit=steps)
    driver = Driver(settings=settings, program=program, solver=lambda one: SteeredSolver(one, chosen))
    for step in way:
        for one in step.move.arrivals:
            if one.kind == GOAL:
                driver.core.add_goal(str(one.term), str(one.term))
            elif one.kind == CANCEL:
                driver.core.cancel_goal(str(one.term))
            else:
                driver.core.receive("sensor", [str(one.term)])
        for answer in step.move.answers:
            driver.core.receive(answer.action.interface_name, [answer.text])
        driver.core.poll(driver.now)
        driver.core.advance(driver.now)
    return driver
