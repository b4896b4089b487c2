"""Scripts for control programs: their steps, in addition to the words of core_scripts."""

from core_driver import Driver
from core_scripts import play
from shipped import ENCODINGS

from rosoclingo.oclingo import ReactiveProgram, parse_update
from rosoclingo.oclingo.program.sources import Source
from rosoclingo.planning.solver import PlanSolver

#: Actions are named act; an action is impossible while ``no(Action)`` holds. Other actions than those of the programs
#: are possible while ``shared`` holds. Facts set the fluents.
DOMAIN = """
#include "golog.lp".
#program base.
act(a;b;c;d;tidy;calm).
#program cumulative(t).
#external _set/2. #external _unset/2.
golog_action(A,act,A,t) :- act(A), not holds(no(A),t).
holds(F,t) :- _set(F,t).
holds(F,t) :- holds(F,t-1), not _unset(F,t).
golog_holds(F,t) :- holds(F,t).
golog_holds(is(X),t) :- act(X).
golog_free(t) :- holds(shared,t-1).
:- 2 { _action_lib(A,X,t) }.
"""


def domain_with(procedures, **constants):
    """Return the program of DOMAIN with these procedures and constants."""
    return ReactiveProgram([Source("domain.lp", DOMAIN, ENCODINGS), Source("test.golog", procedures)], constants)


class ProgramDriver(Driver):
    """A driver of control programs; actions are named by their parameters, or with ``pairs`` as INTERFACE,PARAMETER."""

    pairs = False

    @property
    def doing(self):
        """Return the actions under way."""
        return [f"{one.interface},{one.parameter}" if self.pairs else str(one.parameter) for one in self.core.awaited]

    def step(self, *names):
        """Expect these actions one after the other, each of which succeeds."""
        for name in names:
            assert self.doing == [name]
            self.succeed()

    def breaks(self, name, reason="stuck"):
        """Expect an action and let it fail."""
        assert self.doing == [name]
        self.fail(reason)

    def stuck(self, times):
        """Let the action under way fail a number of times."""
        for _ in range(int(times)):
            self.fail("stuck")

    def rest(self, **reasons):
        """Return the actions until none is left; one fails for the given reasons, one after the other."""
        found = []
        while self.core.awaited:
            found.append(" ".join(self.doing))
            why = reasons.get(found[-1])
            if why:
                self.fail(why.pop(0))
            else:
                self.succeed()
            assert len(found) < 60
        return found

    def performs(self, *names):
        """Expect exactly these actions until none is left."""
        assert self.rest() == list(names)

    def tell(self, *facts):
        """Send facts that hold now."""
        self.facts(*(f"{fact[:-1]},now)" for fact in facts))


def run(program, script, settings=None, pairs=False):
    """Play a script with a program; return the driver."""
    driver = ProgramDriver(program=program, settings=settings)
    driver.pairs = pairs
    return play(driver, script)


def plans(program, request, pairs=False):
    """Return all shortest plans for a request, as sorted texts."""
    solver = PlanSolver(program, models=0)
    result = solver.update(parse_update(f"#step 1 : 30. _request(run({request},1),2). #endstep."))
    found = []
    for answer in result.answers:
        steps = {one.arguments[2].number: one.arguments[:2] for one in answer if one.name == "_action_lib"}
        found.append(" ".join(("{}({})" if pairs else "{1}").format(*steps[step]) for step in sorted(steps)))
    return sorted(found)
