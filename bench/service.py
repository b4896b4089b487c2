#!/usr/bin/env python3
"""Compares updates through the TCP service with the same updates in the library, and measures starts of the command.

Service and library take turns, update by update, so that other load on the machine affects both; compare the ratios. A
start is the processor time of all processes of the command until it has answered one update and ended. Needs no ROS:

    ./dev exec python3 bench/service.py
"""

import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from figures import Figure, Option, children_time, main
from service_helpers import Client

from rosoclingo.oclingo import ReactiveProgram, ReactiveSolver, parse_update

SMALL = "#cumulative t.\n#external e(t).\nc(t) :- e(t).\n#volatile t.\n:- t < 0.\n"
#: A program whose answers have about three hundred atoms.
WIDE = "#base.\nroom(1..300).\n#cumulative t.\n#external e(t).\nat(X,t) :- e(t), room(X).\n#volatile t.\n:- t < 0.\n"
#: A program in the language of gringo 3, which has to be translated.
OLD = "#base.\nroom(1..3).\n#cumulative t.\n#external e(X,t) : room(X) : X != 2.\n#volatile t.\n:- t < 0.\n"
SCRIPT = str(Path(__file__).parents[1] / "scripts" / "oclingo")


def compare(program, count):
    """Return the milliseconds of each update in the library and through the service."""
    library, service, solver = [], [], ReactiveSolver(ReactiveProgram.from_text(program))
    with tempfile.NamedTemporaryFile("w", suffix=".lp") as file:
        file.write(program)
        file.flush()
        command = [sys.executable, SCRIPT, file.name, "--port", "0"]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
            try:
                client = Client(int(process.stdout.readline().rsplit(":", 1)[1]))
                for number in range(count):
                    text = f"#step {1 + number // 10}. #volatile. e({1 + number // 10}). #endstep."
                    start = time.perf_counter()
                    solver.update(parse_update(text))
                    middle = time.perf_counter()
                    client.send(text)
                    while "End of Step." not in client.item():
                        pass
                    library.append(1000 * (middle - start))
                    service.append(1000 * (time.perf_counter() - middle))
            finally:
                process.terminate()
    return library, service


def start_stream(program):
    """Play a stream of one update."""
    with tempfile.TemporaryDirectory() as folder:
        file, stream = Path(folder, "program.lp"), Path(folder, "updates.str")
        file.write_text(program)
        stream.write_text("#step 1. #endstep.\n")
        command = [sys.executable, SCRIPT, str(file), "--stream", str(stream)]
        subprocess.run(command, stdout=subprocess.DEVNULL, check=True)


def measure(options):
    """Yield the figures of updates and of starts."""
    for name, program in (("3 atoms", SMALL), ("300 atoms", WIDE)):
        here, there = map(statistics.median, compare(program, options.updates))
        yield Figure(f"{name}, library", here, "ms")
        yield Figure(f"{name}, service", there, "ms")
        yield Figure(f"{name}, service over library", there / here, "")
    for name, start in (("stream", start_stream), ("service", lambda program: compare(program, 1))):
        for language, program in (("clingo's", SMALL), ("gringo 3's", OLD)):
            times = []
            for _ in range(options.starts):
                before = children_time()
                start(program)
                times.append(1000 * (children_time() - before))
            yield Figure(f"{name} starts, {language} language", statistics.median(times), "ms of processor")


if __name__ == "__main__":
    main(
        __doc__,
        measure,
        updates=Option(300, "updates of each program", 100),
        starts=Option(9, "starts of each kind", 5),
    )
