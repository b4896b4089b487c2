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
