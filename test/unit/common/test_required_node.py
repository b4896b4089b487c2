"""A node ends the roslaunch that would restart it without success, and no other process."""

import os
import signal
import threading
from xmlrpc.server import SimpleXMLRPCServer

import pytest

from rosoclingo.common import required_node
from rosoclingo.common.required_node import RequiredNode

NODE = "/robot/core"


class StartError(Exception):
    """An error that a start can raise."""


class Serving:
    """XML-RPC servers with fixed values, for the methods of ROS's master and of roslaunch that the code calls."""

    def __init__(self):
        self._servers = []

    def add(self, **answers):
        """Return the address of a server with these functions, which return ``(1, "", VALUE)`` for their values."""
        server = SimpleXMLRPCServer(("localhost", 0), logRequests=False, allow_none=True)
        for name, value in answers.items():
            server.register_function(lambda *given, value=value: (1, "", value(*given)), name)
        threading.Thread(target=server.serve_forever, args=[0.01], daemon=True).start()
        self._servers.append(server)
        return f"http://localhost:{server.server_address[1]}"

    def close(self):
        """Shut down all servers."""
        for server in self._servers:
            server.shutdown()
            server.server_close()


@pytest.fixture
def serving():
    servers = Serving()
    yield servers
    servers.close()


@pytest.fixture
def ended(monkeypatch):
    """The processes that received a signal, with its number."""
    signals = []
    monkeypatch.setattr(required_node.os, "kill", lambda *signal: signals.append(signal))
    monkeypatch.setattr(required_node.sys, "argv", ["core", "__name:=core", "__log:=/tmp/core.log"])
    monkeypatch.setenv("ROS_NAMESPACE", "robot")
    return signals


def roslaunch(serving, process=None, children=(), **info):
    """A roslaunch with two processes, which does not know its master."""
    infos = {"master": {1: "no"}, "other": {"pid": 1, "respawn": True, "spawn_count": 9}, "core-2": info}
    return serving.add(
        get_pid=lambda: os.getppid() if process is None else process,
        get_node_names=lambda: list(infos),
        process_info=infos.get,
        list_children=lambda: list(children),
    )


def master(serving, monkeypatch, *launches, **parameters):
    """A master that knows these roslaunches and others that have ended."""
    uris = {str(number): uri for number, uri in enumerate(["http://localhost:1", *launches])}
    values = {"/roslaunch/uris": uris, f"{NODE}/required": True, **parameters}
    monkeypatch.setenv("ROS_MASTER_URI", serving.add(getParam=lambda _caller, key: values[key]))


def own(**changes):
    """Return the entry of this process in a roslaunch."""
    return {"pid": os.getpid(), "respawn": True, "spawn_count": 1, **changes}


THE_END = [(os.getppid(), signal.SIGINT)]


@pytest.mark.parametrize(
    ("error", "changes", "required", "ends"),
    [
        *((error, {}, True, True) for error in (StartError("a fault"), SystemExit(1), SystemExit("no clingo"))),
        # it did not fail, is not restarted, or belongs to no roslaunch or one that does not need it
        *((error, {}, True, False) for error in (SystemExit(0), SystemExit(None), KeyboardInterrupt())),
        (StartError(), {"respawn": False}, True, False),
        (StartError(), {"pid": 1}, True, False),
        (StartError(), {}, "yes", False),
    ],
)
def test_required_node_with_failed_start_ends_its_roslaunch(
    serving, ended, monkeypatch, capsys, error, changes, required, ends
):
    """Its roslaunch is on a remote machine: the master knows only the parent."""
    parent = roslaunch(serving, process=1, children=[roslaunch(serving, **own(**changes))])
    master(serving, monkeypatch, parent, **{f"{NODE}/required": required})
    with pytest.raises(type(error)), RequiredNode():
        raise error
    assert ended == (THE_END if ends else [])
    assert (f"{NODE}: a restart cannot help: ending roslaunch" in capsys.readouterr().err) == ends


def test_required_node_started_by_hand_asks_no_roslaunch(ended, monkeypatch, capsys):
    monkeypatch.setattr(required_node.sys, "argv", ["core", "__name:=core"])
    monkeypatch.delenv("ROS_MASTER_URI", raising=False)
    with pytest.raises(StartError), RequiredNode():
        raise StartError
    assert (ended, capsys.readouterr().err) == ([], "")


@pytest.mark.parametrize("uri", ["http://localhost:1", None])
def test_required_node_reports_a_missing_master(ended, monkeypatch, capsys, uri):
    monkeypatch.delenv("ROS_MASTER_URI", raising=False)
    if uri:
        monkeypatch.setenv("ROS_MASTER_URI", uri)
    with pytest.raises(StartError), RequiredNode():
        raise StartError
    assert ended == []
    assert "cannot find out whether to end roslaunch" in capsys.readouterr().err


def live(happens, code):
    """Start a node, let an event happen, and end the node."""
    with RequiredNode() as required:
        required.is_up(None)
        happens()
        raise SystemExit(code)


@pytest.mark.parametrize(
    ("starts", "seconds", "ends"), [(1, 0.0, False), (2, 0.0, True), (2, 1000.0, False)], ids=["first", "again", "late"]
)
def test_required_node_that_crashes_early_ends_roslaunch(serving, ended, monkeypatch, starts, seconds, ends):
    now = [5.0]
    monkeypatch.setattr(required_node.time, "monotonic", lambda: now[0])
    master(serving, monkeypatch, roslaunch(serving, **own(spawn_count=starts)))
    with pytest.raises(SystemExit):
        live(lambda: now.insert(0, now[0] + seconds), 1)
    assert ended == (THE_END if ends else [])
