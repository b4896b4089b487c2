#!/usr/bin/env python3
"""Compares updates through the TCP service with the same updates in the library, and measures starts of the command.

Service and library take turns, update by update, so that other load on the machine affects both; compare the ratios. A
start is the processor time of all processes of the command until it has answered one update and ended. Needs no ROS:

    ./dev exec python3 bench/service.py
"""

import argparse
import resource
import socket
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from figures import Figure, parse, write

from rosoclingo.oclingo import ReactiveProgram, ReactiveSolver, parse_update

SMALL = "#cumulative t.\n#external e(t).\nc(t) :- e(t).\n#volatile t.\n:- t < 0.\n"
#: A program whose answers have about three hundred atoms.
WIDE = "#base.\nroom(1..300).\n#cumulative t.\n#external e(t).\nat(X,t) :- e(t), room(X).\n#volatile t.\n:- t < 0.\n"
#: A program in the language of gringo 3, which has to be translated.
OLD = "#base.\nroom(1..3).\n#cumulative t.\n#external e(X,t) : room(X) : X != 2.\n#volatile t.\n:- t < 0.\n"
SCRIPT = str(Path(__file__).parents[1] / "scripts" / "oclingo")


class Client:
    """A minimal client of oClingo's protocol."""

    def __init__(self, port):
        self.connection = socket.create_connection(("127.0.0.1", port))
        self.connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.data = b""
        self.reply()

    def reply(self):
        """Read the answers to an update."""
        while b"End of Step.\n\0" not in self.data:
            self.data += self.connection.recv(1 << 16)
        self.data = self.data.split(b"End of Step.\n\0", 1)[1]

    def update(self, text):
        self.connection.sendall(text.encode() + b"\0")
        self.reply()


def measure(program, count):
    """Return the milliseconds of each update in the library and through the service."""
    with tempfile.NamedTemporaryFile("w", suffix=".lp") as file:
        file.write(program)
        file.flush()
        command = [sys.executable, SCRIPT, file.name, "--port", "0"]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as service:
            try:
                client = Client(int(service.stdout.readline().rsplit(":", 1)[1]))
                return compare(ReactiveSolver(ReactiveProgram.from_text(program)), client, count)
            finally:
                service.terminate()


def compare(solver, client, count):
    library, service = [], []
    for number in range(count):
        text = f"#step {1 + number // 10}. #volatile. e({1 + number // 10}). #endstep."
        start = time.perf_counter()
        solver.update(parse_update(text))
        middle = time.perf_counter()
        client.update(text)
        library.append(1000 * (middle - start))
        service.append(1000 * (time.perf_counter() - middle))
    return library, service


def processor_time():
    """Return the processor time (s) of all child processes that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def stream_start(program):
    """Return the processor time (ms) to play a stream of one update."""
    with tempfile.TemporaryDirectory() as folder:
        file, stream = Path(folder, "program.lp"), Path(folder, "updates.str")
        file.write_text(program)
        stream.write_text("#step 1. #endstep.\n")
        before = processor_time()
        command = [sys.executable, SCRIPT, str(file), "--stream", str(stream)]
        subprocess.run(command, stdout=subprocess.DEVNULL, check=True)
        return 1000 * (processor_time() - before)


def service_start(program):
    """Return the processor time (ms) to serve one update."""
    before = processor_time()
    measure(program, 1)
    return 1000 * (processor_time() - before)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--updates", type=int, default=300, help="updates of each program (default: %(default)s)")
    parser.add_argument("--starts", type=int, default=9, help="starts of each kind (default: %(default)s)")
    options = parse(parser, updates=100, starts=5)
    found = []
    print(f"{'answers':<12} {'library':>11} {'service':>11} {'more':>10} {'ratio':>7}   median of {options.updates}")
    for name, program in (("3 atoms", SMALL), ("300 atoms", WIDE)):
        library, service = measure(program, options.updates)
        more = statistics.median(theirs - ours for ours, theirs in zip(library, service))
        here, there = statistics.median(library), statistics.median(service)
        print(f"{name:<12} {here:8.2f} ms {there:8.2f} ms {more:7.2f} ms {there / here:7.2f}")
        found += [Figure(f"{name}, library", here, "ms"), Figure(f"{name}, service", there, "ms")]
        found.append(Figure(f"{name}, service over library", there / here, ""))
    for name, start in (("stream", stream_start), ("service", service_start)):
        for language, program in (("clingo's", SMALL), ("gringo 3's", OLD)):
            median = statistics.median(start(program) for _ in range(options.starts))
            print(f"{name}, a program in {language} language: {median:.0f} ms of processor time for one answer")
            found.append(Figure(f"{name} starts, {language} language", median, "ms"))
    write(options.json, found)


if __name__ == "__main__":
    main()
