"""Control programs during execution: failures, external events, cancels, concurrent programs and free actions."""

import clingo
import pytest
from golog_programs import ACTIONS, FLUENTS, PROCEDURES, TOY, Toy, programs
from golog_runs import Runs
from golog_text import atom, translated
from golog_traces import ENGINE, OPEN
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from shipped import ENCODINGS

PHASES = [Phase.explicit, Phase.reuse, Phase.generate]  # failing examples are short already, and slow to shrink
RUNS = settings(max_examples=max(1, settings.default.max_examples // 2), phases=PHASES)

STEPS = 5
GOALS = OPEN.sub("", (ENCODINGS / "golog" / "goals.lp").read_text())

PLAYED = """
#program base.
#defined _failed/3. #defined _return/3. #defined _request/2. #defined event/3. #defined free/1.
#show status/3.
#show offers/3.
#show waits/2.
#program cumulative(t).
offers(G,A,t) :- _g_offers(G,A,t).
waits(G,t)    :- _g_waits(G,t).
status(Id,rejected,t) :- _status(Id,rejected(Why),t).
status(Id,How,t)      :- _status(Id,How,t), How != rejected(Why) : _status(Id,rejected(Why),t).
golog_free(t) :- free(t).
{ _action_lib(N,X,t) : golog_action(A,N,X,t) } :- golog_free(t).
"""


class Play:
    """Random events that the programs allow, in each step, and the interpreter's view of them."""

    def __init__(self, data):
        self.facts, self.constraints, self.expected = [], [], set()
        self.programs, self.runs = {}, Runs(Toy, PROCEDURES)
        for step in range(1, STEPS + 1):
            self.step(data, step)

    def step(self, data, step):
        """Play one step."""
        happens = data.draw(st.none() | st.tuples(st.sampled_from(FLUENTS), st.booleans()), label="event")
        if happens is not None and step > 1:
            self.runs.happen(*happens)
            self.facts.append(f"event({atom(happens[0])},{'yes' if happens[1] else 'no'},{step})")
        idle = [name for name in ("g", "h") if ("run", name) not in self.runs.left]
        asked = {name: self.ask(data, name, step) for name in idle if data.draw(st.booleans(), label="asked")}
        known = [name for name in ("g", "h") if name in self.runs.how or name in asked]
        cancelled = [name for name in known if data.draw(st.sampled_from([False] * 4 + [True]), label="cancel")]
        self.facts += [f"_request(cancel({name}),{step})" for name in cancelled]
        free = data.draw(st.sampled_from([False, False, True]), label="free")
        self.facts += [f"free({step})"] * free
        self.runs.begin(asked, cancelled, free)
        self.tell(step)
        self.act(data, step, free)

    def ask(self, data, name, step):
        """Request a program, which can be unknown, a repetition, or another one."""
        program = data.draw(st.none() | programs() | programs(), label=name)
        procedure = f"main{len(self.facts)}"
        self.facts.append(f"_request(run({procedure},{name}),{step + 1})")
        if program is not None:
            self.programs[procedure] = program
        return program

    def tell(self, step):
        """Record the atoms that this step has to show."""
        for name, how in self.runs.how.items():
            self.expected.add(f"status({name},{how},{step})")
        for key in self.runs.left:
            shown = "{}({})".format(*key)
            self.expected |= {f"offers({shown},{atom(one)},{step})" for one in self.runs.offers(key)}
            if self.runs.waits(key):
                self.expected.add(f"waits({shown},{step})")

    def act(self, data, step, free):
        """Execute an action, skip it, or let it fail."""
        possible = {one for name in self.runs.left for one in self.runs.offers(name)}
        if free:
            possible |= {one for one in ACTIONS if self.runs.interpreter.possible(one, self.runs.state)}
        action = data.draw(st.sampled_from([*sorted(possible), None]), label="action")
        worked = action is None or data.draw(st.sampled_from([True, True, False]), label="worked")
        if action is None:
            self.constraints.append(f":- _action_lib(N,X,{step}).")
        else:
            self.constraints.append(f":- not _action_lib(act,{atom(action)},{step}).")
            self.facts.append(f"_return(act,{atom(action) if worked else 'broken'},{step})")
            self.facts += [] if worked else [f"_failed(act,broken,{step})"]
        self.runs.act(action, worked, free)

    def shown(self):
        """Return the atoms that the encoding shows, given all events."""
        control = clingo.Control(["0", "-Wnone"])
        facts = "".join(f"{one}. " for one in self.facts)
        for part in (*ENGINE, GOALS, TOY, PLAYED, translated(self.programs), f"#program base.\n{facts}"):
            control.add("base", [], part)
        control.ground([("base", [])])
        for step in range(1, STEPS + 1):
            control.ground([("cumulative", [clingo.Number(step)])])
        control.add("end", [], "".join(self.constraints))
        control.ground([("end", [])])
        found = []
        control.solve(on_model=lambda model: found.append(set(map(str, model.symbols(shown=True)))))
        assert len(set(map(frozenset, found))) == 1, (
            "the executed actions decide everything"
        )  # clasp can find an answer twice
        return {one for one in found[0] if not one.startswith(("_action_lib", "_explain", "_status"))}


@pytest.mark.slow
@RUNS
@given(st.data())
def test_golog_remaining_program_agrees_with_the_definitions(data):
    play = Play(data)
    assert play.shown() == play.expected
