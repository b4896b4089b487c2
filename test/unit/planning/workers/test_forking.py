"""Workers that are forks: the same answers and the same ends as those that are new processes."""

import os
import select
import signal
import time

from children import kill

from rosoclingo.oclingo import ReactiveProgram, parse_update
from rosoclingo.planning.workers.forking import ForkedProcess
from rosoclingo.planning.workers.pool import WorkerPool

ECHO = "#cumulative t.\n#external e(t).\nc(t) :- e(t).\n"


def test_forked_workers_answer_and_are_replaced():
    with WorkerPool(ReactiveProgram.from_text(ECHO), fork=True) as pool:
        solver = pool.solver()
        solver.update(parse_update("#step 1. e(1). #endstep."))
        lost = pool.pid
        kill(pool)
        result = solver.update(parse_update("#step 2. e(2). #endstep."))
        assert pool.pid != lost
    assert sorted(map(str, result.answers[0])) == ["c(1)", "c(2)", "e(1)", "e(2)"]


def test_forked_process_tells_how_it_ended(capfd):
    def fail():
        raise ValueError("a fault of its own")

    killed = ForkedProcess(lambda: time.sleep(600), 0)
    assert killed.poll() is None
    killed.kill()
    assert (killed.wait(), killed.poll(), killed.returncode) == (-signal.SIGKILL, -signal.SIGKILL, -signal.SIGKILL)
    killed.kill()
    assert (ForkedProcess(lambda: None, 0).wait(), ForkedProcess(fail, 0).wait()) == (0, 1)
    assert "ValueError: a fault of its own" in capfd.readouterr().err


def test_forked_process_has_no_other_open_files():
    """Else connections that the parent closes would stay open."""
    reader, writer = os.pipe()
    kept, theirs = os.pipe()
    process = ForkedProcess(lambda: os.write(theirs, b"here") and time.sleep(600), theirs)
    os.close(writer)
    assert os.read(kept, 4) == b"here"
    assert select.select([reader], [], [], 0)[0], "its writer is open in the child"
    process.kill()
    process.wait()
    process.stdin.close()
    for one in (reader, kept, theirs):
        os.close(one)
