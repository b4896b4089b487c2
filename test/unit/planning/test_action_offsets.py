"""Rules whose actions have cycles before or after the step, compared with plain clingo on the whole program."""

from typing import NamedTuple

import clingo
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stream_logs import cut
from workloads import sized

from rosoclingo.oclingo import ReactiveProgram, SolveOutcome, parse_update
from rosoclingo.planning.solver import PlanSolver

pytestmark = pytest.mark.usefixtures("compacts_at_once")

OFFSETS = range(-3, 4)
BOUND = 2


class Head(NamedTuple):
    """A rule with an action in the head, whose cycle is the step plus ``offset``."""

    offset: int
    choice: bool = True
    event: str = ""
    variable: bool = False

    def text(self, name):
        """Return the text of the rule, for an action of interface ``name``."""
        cycle, body = f"{'T' if self.variable else 't'}+{self.offset}", [self.event] * bool(self.event)
        body += ["now(T), T = t"] * self.variable
        head = f"_action_lib({name},x,{cycle})"
        return (f"{{ {head} }}" if self.choice else head) + " :- " * bool(body) + ", ".join(body) + "."

    @property
    def certain(self):
        """Whether the action is a fact."""
        return not self.choice and not self.event


class Program(NamedTuple):
    """A program of such rules, with a goal at the last step."""

    heads: tuple
    goal: str

    def cumulative(self):
        """Return the text of the cumulative part."""
        first = self.heads[0].offset
        acts = f"acts(t) :- _action_lib(a0,x,t+{first}).\nacts(t) :- acts(t-1), not e(t)."
        return f"now(t).\n{acts}\n" + "\n".join(one.text(f"a{number}") for number, one in enumerate(self.heads))

    def text(self):
        """Return the text of the program."""
        return f"#program cumulative(t).\n#external e(t).\n{self.cumulative()}\n#program volatile(t).\n{self.goal}\n"

    def answers(self, horizon, last, events, closed):
        """Return the actions of each answer at ``horizon``, with the steps up to ``last`` grounded."""
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
        """Return whether an answer at ``horizon`` can contain the action; other atoms are always allowed."""
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
@settings(max_examples=sized(8, settings.default.max_examples))
@given(PROGRAMS, st.data(), st.integers(0, 3))
def test_answers_contain_actions_of_past_and_horizon(program, data, margin):
    """Compare all answers at the lowest horizon, cycle by cycle, during compaction."""
    solver = PlanSolver(ReactiveProgram.from_text(program.text()), models=0)
    events, closed, committed, last = set(), {}, [], 1
    for cycle in range(1, 7):
        steps = [one for one in (cycle - 1, cycle, cycle + 2) if one >= max(1, cycle - margin)]
        reported = data.draw(st.sets(st.sampled_from(steps), max_size=2))
        events |= reported
        if data.draw(st.booleans()):
            solver.restore(cut(solver))
        past = [f"#closed {cycle - 1}."] if closed else []
        past += [f"#over {cycle - margin}."] if cycle > margin else []
        items = [*past, *(f"e({one})." for one in sorted(reported)), *(f":- not {one}." for one in committed)]
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
