"""The worker of a solver's process: logs whose states it knows."""

from rosoclingo.oclingo import ReactiveProgram, parse_atom, parse_update
from rosoclingo.oclingo.remote import solver_worker as worker
from rosoclingo.oclingo.remote.wire import plan_to_message, program_to_message
from rosoclingo.oclingo.solving.stream_log import Plan
from rosoclingo.oclingo.solving.transaction import Transaction

LOADED = {
    "program": program_to_message(ReactiveProgram.from_text("#cumulative t. #external e(t). c(t) :- e(t).")),
    "options": {"models": 0},
}


class Unstopped:
    """Commands that end nothing."""

    def interrupted(self):
        return False

    def dropped(self):
        return False


def rebuild(child, number, log):
    child._rebuild({"solver": number, "log": log, "coming": None})


def test_a_state_that_the_child_knows_is_not_made_again(monkeypatch):
    taken, take_again = [], Transaction.take_again
    monkeypatch.setattr(Transaction, "take_again", lambda one, entry: taken.append(entry) or take_again(one, entry))
    child = worker.Worker(Unstopped())
    child._load(LOADED)
    rebuild(child, 1, [])
    log = []
    for step in (1, 2, 3):
        command = {"do": "update", "update": str(parse_update(f"#step {step}. e({step}). #endstep."))}
        reply = child._update(dict(command, solver=1, log=[]))
        log.append(dict(command, horizon=reply["grounded"]))
    rebuild(child, 3, log[:1])
    assert taken == []
    rebuild(child, 2, [*log[:2], {"do": "withdraw", "facts": "e(2)"}])
    assert [type(entry).__name__ for entry in taken] == ["Withdrawal"]
    last = {"do": "update", "update": "#step 4. #endstep.", "log": []}
    assert sorted(child._update(dict(last, solver=2))["answers"][0].split(",")) == ["c(1)", "e(1)"]
    taken.clear()
    other = dict(log[1], update=str(parse_update("#step 2. e(7). #endstep.")))
    rebuild(child, 4, [log[0], other])
    assert [str(entry.update) for entry in taken] == [other["update"]], "and nothing but that is"


def test_another_program_begins_anew():
    """The same log leads elsewhere with it: here the fact is ignored by the first, which defines it itself."""
    child, answers = worker.Worker(Unstopped()), []
    told = {"do": "update", "update": str(parse_update("#step 1. e(1). #endstep.")), "horizon": 1}
    for declaration in ("e(t) :- t > 1.", "#external e(t)."):
        program = ReactiveProgram.from_text(f"#cumulative t. {declaration}")
        child._load({"program": program_to_message(program), "options": {}})
        rebuild(child, 1, [told])
        answers += child._update({"solver": 1, "log": [], "update": "#step 1. #endstep."})["answers"]
    assert answers == ["", "e(1)"]


def test_a_plan_that_is_followed_may_be_told():
    child, plan = worker.Worker(Unstopped()), Plan(frozenset([parse_atom("_action_lib(go,1,2)")]), 2)
    child._load(LOADED)
    rebuild(child, 1, [])
    told = [{"do": "update", "update": f"#step {step}. #endstep.", "horizon": step} for step in (1, 2)]
    child._follow({"solver": 1, "log": told[:1], "plan": plan_to_message(plan)})
    child._follow({"solver": 1, "log": told[1:]})
    assert (child._solvers[1].step, child._solvers[1].log.plan) == (2, plan)


def test_logs_that_were_used_long_ago_are_let_go():
    known = worker.KnownLogs()
    entries = [{"do": "forget", "step": step} for step in range(worker.KNOWN_LOGS + 1)]
    whole = known.longer(worker.StreamLog(), entries)
    logs = [whole]
    while logs[0].length > 1:
        logs.insert(0, logs[0].before)
    assert known.longer(worker.StreamLog(), entries[:2]) is logs[1]
    assert known.longer(worker.StreamLog(), entries) is whole
    assert known.longer(worker.StreamLog(), entries[:1]) is not logs[0]
