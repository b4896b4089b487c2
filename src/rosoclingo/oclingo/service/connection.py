"""One client of the service: its socket, pending requests and unsent data."""

import socket
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
        self._is_broken = self._is_leaving = False
        self._received = MessageBuffer()
        self._requests: Iterator[Request] = iter(())  # of the current message
        self._next: Optional[Request] = None
        self._unsent = bytearray(GREETING)

    def fileno(self) -> int:
        """Return the file descriptor of the connection."""
        return self._connection.fileno()

    @property
    def reads(self) -> bool:
        """Whether to read from the client."""
        return not self.hung_up and not self._received.is_full and len(self._unsent) < UNSENT_LIMIT

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
        request, self._next = self._request, None
        assert request is not None
        return request

    def read(self) -> None:
        """Read the available data."""
        try:
            data = self._connection.recv(_CHUNK)
        except BlockingIOError:
            return
        except OSError:
            self._break()
            return
        self.hung_up = not data
        if not self._is_leaving:
            self._received.add(data)

    def send(self, data: bytes) -> None:
        """Queue ``data`` for the client; drop it if the connection is broken."""
        if not self._is_broken:
            self._unsent += data

    def write(self) -> None:
        """Send as much as the socket accepts; after :meth:`leave`, shut down once everything is sent."""
        try:
            del self._unsent[: self._connection.send(memoryview(self._unsent)[:UNSENT_LIMIT])]
            if self._is_leaving and not self._unsent:
                self._connection.shutdown(socket.SHUT_WR)
        except BlockingIOError:
            return
        except OSError:
            self._break()

    def leave(self) -> None:
        """Drop the pending requests, and shut down once everything is sent."""
        self._is_leaving, self._next = True, None
        self._requests, self._received = iter(()), MessageBuffer()
        self.write()

    def close(self) -> None:
        """Close the connection."""
        self._connection.close()

    @property
    def _request(self) -> Optional[Request]:
        """The next request, parsed on demand; None if no message is complete."""
        while self._next is None:
            self._next = next(self._requests, None)
            if self._next is None:
                message = self._received.next_message()
                if message is None:
                    return None
                self._requests = requests(message)
        return self._next

    def _break(self) -> None:
        """Stop sending; the solver still processes the complete messages received so far."""
        self._is_broken = self.hung_up = True
        self._unsent.clear()
