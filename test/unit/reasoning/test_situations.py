"""The table of what the core tries in each situation: every row is reached, and the last of each situation applies."""

from itertools import groupby
from pathlib import Path

import pytest
from core_driver import ERRANDS, Driver, FaultyDriver, Leaving
from stream_replay import check_replay
from test_core import Procrastinator
from test_late_facts import BATTERY

from rosoclingo.oclingo import DroppedError, SolverError
from rosoclingo.reasoning import Core, CoreSettings, Halt
from rosoclingo.reasoning.situations import Situation

DOCUMENT = Path(__file__).resolve().parents[3] / "doc" / "statuses.md"

#: An action counts as done whatever returns, so that goals rest on failed ones.
DEAF = """
#external _request/2. #external _return/3.
#program cumulative(t).
wanted(I,t) :- _request(do(W,I),t+1).
wanted(I,t) :- wanted(I,t-1), not _action_lib(arm,I,t-1), not _request(cancel(I),t).
{ _action_lib(arm,I,t) : wanted(I,t) } 1.
#program volatile(t).
:- wanted(I,t), not _action_lib(arm,I,t).
#program base.
#show _action_lib/3.
"""


def text_of(update):
    """The update in one line, without its bound, and what it says of the past."""
    return " ".join(str(update.plain).split()[1:-2])


class FailingDriver(FaultyDriver):
    """A core whose solver raises errors; ``calls`` are the updates in question."""

    def __init__(self):
        self.calls = []
        super().__init__()

    def failing(self, error, *words, search=False):
        """From now on updates with one of the ``words`` raise an error, with ``search`` only if they look ahead."""

        def fault(update):
            text = text_of(update)
            if (words and not any(word in text for word in words)) or (search and not update.bound):
                return None
            self.calls.append(f"{'search' if update.bound else 'take'} {text}")
            return error("no")

        self.fault = fault
        return self


def busy(driver=None):
    """Goal a is under way; it returns success together with a new goal and a fact."""
    driver = driver or FailingDriver()
    driver.goal("a", "do(walk,1)")
    driver.core.add_goal("b", "do(run,2)")
    driver.core.receive("interface", ["_return(walk,failed,1)", "_seen(sun)"])
    return driver


def timed_out(number, ready=lambda driver: driver):
    """Whether the search of this number, counted from when the driver is ``ready``, takes too long."""
    watch = Leaving()
    driver = ready(Driver(watch=lambda: ended(watch())))
    watch.number = number
    return driver


def ended(look):
    """End a search as one that takes too long."""
    return lambda: None if look() is None else Halt("the test")


def two_steps(driver):
    """The first of two actions has succeeded, and a goal is new."""
    driver.core.add_goal("a", "do(walk,1)")
    driver.goal("b", "do(run,2)")
    action = driver.core.awaited[0]
    driver.core.receive("interface", [f"_return({action.interface},{action.parameter},1)"])
    driver.core.add_goal("c", "do(jump,3)")
    return driver


def with_goal(driver):
    driver.core.add_goal("a", "do(walk,1)")
    return driver


S = Situation

#: How each row is reached: the rows of a situation, in order.
WAYS = {
    S.DUE: [lambda: Driver().goal("a", "do(walk,1)")],
    S.REFUSED: [
        lambda: busy().failing(SolverError, "do(run").run(),
        lambda: busy().failing(SolverError, "do(run", "_seen").run(),
        lambda: busy().failing(SolverError).run(),
    ],
    S.DROPPED: [
        lambda: busy().failing(DroppedError, "do(run").run(),
        lambda: FailingDriver().failing(DroppedError, "do(run", search=True).goal("b", "do(run,2)"),
        lambda: busy().failing(DroppedError, "do(run", "_seen").run(),
        lambda: busy().failing(DroppedError).run(),
    ],
    S.UNHANDLED: [lambda: Driver(DEAF).goal("a", "do(x,1)").fail("failed")],
    S.PLAN: [
        lambda: Driver().goal("a", "do(walk,1)"),
        lambda: Driver(solver=lambda _program: Procrastinator(), settings=CoreSettings(horizon_limit=3)),
    ],
    S.NO_PLAN: [
        lambda: Driver().goal("a", "do(never,1)"),
        lambda: Driver(ERRANDS + ":- _seen(end).\n").goal("a", "do(walk,1)").facts("_return(walk,1,1)", "_seen(end)"),
        lambda: (
            Driver(BATTERY + ":- _action_lib(walk,1,t-2).\n")
            .goal("a", "do(walk,1)")
            .finish()
            .goal("b", "do(run,2)")
            .finish()
        ),
        lambda: Driver(ERRANDS + "#program base.\n:- not _seen(sun).\n").goal("a", "do(walk,1)"),
    ],
    S.TIMEOUT: [
        lambda: timed_out(1, two_steps).run(),
        lambda: timed_out(1, two_steps).run(),
        lambda: timed_out(1, with_goal).run(),
    ],
    S.DISTURBED: [lambda: Driver(watch=Leaving(2)).goal("a", "do(walk,1)")],
}

ROWS = [(situation, number) for situation in WAYS for number in range(len(WAYS[situation]))]


def record(monkeypatch, only_last_of=None):
    """Record the rows that apply; of one situation all but the last can be left out."""
    used = []

    def recording(row, place):
        def step(core, state):
            following = row.step(core, state)
            if following is not None:
                used.append(place)
            return following

        return row._replace(step=step)

    places = [(row.situation, number) for row, number in numbered(Core.responses)]
    last = dict(places)
    rows = [recording(row, place) for row, place in zip(Core.responses, places)]
    kept = [row for row, (one, number) in zip(rows, places) if one is not only_last_of or number == last[one]]
    monkeypatch.setattr(Core, "responses", tuple(kept))
    return used


def numbered(rows):
    """The rows, each with its number in its situation."""
    seen = []
    for row in rows:
        yield row, seen.count(row.situation)
        seen.append(row.situation)


def test_table_has_rows_for_each_situation_but_the_end():
    assert [(row.situation, number) for row, number in numbered(Core.responses)] == ROWS
    assert {row.situation for row in Core.responses} == set(Situation) - {S.SETTLED}


@pytest.mark.parametrize(("situation", "number"), ROWS)
def test_each_row_of_the_table_is_reached(monkeypatch, situation, number):
    used = record(monkeypatch)
    driver = WAYS[situation][number]()
    assert (situation, number) in used
    if isinstance(driver, FailingDriver):
        driver.fault = lambda update: None
        driver.now += 100.0
        driver.run()
    assert driver.finish().core.live_goals == []


@pytest.mark.parametrize("situation", list(WAYS))
def test_last_row_of_a_situation_always_applies(monkeypatch, situation):
    for way in WAYS[situation]:
        with monkeypatch.context() as patch:
            used = record(patch, only_last_of=situation)
            way()
            assert (situation, len(WAYS[situation]) - 1) in used


def test_document_shows_the_table():
    lines = ["| situation | tried in this order |", "|---|---|"]
    for situation, rows in groupby(Core.responses, lambda row: row.situation):
        steps = "; ".join(f"{number}. {row.text}" for number, row in enumerate(rows, 1))
        lines.append(f"| {situation.value} | {steps} |")
    assert "\n".join(lines) in DOCUMENT.read_text()


# -- what is left of an update that the solver refuses or drops


DONE, REQUEST, RETURN, FACT = (
    ":- not _action_lib(walk,1,1).",
    "_request(do(run,2),3).",
    "_return(walk,failed,1).",
    "_seen(sun).",
)


@pytest.mark.parametrize("word", ["do(run", "_seen"])
def test_refused_update_is_sent_without_goals_then_without_facts(word):
    driver = busy().failing(SolverError, word).run()
    assert driver.calls[0] == f"search 2. {DONE} {REQUEST} {RETURN} {FACT}"
    assert driver.states("b") == ["rejected"]
    assert driver.message("b") == "do(run,2) is refused by the solver: no"
    assert driver.problems[0] == "update 2 is refused by the solver: no"
    assert driver.awaited == ["_action_lib(walk,1,2)"], "the failure was heard"
    assert RETURN in driver.journal.updates[1]
    assert (FACT in driver.journal.updates[1]) is (word != "_seen")
    check_replay(driver.program, driver.journal)


@pytest.mark.parametrize(("word", "without"), [("do(run", [REQUEST]), ("_seen", [REQUEST, FACT])])
def test_dropped_update_is_sent_without_goals_then_without_facts(word, without):
    driver = busy().failing(DroppedError, word).run()
    parts = [DONE, REQUEST, RETURN, FACT]
    kept = [part for part in parts if part not in without]
    assert " ".join(kept) in " ".join(driver.journal.updates[1].split())
    assert not any(part in driver.journal.updates[1] for part in without)
    assert driver.states("b") == [], "time is no reason to end a goal"
    assert driver.problems[0] == "update 2 is dropped: no"
    driver.fault = lambda update: None
    driver.now += 10.0
    assert driver.run().finish().states("b")[-1] == "succeeded"
    assert FACT in driver.journal.stream


def test_dropped_update_is_sent_once_in_each_form():
    driver = FailingDriver().goal("a", "do(walk,1)").failing(DroppedError)
    driver.succeed()
    assert driver.calls == [f"{how} 2. {DONE} _return(walk,1,1)." for how in ("search", "take")]
