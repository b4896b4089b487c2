"""The worker of a solver's process: states that it knows."""

from rosoclingo.oclingo import ReactiveProgram, ReactiveSolver, parse_update
from rosoclingo.oclingo.remote import solver_worker as worker
from rosoclingo.oclingo.remote.wire import program_to_message
from rosoclingo.oclingo.solving.stream_state import StreamState


class Unstopped:
    """Commands that end nothing."""

    def interrupted(self):
        return False

    def dropped(self):
        return False


def test_a_state_that_the_child_knows_is_not_made_again(monkeypatch):
    taken = []

    class Counting(ReactiveSolver):
        def replay(self, update, horizon):
            taken.append(str(update))
            super().replay(update, horizon)

    monkeypatch.setattr(worker, "ReactiveSolver", Counting)
    child = worker.Worker(Unstopped())
    child._load(
        {
            "program": program_to_message(ReactiveProgram.from_text("#cumulative t. #external e(t). c(t) :- e(t).")),
            "options": {"models": 0},
        }
    )
    child._rebuild({"solver": 1, "log": []})
    log = []
    for step in (1, 2, 3):
        command = {"do": "update", "update": f"#step {step}. e({step}). #endstep."}
        reply = child._update(dict(command, solver=1, log=[], checkpoint=False))
        log.append(dict(command, horizon=reply["horizon"]))
    less = {"do": "less", "facts": "e(2)"}
    child._rebuild({"solver": 2, "log": [*log[:2], less]})
    child._rebuild({"solver": 3, "log": log[:1]})
    assert taken == []
    last = {"do": "update", "update": "#step 4. #endstep.", "log": [], "checkpoint": False}
    assert sorted(child._update(dict(last, solver=2))["answers"][0].split(",")) == ["c(1)", "e(1)"]
    other = dict(log[1], update="#step 2. e(7). #endstep.")
    child._rebuild({"solver": 4, "log": [log[0], other]})
    assert [parse_update(text) for text in taken] == [parse_update(other["update"])], "and nothing but that is"


def test_states_that_were_used_long_ago_are_let_go():
    states = worker.States()
    keys = worker.keys_of([{"do": "forget", "step": step} for step in range(worker.STATES + 1)])
    for key in keys:
        states.keep(key, StreamState(1, 1))
    assert [states.after(keys[:number]) for number in (1, 2, worker.STATES + 1)] == [0, 2, worker.STATES + 1]
