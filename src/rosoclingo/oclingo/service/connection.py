"""One client of the service: its socket, what it asked for and what it is still to be sent."""

import socket
from collections import deque
from typing import Deque, Iterator, Optional

from rosoclingo.oclingo.service.protocol import GREETING, Inbox, Message, Request, requests

QUEUE_LIMIT = 1000
"""Messages that wait for their turn; more are not read from the socket meanwhile."""

OUTBOX_LIMIT = 1 << 24
"""Bytes that wait to be sent; a client that does not read them is given no more turns meanwhile."""

_CHUNK = 1 << 16


class Client:
    """A connection; never blocks.

    Attributes:
        hung_up: the client sends nothing more. It may still read.

    """

    def __init__(self, connection: socket.socket) -> None:
        """Greet the client at the other end of ``connection``."""
        connection.setblocking(False)
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._connection = connection
        self.hung_up = False
        self._gone = self._leaving = False
        self._inbox = Inbox()
        self._messages: Deque[Message] = deque()
        self._requests = self._parse()
        self._next: Optional[Request] = None
        self._outbox = bytearray(GREETING)

    def fileno(self) -> int:
        """Return the file descriptor of the connection."""
        return self._connection.fileno()

    @property
    def reads(self) -> bool:
        """Whether more should be read from it."""
        return not self.hung_up and len(self._messages) < QUEUE_LIMIT and len(self._outbox) < OUTBOX_LIMIT

    @property
    def writes(self) -> bool:
        """Whether there is something to send to it."""
        return bool(self._outbox)

    @property
    def waits(self) -> bool:
        """Whether it has asked for something, and reads what it is sent."""
        return self._request is not None and len(self._outbox) < OUTBOX_LIMIT

    @property
    def done(self) -> bool:
        """Whether nothing is left to do for it."""
        return self.hung_up and not self.writes and self._request is None

    def take(self) -> Request:
        """Return what it asks for next; only while :attr:`waits`."""
        request, self._next = self._request, None
        assert request is not None
        return request

    def read(self) -> None:
        """Read what there is."""
        try:
            data = self._connection.recv(_CHUNK)
        except BlockingIOError:
            return
        except OSError:
            self._lose()
            return
        self.hung_up = not data
        if not self._leaving:
            self._messages.extend(self._inbox.feed(data))

    def send(self, data: bytes) -> None:
        """Send ``data`` as soon as the client takes it; to one that has gone, nothing is sent."""
        if not self._gone:
            self._outbox += data

    def write(self) -> None:
        """Send what the connection takes; end it behind the last data for a client that leaves."""
        try:
            del self._outbox[: self._connection.send(memoryview(self._outbox)[:OUTBOX_LIMIT])]
            if self._leaving and not self._outbox:
                self._connection.shutdown(socket.SHUT_WR)
        except BlockingIOError:
            return
        except OSError:
            self._lose()

    def leave(self) -> None:
        """Ignore what the client asks for, and tell it once all is sent that nothing more will come."""
        self._leaving, self._next = True, None
        self._messages.clear()
        self._requests = self._parse()
        self.write()

    def close(self) -> None:
        """Close the connection."""
        self._connection.close()

    @property
    def _request(self) -> Optional[Request]:
        """The next request, None if there is none yet."""
        if self._next is None:
            self._next = next(self._requests)
        return self._next

    def _parse(self) -> Iterator[Optional[Request]]:
        """Yield the requests, each parsed when its turn comes; None as long as there is none."""
        while True:
            while not self._messages:
                yield None
            yield from requests(self._messages.popleft())

    def _lose(self) -> None:
        """Note that the connection is broken; complete messages that have come are still done."""
        self._gone = self.hung_up = True
        self._outbox.clear()
