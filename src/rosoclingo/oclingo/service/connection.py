"""One client of the service: its socket, pending requests and unsent data."""

import socket
from itertools import chain
from typing import Iterator, Optional

from rosoclingo.oclingo.service.protocol import GREETING, MessageBuffer, Request, requests

UNSENT_LIMIT = 1 << 24
"""Limit of unsent bytes; a client that reaches it is not served until it reads them."""

_CHUNK = 1 << 16


class ClientConnection:
    """A connection to a client; it never blocks.

    Attributes:
        hung_up: the client has stopped sending; it can still read.

    """

    def __init__(self, connection: socket.socket) -> None:
        """Greet the client at the other end of ``connection``."""
        connection.setblocking(False)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._connection = connection
        self.hung_up = False
        self._is_leaving = False
        self._received = MessageBuffer()
        self._request: Optional[Request] = None  # the next one
        self._requests: Iterator[Request] = iter(())  # those after it
        self._unsent = bytearray(GREETING)

    def fileno(self) -> int:
        """Return the file descriptor of the connection, for ``select``."""
        return self._connection.fileno()

    @property
    def reads(self) -> bool:
        """Whether to read from the client: no request is pending, and the client reads its answers."""
        return not self.hung_up and self._request is None and len(self._unsent) < UNSENT_LIMIT

    @property
    def writes(self) -> bool:
        """Whether there is unsent data."""
        return bool(self._unsent)

    @property
    def waits(self) -> bool:
        """Whether a request is pending and the client reads its answers."""
        return self._request is not None and len(self._unsent) < UNSENT_LIMIT

    @property
    def is_done(self) -> bool:
        """Whether the connection can be closed."""
        return self.hung_up and not self.writes and self._request is None

    def take(self) -> Request:
        """Return the next request; requires :attr:`waits`."""
        request, self._request = self._request, next(self._requests, None)
        assert request is not None
        return request

    def read(self) -> None:
        """Read the available data; requires :attr:`reads`."""
        try:
            data = self._connection.recv(_CHUNK)
        except BlockingIOError:
            return
        except OSError:
            self._break()
            return
        self.hung_up = not data
        if not self._is_leaving:
            self._requests = chain.from_iterable(map(requests, self._received.add(data)))
            self._request = next(self._requests, None)

    def send(self, data: bytes) -> None:
        """Queue ``data`` for the client."""
        self._unsent += data

    def write(self) -> None:
        """Send as much as the socket accepts; after :meth:`leave`, shut down once everything is sent."""
        try:
            del self._unsent[: self._connection.send(self._unsent)]
            if self._is_leaving and not self._unsent:
                self._connection.shutdown(socket.SHUT_WR)
        except BlockingIOError:
            return
        except OSError:
            self._break()

    def leave(self) -> None:
        """Drop the pending requests, and shut down once everything is sent."""
        self._is_leaving, self._request, self._requests = True, None, iter(())
        self.write()

    def close(self) -> None:
        """Close the connection."""
        self._connection.close()

    def _break(self) -> None:
        """Stop sending; the solver still processes the complete messages received so far."""
        self.hung_up = True
        self._unsent.clear()
