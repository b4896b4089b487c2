"""The command request: its messages about a cancelled goal."""

from importlib import import_module
from types import SimpleNamespace

import pytest

from rosoclingo.planning.explaining.atom_patterns import pattern_in
from rosoclingo.runs.sentences import PatternSentence, Sentences

WALK = PatternSentence(pattern_in("walk(Room)"), "Walk to room {Room}")


@pytest.fixture
def command(messages, monkeypatch):
    """The module of the command, which gets the client below."""
    module = import_module("rosoclingo.nodes.request")
    monkeypatch.setattr(module, "GoalClient", Client)
    monkeypatch.setattr(module, "words_of", lambda core: Sentences({"walk": "walks to {}"}, [WALK]))
    return module


def feedback(state):
    return SimpleNamespace(cycle=1, status=state, position=0, task_plan=["_action_lib(walk,3,1)"])


class Client:
    """A client whose only goal is cancelled by Ctrl-C and ends as the last feedback says."""

    node = "rosoclingo"

    def __init__(self, server):
        self.text, self.feedback, self.outcome, self.message = "walk(3)", feedback("active"), "", ""
        self.looks = self.feedbacks()

    def feedbacks(self):
        yield from (None, KeyboardInterrupt, None)
        self.feedback = feedback("preempting")
        yield None
        self.outcome, self.message = "canceled", "as you like"
        yield None

    def wait_for_server(self, seconds):
        return True

    def send(self, text):
        pass

    def cancel(self):
        pass

    def wait(self, seconds):
        error = next(self.looks)
        if error:
            raise error

    def check(self):
        pass


@pytest.mark.parametrize(
    ("plain", "first", "then", "end"),
    [
        (True, "walks to 3", "is cancelled: walks to 3", "Walk to room 3: cancelled"),
        (
            False,
            "cycle 1, active: _action_lib(walk,3,1)",
            "cycle 1, preempting: _action_lib(walk,3,1)",
            "canceled: as you like",
        ),
    ],
)
def test_request_reports_each_action_once_after_cancel(plain, first, then, end, command):
    said = []
    assert command.request("walk(3)", "rosoclingo", 1.0, said.append, plain) == 2
    cancelling = "cancelling walk(3) (Ctrl-C again: do not wait)"
    assert said == [first, cancelling, then, end]


def test_request_reports_missing_interface_in_place_of_action(command, monkeypatch):
    waiting = "waiting: no interface 'walk' for _action_lib(walk,3,1): no node subscribes to out_rosoclingo"
    monkeypatch.setattr("test_request.feedback", lambda state, make=feedback: make(waiting))
    said = []
    command.request("walk(3)", "rosoclingo", 1.0, said.append, True)
    assert [one for one in said if "walk" in one][:1] == [waiting]


def test_request_interrupted_before_server_exists_sends_nothing(command, monkeypatch):
    def interrupted(self, seconds):
        raise KeyboardInterrupt

    monkeypatch.setattr(Client, "wait_for_server", interrupted)
    said = []
    assert command.request("goal(a,b,1)", "rosoclingo", 1.0, said.append) == command.EXIT_CODES["lost"]
    assert said == ["stopped waiting for the action server 'rosoclingo'; nothing was sent"]
