"""A service in a thread, and a client that parses replies as the client shipped with oClingo does."""

import contextlib
import re
import socket
import threading

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.oclingo.service.server import Service, listen
from rosoclingo.planning.workers.pool import WorkerPool
from rosoclingo.planning.workers.process_solver import ProcessSolver

TIMEOUT = 120.0  # seconds to wait for expected events; no test measures time

PATTERNS = {  # the lines that oClingo's client accepts
    "step": re.compile(r"^Step:\ (\d+)$"),
    "atoms": re.compile(r"^(-?[a-z_][a-zA-Z0-9_]*(\(.+\))?\ *)+$"),
    "input": re.compile(r"^Input:$"),
    "end": re.compile(r"^End of Step.$"),
    "warning": re.compile(r"^Warning: (.+)$"),
    "error": re.compile(r"^Error: (.+)$"),
    "unsat": re.compile(r"^UNSAT at step (\d+)$"),
}


class Reply:
    """The reply to one update."""

    def __init__(self):
        self.answers, self.warnings, self.horizons = [], [], []
        self.end, self.text = "", ""

    @property
    def sets(self):
        return sorted(sorted(set(answer)) for answer in self.answers)


class Client:
    """Sends bytes and reads items; each line must be acceptable to oClingo's client."""

    def __init__(self, port, greeted=True):
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=TIMEOUT)
        self.buffer = b""
        if greeted:
            assert self.reply().end == "end"

    def send(self, *texts):
        self.socket.sendall(b"".join(text.encode() + b"\0" for text in texts))

    def ask(self, text):
        self.send(text)
        return self.reply()

    def item(self):
        """Return the next item, None if the connection is closed."""
        while b"\0" not in self.buffer:
            data = self.socket.recv(8192)
            if not data:
                assert not self.buffer
                return None
            self.buffer += data
        item, self.buffer = self.buffer.split(b"\0", 1)
        return item.decode()

    def reply(self):
        """Read and return the reply to one update."""
        reply = Reply()
        while not reply.end:
            self._read_lines(reply)
        return reply

    def _read_lines(self, reply):
        for line in (self.item() or "").splitlines():
            kind, found = next((kind, found) for kind, found in self._matches(line) if found)
            if kind == "step":
                reply.horizons.append(int(found.group(1)))
                reply.answers.append([])
            elif kind == "atoms":
                reply.answers[-1] = line.split()
            elif kind == "warning":
                assert not reply.answers, "oClingo's client discards the answers before a warning"
                reply.warnings.append(found.group(1))
            elif kind != "input":
                reply.end = kind
                reply.text = found.group(1) if found.groups() else ""

    @staticmethod
    def _matches(line):
        return [(kind, pattern.match(line)) for kind, pattern in PATTERNS.items()]

    def close(self):
        self.socket.close()


class Running:
    """A service that runs in a thread."""

    def __init__(self, process, **options):
        self.process = process
        listener = listen("127.0.0.1", 0)
        self.port = listener.getsockname()[1]
        self.service = Service(ProcessSolver(process), listener, **options)
        self._clients = []
        self._thread = threading.Thread(target=self.service.run, daemon=True)
        self._thread.start()

    def client(self, greeted=True):
        self._clients.append(Client(self.port, greeted))
        return self._clients[-1]

    def join(self):
        """Wait for the end of the service."""
        self._thread.join(TIMEOUT)
        assert not self._thread.is_alive()

    def close(self):
        if self._thread.is_alive():
            last = Client(self.port, greeted=False)
            last.send("#stop.")
            last.close()
        for client in self._clients:
            client.close()
        self.join()


@contextlib.contextmanager
def running(text, models=0, **options):
    """Serve the program ``text`` by a solver process."""
    with WorkerPool(ReactiveProgram.from_text(text), models=models) as process:
        process.start()
        service = Running(process, **options)
        try:
            yield service
        finally:
            service.close()
