"""oClingo's TCP service: one reactive solver for any number of clients, in one loop without threads.

The solver polls for a stop every few milliseconds, and each poll also serves the sockets. Clients take turns, one
update each, and share the same stream.
"""

import select
import socket
import time
from contextlib import suppress
from typing import List, Optional, Union

from rosoclingo.oclingo.errors import ProgressionError, SolverError
from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.oclingo.service import protocol
from rosoclingo.oclingo.service.connection import ClientConnection
from rosoclingo.oclingo.solving.results import SolveOutcome
from rosoclingo.oclingo.solving.stream_solver import StreamSolver

GRACE = 0.5
"""Seconds after which a waiting update ends an unbounded search."""

GRACE_BOUNDED = 5.0
"""The same for a bounded search, which ends by itself but can take long."""

GRACE_ORPHANED = 10.0
"""Seconds after which a search for a disconnected client ends, if no update waits."""

CLIENT_LIMIT = 100
"""Maximal number of connections; further clients wait until a connection closes."""

_FAREWELL = 2.0  # seconds in which clients can read the remaining data before the last connections are closed


def listen(host: str, port: int) -> socket.socket:
    """Return a socket that listens at ``host`` and ``port`` (0: any free one); raises OSError."""
    found = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)
    found.sort(key=lambda one: one[0] != socket.AF_INET)  # prefer IPv4: oClingo's client supports nothing else
    return socket.create_server(found[0][4][:2], family=found[0][0], backlog=CLIENT_LIMIT)


class Service:
    """Serves clients until one of them sends ``#stop.``"""

    def __init__(self, solver: StreamSolver, listener: socket.socket, time_limit: Optional[float] = None) -> None:
        """Create a service.

        Args:
            solver: the solver that all clients share.
            listener: a listening socket; the service closes it.
            time_limit: seconds after which a search ends, None for no limit.

        """
        self._solver, self._listener, self._time_limit = solver, listener, time_limit
        self._clients: List[ClientConnection] = []
        self._stopped = False
        self._bounded = False
        self._served: Optional[ClientConnection] = None

    def run(self) -> None:
        """Serve until ``#stop.``, and close all connections, also after an error."""
        self._listener.setblocking(False)
        try:
            while not self._stopped:
                client = self._next_client()
                self._pump(None if client is None else 0)
                if client is not None:
                    self._serve(client)
            self._say_farewell()
        finally:
            for client in self._clients:
                client.close()
            self._listener.close()

    def _next_client(self) -> Optional[ClientConnection]:
        """Return the first client with a request and move it to the end of the queue, for fairness."""
        client = next((one for one in self._clients if one.waits), None)
        if client is not None:
            self._clients.remove(client)
            self._clients.append(client)
        return client

    def _pump(self, timeout: Optional[float]) -> None:
        """Read, write, accept clients and close finished connections; wait up to ``timeout`` seconds for an event."""
        for client in [one for one in self._clients if one.is_done and one is not self._served]:
            self._clients.remove(client)
            client.close()
        reading: List[Union[ClientConnection, socket.socket]] = [one for one in self._clients if one.reads]
        if not self._stopped and len(self._clients) < CLIENT_LIMIT:
            reading.append(self._listener)
        writing = [one for one in self._clients if one.writes]
        readable, writable, _ = select.select(reading, writing, [], timeout if reading or writing else 0)
        for one in readable:
            if isinstance(one, ClientConnection):
                one.read()
            else:
                with suppress(OSError):  # the client can have disconnected already
                    self._clients.append(ClientConnection(one.accept()[0]))
        for client in writable:
            client.write()

    def _serve(self, client: ClientConnection) -> None:
        """Answer the next request of ``client``."""
        request = client.take()
        if isinstance(request, ProgressionError):
            client.send(protocol.error(str(request)))
        elif request.stops:
            self._stopped = True
        else:
            client.send(protocol.INPUT)
            self._served = client
            self._solve(client, request)
            self._served = None

    def _solve(self, client: ClientConnection, update: StreamUpdate) -> None:
        bounded = self._bounded if update.step is None else update.bound is not None
        start, grace, reason = time.monotonic(), GRACE_BOUNDED if bounded else GRACE, ""

        def stopped() -> bool:
            """Serve the sockets, and return whether there is a reason to end the search."""
            nonlocal reason
            self._pump(0)
            elapsed = time.monotonic() - start
            if self._time_limit is not None and elapsed >= self._time_limit:
                reason = reason or f"the time limit of {self._time_limit:g} s was reached"
            elif elapsed >= grace and any(one.waits for one in self._clients):
                reason = reason or "another update waits"
            elif elapsed >= GRACE_ORPHANED and client.hung_up:
                reason = reason or "its client has hung up"
            return bool(reason)

        try:
            result = self._solver.update(update, stopped)
        except SolverError as error:
            client.send(protocol.error(f"{error} ({reason})" if reason else str(error)))
            return
        self._bounded = bounded
        if result.outcome is SolveOutcome.INTERRUPTED:
            text = f"The search for step {result.step} ended at horizon {result.horizon} without an answer: "
            client.send(protocol.warning(f"{text}{reason or 'it was interrupted'}. The update stays in force."))
        for data in protocol.reply(result):
            client.send(data)

    def _say_farewell(self) -> None:
        """Send the remaining data and wait until clients disconnect: closing at once could lose data."""
        self._listener.close()
        for client in self._clients:
            client.leave()
        deadline = time.monotonic() + _FAREWELL
        while self._clients and time.monotonic() < deadline:
            self._pump(0.1)
