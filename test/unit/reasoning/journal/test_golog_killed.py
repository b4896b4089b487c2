"""Kill the core during control programs: they continue where they were, and no action runs twice."""

import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from killed_core import KILLS, World, played
from shipped import ENCODINGS

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.oclingo.program.sources import Source
from rosoclingo.reasoning.goals import GoalState

#: Goal I has the actions step(I,N) and tidy(I). A fluent says which steps are left; a fact sets the fluent ball.
DOMAIN = """
#include "golog.lp".
#program base.
step(I,1..3) :- I = 1..12.
#program cumulative(t).
#external _seen/1.
golog_action(step(I,N),hand,step(I,N),t) :- step(I,N).
golog_action(tidy(I),hand,tidy(I),t)     :- step(I,1).
failed(t)      :- _failed(A,V,t), not _action_lib(A,V,t).
stepped(I,N,t) :- _action_lib(hand,step(I,N),t), not failed(t).
stepped(I,N,t) :- stepped(I,N,t-1).
golog_holds(left(I,N),t) :- step(I,N), not stepped(I,N,t-1).
golog_holds(ball,t)      :- _seen(ball).
:- 2 { _action_lib(A,X,t) }.
"""

PROGRAMS = """
proc walk(I)   { step(I, 1); step(I, 2); step(I, 3); }
proc loop(I)   { while some N: left(I, N) { pick N: left(I, N) { step(I, N); } } }
proc tried(I)  { try { step(I, 1); step(I, 2); } else { step(I, 3); } }
proc tidied(I) { do { step(I, 1); step(I, 2); } on cancel { tidy(I); } }
proc many(I)   { interleave { step(I, 1); step(I, 2); } with { search { step(I, 3); } } }
proc wait(I)   { step(I, 1); await ball; step(I, 2); }
"""

#: The actions of each program after a success.
WHOLE = {
    "walk": ["123"],
    "loop": ["123", "132", "213", "231", "312", "321"],
    "tried": ["12", "3", "13"],
    "tidied": ["12"],
    "many": ["123", "132", "312"],
    "wait": ["12"],
}


class Programs(World):
    """Clients that send control programs."""

    program = ReactiveProgram([Source("domain.lp", DOMAIN, ENCODINGS), Source("test.golog", PROGRAMS)])
    horizon_limit, any_plan = 12, False

    def __init__(self, folder, fate):
        super().__init__(folder, fate)
        self.order = {}

    def execute(self, action, good):
        value = super().execute(action, good)
        if good:
            key, *number = map(str, action.parameter.arguments)
            self.order[key] = self.order.get(key, "") + "".join(number or "t")
        return value

    @staticmethod
    def text(key, kind):
        return f"run({kind}({key}),{key})"

    def check(self):
        """Check that each goal has ended and that the executed actions fit its program."""
        for key, kind in self.goals.items():
            state, order = self.ends[key], self.order.get(key, "")
            if state is GoalState.SUCCEEDED:
                assert order in WHOLE[kind], (kind, order)
                continue
            assert state is GoalState.ABORTED or key in self.cancelled, (kind, state)
            assert any(one.startswith(order.replace("t", "")) for one in WHOLE[kind]), (kind, order)
            if "t" in order:
                assert (kind, order) == ("tidied", "1t")
            elif kind == "tidied" and state is GoalState.PREEMPTED:
                assert order != "1", "it has to be tidied up"


HAPPENED = st.one_of(
    st.tuples(st.just("goal"), st.sampled_from(list(WHOLE))),
    st.tuples(st.just("goal"), st.sampled_from(list(WHOLE))),
    st.tuples(st.just("cancel"), st.integers(1, 8)),
    st.tuples(st.just("answer"), st.integers(0, 2), st.booleans()),
    st.tuples(st.just("answer"), st.integers(0, 2), st.just(True)),
)


@pytest.mark.slow
@settings(
    max_examples=max(1, settings.default.max_examples // 10), phases=[Phase.explicit, Phase.reuse, Phase.generate]
)
@given(script=st.lists(HAPPENED, min_size=3, max_size=12), kills=KILLS)
def test_control_programs_survive_repeated_core_kills(script, kills):
    played([*script, ("fact", "_seen(ball)")], kills, Programs)
