"""The core's input of facts: what the callback of the topic leaves for the worker."""

import threading
from unittest.mock import MagicMock, Mock


def test_fact_intake_announcements_delay_no_return(messages, monkeypatch):
    """The worker takes nothing during a search, while each interface announces itself once a second."""
    from rosoclingo.nodes.core import fact_intake

    subscriber, core, worker = MagicMock(), Mock(), Mock()
    monkeypatch.setattr(fact_intake.rospy, "Subscriber", subscriber)
    intake = fact_intake.FactIntake(core, Mock(), worker, Mock(listeners=()))
    intake.connect()

    def hear(interface, *facts):
        message = messages.InterfaceIO(interface, list(facts))
        message._connection_header = {"callerid": "/interfaces"}
        subscriber.call_args[0][2](message)

    def search():
        for _ in range(2 * fact_intake.MOST_WAITING):
            hear("walk")
            hear("hold")
        hear("walk", "_return(walk,2,1)")

    connection = threading.Thread(target=search, daemon=True)
    connection.start()
    connection.join(60.0)
    intake.announce()
    for call in worker.put.call_args_list:
        call[0][0]()
    core.receive.assert_called_once_with("walk", ("_return(walk,2,1)",))
    assert sorted(call[0][0] for call in core.interfaces.announce.call_args_list) == ["hold", "walk"]
