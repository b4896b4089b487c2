"""The command request; rostest core_start has its output until a cancelled goal has ended."""

from importlib import import_module
from unittest.mock import Mock


def test_request_interrupted_before_server_exists_sends_nothing(messages, monkeypatch):
    command = import_module("rosoclingo.nodes.request")
    client, said = Mock(**{"wait_for_server.side_effect": KeyboardInterrupt}), []
    monkeypatch.setattr(command, "GoalClient", lambda server: client)
    assert command.request("goal(a,b,1)", "rosoclingo", 1.0, said.append) == command.EXIT_CODES["lost"]
    assert said == ["stopped waiting for the action server 'rosoclingo'; nothing was sent"]
    client.send.assert_not_called()
