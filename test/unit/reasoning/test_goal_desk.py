"""The desk: who is let in, who waits, who is told what."""

import pytest

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.reasoning import GoalChanged, GoalRefused, GoalState, Outcome
from rosoclingo.reasoning.goal_manager import GoalDesk
from rosoclingo.reasoning.input_feeder import InputFeeder


class Desk:
    """A desk with its feeder, and what was told."""

    def __init__(self, text="#external _request/2.", at_once=0):
        self.feeder, self.told = InputFeeder(), []
        self.desk = GoalDesk(ReactiveProgram.from_text(text), self.feeder, self.told.append, lambda: 7, at_once)

    def add(self, *numbers):
        for number in numbers:
            self.desk.add(f"g{number}", f"go({number})")
        return self

    def feed(self, step=1):
        """The update of a step reaches the program; the requests in it."""
        batch = self.feeder.next_update(step)
        self.feeder.taken(batch)
        return [str(item.head) for item in batch.update.items]

    @property
    def live(self):
        return [goal.key for goal in self.desk.live]

    @property
    def fed(self):
        return [goal.key for goal in self.desk.fed]

    def ends(self):
        return [(event.key, event.outcome) for event in self.told if isinstance(event, GoalChanged) and event.outcome]


def test_any_number_of_goals_is_with_the_program():
    desk = Desk().add(*range(1, 8))
    assert len(desk.feed()) == 7
    assert desk.live == desk.fed == [f"g{number}" for number in range(1, 8)]


@pytest.mark.parametrize("at_once", [1, 2, 3])
def test_some_at_once(at_once):
    desk = Desk(at_once=at_once).add(1, 2, 3, 4, 5)
    assert len(desk.feed()) == at_once
    assert desk.fed == ["g1", "g2", "g3"][:at_once]
    assert len(desk.live) == 5
    assert desk.feed() == []


def test_the_end_of_one_lets_the_next_in():
    desk = Desk(at_once=2).add(1, 2, 3, 4)
    desk.feed()
    desk.desk.end(desk.desk.fed[:1], Outcome.SUCCEEDED, "is done")
    assert desk.feed(2) == ["_request(go(3),3)"]
    desk.desk.end(desk.desk.fed, Outcome.SUCCEEDED, "is done")
    assert desk.feed(3) == ["_request(go(4),4)"]
    assert desk.live == ["g4"]


def test_one_that_waits_is_cancelled():
    desk = Desk(at_once=1).add(1, 2, 3)
    desk.desk.cancel("g2")
    desk.desk.cancel("g1")
    assert desk.feed() == ["_request(go(3),2)"]
    assert desk.ends() == [("g2", Outcome.CANCELED), ("g1", Outcome.CANCELED)]


def test_cancelled_once_it_is_with_the_program():
    desk = Desk().add(1)
    desk.feed()
    desk.desk.cancel("g1")
    desk.desk.cancel("g1")
    assert desk.feed(2) == ["_request(cancel(1),2)"]
    assert desk.live == ["g1"]


def test_goals_that_are_dropped_are_cancelled_for_the_program():
    desk = Desk().add(1, 2)
    desk.feed()
    desk.desk.drop(desk.desk.fed[:1], "cannot be met")
    assert desk.feed(4) == ["_request(cancel(1),4)"]
    assert desk.ends() == [("g1", Outcome.ABORTED)]


def test_goals_that_have_ended_stay_as_they_are():
    desk = Desk().add(1, 2)
    goals = desk.desk.live
    desk.desk.end(goals[:1], Outcome.SUCCEEDED, "is done")
    desk.desk.end(goals, Outcome.ABORTED, "is given up")
    assert [goal.state for goal in goals] == [GoalState.SUCCEEDED, GoalState.ABORTED]
    assert desk.feed() == []


def test_undeclared_requests_end_their_goals_alone():
    desk = Desk().add(1, 2)
    desk.feed()
    warning = "Head _request(go(2),2) has not been declared external. The entire rule will be ignored."
    desk.desk.reject_undeclared(desk.desk.fed, ["something else", warning])
    assert desk.live == ["g1"]
    assert desk.ends() == [("g2", Outcome.REJECTED)]


@pytest.mark.parametrize(
    ("key", "text", "reason"),
    [
        ("g1", "go(2)", "is in use"),
        ("g2", "stay(1)", "is taken"),
        ("g2", "go(", "no ground term"),
        ("g2", "(go,2)", "names no goal"),
    ],
)
def test_refused(key, text, reason):
    desk = Desk().add(1)
    desk.desk.add(key, text)
    refused = [event for event in desk.told if isinstance(event, GoalRefused)]
    assert [(event.cycle, event.key, event.text) for event in refused] == [(7, key, text)]
    assert reason in refused[0].message
    assert desk.live == ["g1"]


def test_a_program_that_takes_no_requests():
    desk = Desk("#external _request/1.").add(1)
    assert "no external _request/2" in desk.told[0].message
    assert desk.live == []
