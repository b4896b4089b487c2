"""The core's state in values, and its problems as lines of a log."""

from core_driver import Driver

from rosoclingo.reasoning import PlanMade, Problem
from rosoclingo.reasoning.complaints import MANY, QUIET, Complaints
from rosoclingo.reasoning.health import FRESH, Health, Level


def test_the_same_is_said_once():
    complaints = Complaints()
    assert (
        complaints.take(Problem(3, "'_return(a,1,2)' is ignored", "arm"), 0.0) == "cycle 3: '_return(a,1,2)' is ignored"
    )
    for number in range(50):
        assert complaints.take(Problem(3, f"'_return(a,1,{number})' is ignored", "arm"), 1.0) == ""
    assert complaints.count == 51
    assert complaints.latest == "cycle 3: '_return(a,1,49)' is ignored"
    assert complaints.take(Problem(3, "'_return(a,1,2)' is ignored", "leg"), 1.0)
    assert complaints.take(Problem(9, "'_return(a,1,2)' is ignored", "arm"), QUIET + 1.0)


def test_many_different_problems_of_one_interface():
    complaints = Complaints()
    lines = [complaints.take(Problem(1, "x" * number, "arm"), 0.0) for number in range(100)]
    said = [line for line in lines if line]
    assert len(said) == MANY
    assert said[-1].endswith("only counted for a minute")
    assert complaints.take(Problem(1, "y", "leg"), 0.0)
    assert complaints.take(Problem(1, "z", "arm"), QUIET)


def test_the_cores_own_problems_are_the_same_if_their_texts_are():
    complaints = Complaints()
    assert complaints.take(Problem(1, "update 1 is refused"), 0.0)
    assert complaints.take(Problem(2, "update 2 is refused"), 0.0)
    assert not complaints.take(Problem(3, "update 2 is refused"), 0.0)


def test_report():
    health = Health()
    assert health.report(1, 0, [], 0, 0.0).level is Level.OK
    assert health.report(1, 0, [], 0, 0.0).message == "idle"
    health.plan_made(PlanMade(4, 7, (), 0.25, 0.5))
    report = health.report(4, 2, ["_action_lib(a,b,4)"], 1, 0.0)
    assert report.level is Level.OK
    assert report.message == "waits for _action_lib(a,b,4)"
    assert report.values == {
        "cycle": "4",
        "horizon": "7",
        "open goals": "2",
        "awaited actions": "_action_lib(a,b,4)",
        "last solve time": "0.500",
        "last ground time": "0.250",
        "problems": "0",
        "last error": "",
    }


def test_nobody_listens():
    report = Health().report(4, 2, ["_action_lib(a,b,4)"], 0, 0.0)
    assert report.level is Level.WARN
    assert report.message == "nobody listens on out_rosoclingo; waits for _action_lib(a,b,4)"


def test_a_problem_is_a_warning_for_a_while():
    health = Health()
    health.problem(Problem(4, "all is lost"), 100.0)
    assert health.report(4, 0, [], 1, 100.0 + FRESH / 2) == (
        Level.WARN,
        "cycle 4: all is lost",
        {**health.report(4, 0, [], 1, 0.0).values, "problems": "1", "last error": "cycle 4: all is lost"},
    )
    assert health.report(4, 0, [], 1, 100.0 + FRESH).level is Level.OK
    assert health.report(4, 0, [], 1, 100.0 + FRESH).values["last error"] == "cycle 4: all is lost"


def test_problems_name_the_interface_that_they_are_about():
    driver = Driver().goal("a", "do(walk,1)").facts("garbage((", "_unheard(1)")
    driver.now += 1e6
    driver.run()
    assert [problem.origin for problem in driver.journal.of(Problem)] == ["interface", "interface", "walk"]


def test_a_long_problem_is_told_by_its_beginning_and_its_end():
    complaints = Complaints()
    line = complaints.take(Problem(1, f"'seen({'9' * 100_000})' is ignored: it makes no sense", "eye"), 0.0)
    assert len(line) < 1000
    assert line.startswith("cycle 1: 'seen(999")
    assert line.endswith("it makes no sense")
