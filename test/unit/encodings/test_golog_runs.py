"""Control programs as they run: under failures, events from outside and cancels, beside others and what is free."""

import clingo
import pytest
from golog_programs import ACTIONS, ENCODINGS, FLUENTS, PROCEDURE_RULES, PROCEDURES, TOY, Terms, Toy, programs
from golog_runs import Runs
from golog_traces import ENGINE, OPEN
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

PHASES = [Phase.explicit, Phase.reuse, Phase.generate]  # what fails is short already, and long to make shorter
RUNS = settings(max_examples=max(1, settings.default.max_examples // 2), phases=PHASES)

STEPS = 5
GOALS = OPEN.sub("", (ENCODINGS / "golog" / "goals.lp").read_text())

PLAYED = """
#program base.
#defined _failed/3. #defined _return/3. #defined _request/2. #defined event/3. #defined free/1.
#show _status/3.
#show offers/3.
#show waits/2.
#program cumulative(t).
offers(G,A,t) :- _g_offers(G,A,t).
waits(G,t)    :- _g_waits(G,t).
golog_free(t) :- free(t).
{ _action_lib(N,X,t) : golog_action(A,N,X,t) } :- golog_free(t).
"""


class Play:
    """What happens, step by step, drawn as the programs allow it; and what they say of it."""

    def __init__(self, data):
        self.facts, self.constraints, self.told = [], [], set()
        terms = Terms()
        self.runs = Runs(Toy, PROCEDURES)
        starts = {name: data.draw(st.integers(1, 3), label="start") for name in ("g", "h")}
        wanted = {name: data.draw(programs(), label=name) for name in starts}
        for step in range(1, STEPS + 1):
            self.step(data, step, starts, wanted)
        for name, program in wanted.items():
            self.facts.append(f"_request(run({name}0,{name}),{starts[name] + 1})")
            self.facts.append(f"golog_procedure({name}0,{terms.program(program)})")
        self.rules = PROCEDURE_RULES + terms.facts

    def step(self, data, step, starts, wanted):
        """One step."""
        happens = data.draw(st.none() | st.tuples(st.sampled_from(FLUENTS), st.booleans()), label="event")
        if happens is not None and step > 1:
            self.runs.happen(*happens)
            self.facts.append(f"event({Terms.atom(happens[0])},{'yes' if happens[1] else 'no'},{step})")
        for name in starts:
            if starts[name] == step:
                self.runs.start(name, wanted[name])
        live = [name for name in ("g", "h") if name in self.runs.left]
        cancelled = [name for name in live if data.draw(st.sampled_from([False] * 5 + [True]), label="cancel")]
        fresh = [name for name in cancelled if starts[name] == step]
        for name in fresh:
            self.runs.left.pop(name)
            self.runs.how[name] = "canceled"
        self.facts += [f"_request(cancel({name}),{step})" for name in cancelled]
        self.runs.begin(set(cancelled) - set(fresh))
        self.tell(step)
        self.act(data, step)

    def tell(self, step):
        """Note what is to be shown of this step."""
        self.told |= {f"_status({name},{how},{step})" for name, how in self.runs.how.items()}
        for name in self.runs.left:
            shown = f"undone({name[0]})" if name[1:] else name
            self.told |= {f"offers({shown},{Terms.atom(one)},{step})" for one in self.runs.offers(name)}
            if self.runs.waits(name):
                self.told.add(f"waits({shown},{step})")

    def act(self, data, step):
        """Something is done, or not; or fails."""
        free = data.draw(st.sampled_from([False, False, True]), label="free")
        possible = {one for name in self.runs.left for one in self.runs.offers(name)}
        if free:
            self.facts.append(f"free({step})")
            possible |= {one for one in ACTIONS if self.runs.interpreter.possible(one, self.runs.state)}
        action = data.draw(st.sampled_from([*sorted(possible), None]), label="action")
        worked = action is None or data.draw(st.sampled_from([True, True, False]), label="worked")
        if action is None:
            self.constraints.append(f":- _action_lib(N,X,{step}).")
        else:
            self.constraints.append(f":- not _action_lib(act,{Terms.atom(action)},{step}).")
            self.facts.append(f"_return(act,{Terms.atom(action) if worked else 'broken'},{step})")
            self.facts += [] if worked else [f"_failed(act,broken,{step})"]
        self.runs.act(action, worked, free)

    def shown(self):
        """What the encoding shows of it, with all that has happened known."""
        control = clingo.Control(["0", "-Wnone"])
        facts = "".join(f"{one}. " for one in self.facts)
        for part in (*ENGINE, GOALS, TOY, PLAYED, f"#program cumulative(t).\n{self.rules}", f"#program base.\n{facts}"):
            control.add("base", [], part)
        control.ground([("base", [])])
        for step in range(1, STEPS + 1):
            control.ground([("cumulative", [clingo.Number(step)])])
        control.add("end", [], "".join(self.constraints))
        control.ground([("end", [])])
        found = []
        control.solve(on_model=lambda model: found.append(set(map(str, model.symbols(shown=True)))))
        assert len(found) == 1, "what was done decides all"
        return {one for one in found[0] if not one.startswith(("_action_lib", "_explain"))}


@pytest.mark.slow
@pytest.mark.once
@RUNS
@given(st.data())
def test_what_is_left_is_what_the_definitions_leave(data):
    play = Play(data)
    assert play.shown() == play.told
