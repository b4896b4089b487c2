"""More goals than the program is told of at a time wait for their turn."""

from core_driver import Driver

from rosoclingo.reasoning import CoreSettings


def test_goals_beyond_the_number_at_once_wait_for_their_turn():
    driver = Driver(settings=CoreSettings(horizon_limit=8, goals_at_once=2))
    for number in range(1, 6):
        driver.core.add_goal(f"g{number}", f"do(walk,{number})")
    driver.run()
    told = "".join(update for update in driver.journal.updates)
    assert [number for number in range(1, 6) if f"do(walk,{number})" in told] == [1, 2]
    assert driver.states("g3") == []
    driver.cancel("g4")
    assert driver.states("g4") == ["recalling", "recalled"]
    driver.finish()
    assert [driver.states(f"g{number}")[-1] for number in (1, 2, 3, 5)] == ["succeeded"] * 4
    told = "".join(update for update in driver.journal.updates)
    assert "do(walk,4)" not in told
    assert told.index("do(walk,3)") < told.index("do(walk,5)")


def test_a_core_that_goes_away_ends_goals_that_wait_as_well():
    driver = Driver(settings=CoreSettings(horizon_limit=8, goals_at_once=1))
    for number in (1, 2, 3):
        driver.core.add_goal(f"g{number}", f"do(walk,{number})")
    driver.core.abandon("is given up")
    assert [driver.states(f"g{number}")[-1] for number in (1, 2, 3)] == ["aborted"] * 3
    assert not driver.core.advance(2.0)
