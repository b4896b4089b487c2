"""The input feeder: goals whose identifier is that of an aborted or rejected goal."""

from rosoclingo.oclingo import parse_term
from rosoclingo.reasoning.goals import Goal
from rosoclingo.reasoning.input_feeder import InputFeeder

ONE, TWO = parse_term("1"), parse_term("2")


def feeder_with_goal():
    """Return a feeder with a new goal of identifier 1."""
    feeder = InputFeeder()
    feeder.add_goal(Goal("key", parse_term("g(1)")))
    return feeder


def requests(batch):
    """Return the requests of an update as texts."""
    return [str(head) for head in batch.update.heads]


def test_feeder_goal_waits_until_cancel_of_its_identifier_is_known():
    feeder = feeder_with_goal()
    feeder.add_cancellation(ONE)
    batch = feeder.next_update(5)
    assert requests(batch) == ["_request(cancel(1),5)"]
    feeder.update_accepted(batch)
    assert requests(feeder.next_update(6)) == ["_request(g(1),7)"]


def test_feeder_cancels_rejected_goals_that_are_not_requested_again():
    feeder = feeder_with_goal()
    for identifier in (ONE, TWO):
        feeder.add_rejection(identifier)
    assert requests(feeder.next_update(3)) == ["_request(cancel(2),3)", "_request(g(1),4)"]
