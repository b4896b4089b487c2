"""The memory of a core grows neither with the number of goals nor with the length of their texts."""

import gc

import pytest
from core_driver import FORGETFUL, Driver
from workloads import sized

#: Goals after which all bounded containers are full; the solver compacts more often than that.
GOALS = sized(60, 90)  # after these goals the solver has compacted at every place where it can


def objects(driver, first, last):
    """Run goals to success one after the other; return the lowest number of objects meanwhile."""
    found = []
    for number in range(first, last):
        driver.goal(f"key{number}", f"do({number})")
        driver.succeed()
        if number % 10 == 0:
            gc.collect()
            found.append(len(gc.get_objects()))
    return min(found)


@pytest.mark.slow
def test_core_memory_does_not_grow_with_goals():
    driver = Driver(FORGETFUL, events=10)
    gc.freeze()  # the objects of other tests are neither counted nor visited
    objects(driver, 0, GOALS)
    more = sized(20, GOALS)
    before = objects(driver, GOALS, GOALS + more)
    assert objects(driver, GOALS + more, GOALS + 2 * more) - before < more, "an object or more is kept for each goal"
