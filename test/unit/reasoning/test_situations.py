"""The table of the core's attempts in each situation: every row is reached."""

from itertools import groupby

import pytest
from core_driver import DeferringSolver, Driver, FaultyDriver, Leaving
from core_programs import DARK, DOOMED, IMPOSSIBLE, fetch
from core_scripts import play
from shipped import ROOT

from rosoclingo.oclingo import DroppedError, SolverError
from rosoclingo.reasoning.core import Core
from rosoclingo.reasoning.settings import CoreSettings
from rosoclingo.reasoning.situations import Situation

DOCUMENT = ROOT / "doc" / "statuses.md"


def busy(fault=None, *words):
    """Goal a is under way; its failure comes with a new goal and a fact. Updates with the given words have a fault."""
    driver = FaultyDriver().goal("a", "do(walk,1)").fail_for(fault, *words)
    driver.core.add_goal("b", "do(run,2)")
    return driver.facts("_return(walk,failed,1)", "_seen(sun)")


def timed_out(number, *events):
    """After these events, let the search of this number time out; the driver continues."""
    driver = play(FaultyDriver(), "; ".join(events))
    driver.end_search(number, slow=True)
    return driver.run()


#: The first of two actions, in either order, has succeeded, and a goal is new.
TWO_STEPS = (
    *("add a do(walk,1)", "goal b do(run,2)"),
    *("hear interface _return(walk,1,1) _return(run,2,1)", "add c do(jump,3)"),
)


S = Situation

#: The events by which each row is reached: the rows of a situation, in order.
WAYS = {
    S.DUE: [lambda: Driver().goal("a", "do(walk,1)")],
    S.REFUSED: [
        lambda: busy(SolverError, "do(run"),
        lambda: busy(SolverError, "do(run", "_seen"),
        lambda: busy(SolverError),
    ],
    S.DROPPED: [
        lambda: busy(DroppedError, "do(run"),
        lambda: FaultyDriver().fail_for(DroppedError, "search...do(run").goal("b", "do(run,2)"),
        lambda: busy(DroppedError, "do(run", "_seen"),
        lambda: busy(DroppedError),
    ],
    S.UNHANDLED: [lambda: Driver(fetch()).goal("a", "fetch(cup,1)").fail("failed")],
    S.PLAN: [
        lambda: Driver().goal("a", "do(walk,1)"),
        lambda: Driver(solver=lambda _program: DeferringSolver(), settings=CoreSettings(horizon_limit=3)),
    ],
    S.NO_PLAN: [
        lambda: Driver().goal("a", "do(never,1)"),
        lambda: Driver(DOOMED).goal("a", "do(walk,1)").facts("_return(walk,1,1)", "_seen(end)"),
        lambda: Driver(IMPOSSIBLE).goal("a", "do(walk,1)").finish().goal("b", "do(run,2)").finish(),
        lambda: Driver(DARK).goal("a", "do(walk,1)"),
    ],
    S.TIMEOUT: [
        lambda: timed_out(1, *TWO_STEPS),
        lambda: timed_out(1, *TWO_STEPS),
        lambda: timed_out(1, "add a do(walk,1)"),
    ],
    S.DISTURBED: [lambda: Driver(watch=Leaving(2)).goal("a", "do(walk,1)")],
}

ROWS = [(situation, number) for situation in WAYS for number in range(len(WAYS[situation]))]


def record(monkeypatch):
    """Record the rows that apply."""
    used = []

    def recording(row, place):
        def step(core, state):
            following = row.step(core, state)
            if following is not None:
                used.append(place)
            return following

        return row._replace(step=step)

    places = [(row.situation, number) for row, number in numbered(Core.responses)]
    rows = [recording(row, place) for row, place in zip(Core.responses, places)]
    monkeypatch.setattr(Core, "responses", tuple(rows))
    return used


def numbered(rows):
    """Return the rows, each with its number in its situation."""
    seen = []
    for row in rows:
        yield row, seen.count(row.situation)
        seen.append(row.situation)


def test_situation_table_covers_each_situation_except_end():
    assert [(row.situation, number) for row, number in numbered(Core.responses)] == ROWS
    assert {row.situation for row in Core.responses} == set(Situation) - {S.SETTLED}


@pytest.mark.parametrize(("situation", "number"), ROWS)
def test_situation_table_rows_are_all_reached(monkeypatch, situation, number):
    used = record(monkeypatch)
    driver = WAYS[situation][number]()
    assert (situation, number) in used
    if isinstance(driver, FaultyDriver):
        play(driver, "fault none; wait 100")
    assert driver.finish().core.live_goals == []


def test_situation_table_matches_the_document():
    lines = ["| situation | tried in this order |", "|---|---|"]
    for situation, rows in groupby(Core.responses, lambda row: row.situation):
        steps = "; ".join(f"{number}. {row.text}" for number, row in enumerate(rows, 1))
        lines.append(f"| {situation.value} | {steps} |")
    assert "\n".join(lines) in DOCUMENT.read_text()
