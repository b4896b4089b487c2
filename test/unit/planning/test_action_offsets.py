"""Programs whose rules give actions cycles before or after their step, against clingo and the program in one piece."""

from typing import NamedTuple

import clingo
import pytest
from hypothesis import given
from hypothesis import strategies as st
from stream_logs import cut

from rosoclingo.oclingo import ReactiveProgram, SolveOutcome, parse_update
from rosoclingo.planning.solver import PlanSolver

pytestmark = pytest.mark.usefixtures("compacts_at_once")

OFFSETS = range(-3, 4)
BOUND = 2


class Head(NamedTuple):
    """How a rule has an action: its cycle is ``offset`` after the step, under an event or without, by choice or not."""

    offset: int
    choice: bool = True
    event: str = ""
    variable: bool = False

    def text(self, name):
        """The rule, for an action of interface ``name``."""
        cycle, body = f"{'T' if self.variable else 't'}+{self.offset}", [self.event] * bool(self.event)
        body += ["now(T), T = t"] * self.variable
        head = f"_action_lib({name},x,{cycle})"
        return (f"{{ {head} }}" if self.choice else head) + " :- " * bool(body) + ", ".join(body) + "."

    @property
    def certain(self):
        """Whether the action is a fact."""
        return not self.choice and not self.event


class Program(NamedTuple):
    """A program of such rules, with a goal for the last step."""

    heads: tuple
    goal: str

    def cumulative(self):
        """The cumulative part."""
        first = self.heads[0].offset
        acts = f"acts(t) :- _action_lib(a0,x,t+{first}).\nacts(t) :- acts(t-1), not e(t)."
        return f"now(t).\n{acts}\n" + "\n".join(one.text(f"a{number}") for number, one in enumerate(self.heads))

    def text(self):
        """All of it."""
        return f"#program cumulative(t).\n#external e(t).\n{self.cumulative()}\n#program volatile(t).\n{self.goal}\n"

    def answers(self, horizon, last, events, closed):
        """The actions of each answer of ``horizon`` where the steps up to ``last`` are grounded."""
        control = clingo.Control(["0", "-Wno-atom-undefined"])
        control.add("step", ["t"], self.cumulative())
        control.add("goal", ["t"], self.goal)
        control.add("base", [], "".join(f"e({step}).\n" for step in events if step <= last))
        parts = [("step", [clingo.Number(step)]) for step in range(1, last + 1)]
        control.ground([("base", []), *parts, ("goal", [clingo.Number(horizon)])])
        forbidden = [one for one in control.symbolic_atoms if not self.allows(one.symbol, horizon, closed)]
        with control.backend() as backend:
            for literal in [one.literal for one in forbidden]:
                backend.add_rule([], [literal])
            for action in (action for executed in closed.values() for action in executed):
                backend.add_rule([], [-backend.add_atom(action)])
        found = []
        control.solve(on_model=lambda model: found.append(actions(model.symbols(atoms=True))))
        return found

    def allows(self, action, horizon, closed):
        """Whether an answer of ``horizon`` may hold the action, or any other atom."""
        if action.name != "_action_lib":
            return True
        cycle = action.arguments[2].number
        if cycle < 1:
            return self.heads[int(action.arguments[0].name[1:])].certain
        return action in closed[cycle] if cycle in closed else cycle <= horizon


def actions(atoms):
    return frozenset(atom for atom in atoms if atom.name == "_action_lib")


HEADS = st.builds(
    Head,
    st.sampled_from(OFFSETS),
    st.sampled_from([True, True, False]),
    st.sampled_from(["", "e(t)", "not e(t)"]),
    st.booleans(),
)
GOALS = ["", ":- not acts(t).", ":- e(t)."]
PROGRAMS = st.builds(Program, st.lists(HEADS, min_size=1, max_size=2).map(tuple), st.sampled_from(GOALS))


@pytest.mark.slow
@given(PROGRAMS, st.data(), st.integers(0, 3))
def test_answers_contain_actions_of_past_and_horizon(program, data, margin):
    """All answers of the least horizon, cycle by cycle, while steps are retired."""
    solver = PlanSolver(ReactiveProgram.from_text(program.text()), models=0)
    events, closed, committed, last = set(), {}, [], 1
    for cycle in range(1, 7):
        steps = [one for one in (cycle - 1, cycle, cycle + 2) if one >= max(1, cycle - margin)]
        told = data.draw(st.sets(st.sampled_from(steps), max_size=2))
        events |= told
        if data.draw(st.booleans()):
            solver.restore(cut(solver))
        past = [f"#closed {cycle - 1}."] if closed else []
        past += [f"#over {cycle - margin}."] if cycle > margin else []
        items = [*past, *(f"e({one})." for one in sorted(told)), *(f":- not {one}." for one in committed)]
        result = solver.update(parse_update(f"#step {cycle} : {BOUND}. {' '.join(items)} #endstep."))
        expected, horizon = [], cycle - 1
        while not expected and horizon < cycle + BOUND:
            horizon, last = horizon + 1, max(last, horizon + 1)
            expected = program.answers(horizon, last, events, closed)
        found = [actions(answer) for answer in result.answers]
        context = (program.text(), cycle, sorted(events), closed)
        assert (result.outcome is SolveOutcome.SATISFIABLE) == bool(expected), context
        assert sorted(map(sorted, found)) == sorted(map(sorted, expected)), context
        if result.permanent:
            return
        if expected:
            assert (result.horizon, solver.horizon) == (horizon, last), context
        plan = sorted(data.draw(st.sampled_from(sorted(expected, key=sorted)))) if expected else []
        committed = [action for action in plan if action.arguments[2].number == cycle]
        closed[cycle] = set(committed)
