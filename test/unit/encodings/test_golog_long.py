"""Long histories of control programs: the stored state does not grow, and ended programs are forgotten."""

import pytest
from core_driver import Driver, shortest
from golog_scripts import domain_with
from stream_play import compacting
from workloads import sized

from rosoclingo.reasoning import stream_planner

PROGRAMS = """
proc watch { prefer { interrupts { when f { c; await not f; } } until g; } over { await g; } }
proc errand { do { try { a; b; } else { d; } a; } on cancel { tidy; } }
"""


#: Rounds of a program that never ends; each takes at least four cycles.
ROUNDS = sized(7, 15)


@pytest.fixture(autouse=True)
def at_once(monkeypatch):
    """Compact steps as early as possible; steps that an open goal has seen, after 5 cycles."""
    monkeypatch.setattr(stream_planner, "LONG_AGO", 5)
    with compacting(1):
        yield


@pytest.mark.slow
def test_golog_endless_program_keeps_a_bounded_past():
    solver = shortest(domain_with(PROGRAMS, _g_told="4"))
    driver = Driver(program=solver.program, solver=lambda _: solver)
    driver.goal("watch", "run(watch,0)")
    sizes = []
    for number in range(1, 1 + ROUNDS):
        driver.facts("_set(f,now)").finish()
        driver.facts("_unset(f,now)").finish()
        if number % 3 == 0:
            driver.goal(f"g{number}", f"run(errand,{number})").finish()
            assert driver.states(f"g{number}")[-1] == "succeeded"
        if number > 3:
            assert solver.snapshot.past.first >= driver.core.cycle - 8
            sizes.append(len(solver.snapshot.past.facts))
    assert driver.states("watch")[-1] == "active"
    assert driver.core.cycle > 4 * ROUNDS
    assert max(sizes) < 20
    assert not any("_g_ended(3," in str(fact) for fact in solver.snapshot.past.facts), "it is forgotten how it ended"
