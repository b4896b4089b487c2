"""The worker thread: ordered jobs, settlers, questions, and one policy for errors."""

import queue
import subprocess
import sys
import threading

import pytest

rospy = pytest.importorskip("rospy")
worker_module = pytest.importorskip("rosoclingo.common.worker")
PATIENCE = 120.0  # seconds of wall time


@pytest.fixture
def make():
    """Make workers that end with the test."""
    made, before = [], threading.enumerate()

    def one(*arguments, **settings):
        made.append(worker_module.Worker(*arguments, **settings))
        return made[-1]

    yield one
    for worker in made:
        worker.stop(PATIENCE)
    assert [one for one in threading.enumerate() if one.name == "worker" and one not in before] == []


def test_worker_does_jobs_in_order_then_settles(make):
    seen = queue.Queue()
    worker = make(lambda: seen.put("settled"), period=60.0)
    for number in range(3):
        worker.put(lambda number=number: seen.put(number))
    assert worker.waiting
    worker.start()
    assert [seen.get(timeout=PATIENCE) for _ in range(4)] == [0, 1, 2, "settled"]


def test_worker_answers_questions(make, monkeypatch):
    worker = make()
    monkeypatch.setattr(rospy, "get_name", lambda: "/node")
    with pytest.raises(rospy.ServiceException, match="/node does not answer"):
        worker.ask(lambda: 1, timeout=0.01)
    worker.start()
    assert worker.ask(lambda: 42, PATIENCE) == 42


@pytest.mark.slow
@pytest.mark.parametrize("job", [lambda: 1 / 0, None])
def test_worker_end_leaves_no_question_waiting(make, monkeypatch, job):
    monkeypatch.setattr(rospy, "get_name", lambda: "/node")
    monkeypatch.setattr(rospy, "logfatal", lambda *_: None)
    monkeypatch.setattr(rospy, "signal_shutdown", lambda _: None)
    monkeypatch.setattr(worker_module, "_failure", threading.Event())
    worker = make()
    asked, found, put = threading.Event(), queue.Queue(), worker.put
    worker.put(job)
    monkeypatch.setattr(worker, "put", lambda question: (put(question), asked.set()))

    def ask():
        try:
            found.put(worker.ask(lambda: 1, timeout=3600.0))
        except rospy.ServiceException as error:
            found.put(str(error))

    threading.Thread(target=ask, daemon=True).start()
    assert asked.wait(PATIENCE)
    worker.start()
    assert found.get(timeout=PATIENCE) == "/node does not answer: its worker has ended"
    ask()
    assert found.get_nowait() == "/node does not answer: its worker has ended", "a question that comes later"


NODE = """
import sys, rospy
from rosoclingo.common import starting
from rosoclingo.common.worker import Worker

rospy.init_node = lambda name: rospy.core.set_initialized(True)  # there is no master

def node():
    worker = Worker()
    worker.put(lambda: {job})
    worker.start()

sys.exit(starting.run_node("node", node, ()))
"""


@pytest.mark.slow
@pytest.mark.parametrize(("job", "code"), [("1 / 0", 1), ("sys.exit()", 1), ("rospy.signal_shutdown('asked to')", 0)])
def test_worker_failure_gives_the_node_exit_code_1(job, code):
    done = subprocess.run(
        [sys.executable, "-c", NODE.format(job=job)], capture_output=True, text=True, check=False, timeout=120
    )
    assert done.returncode == code, done.stderr
    assert ("the worker failed, the node shuts down" in done.stderr) == bool(code)
