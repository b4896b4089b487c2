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
        self.connection = connection
        self.hung_up = False
        self._gone = False
        self._inbox = Inbox()
        self._messages: Deque[Message] = deque()
        self._current: Iterator[Request] = iter(())
        self._next: Optional[Request] = None
        self._outbox = bytearray(GREETING)

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
        return self._peek() is not None and len(self._outbox) < OUTBOX_LIMIT

    @property
    def done(self) -> bool:
        """Whether nothing is left to do for it."""
        return self.hung_up and not self.writes and self._peek() is None

    def take(self) -> Request:
        """Return what it asks for next; only while :attr:`waits`."""
        request = self._peek()
        assert request is not None
        self._next = None
        return request

    def read(self) -> None:
        """Read what there is."""
        try:
            data = self.connection.recv(_CHUNK)
        except BlockingIOError:
            return
        except OSError:
            self._lose()
            return
        self.hung_up = not data
        self._messages.extend(self._inbox.feed(data))

    def send(self, data: bytes) -> None:
        """Send ``data`` as soon as the client takes it; to one that has gone, nothing is sent."""
        if not self._gone:
            self._outbox += data

    def write(self) -> None:
        """Send what the connection takes."""
        try:
            sent = self.connection.send(memoryview(self._outbox)[:OUTBOX_LIMIT])
        except BlockingIOError:
            return
        except OSError:
            self._lose()
            return
        del self._outbox[:sent]

    def discard(self) -> None:
        """Read what there is and forget it."""
        self.read()
        self._messages.clear()

    def end_output(self) -> None:
        """Tell the client that nothing more will come."""
        try:
            self.connection.shutdown(socket.SHUT_WR)
        except OSError:
            self._lose()

    def close(self) -> None:
        """Close the connection."""
        self.connection.close()

    def _peek(self) -> Optional[Request]:
        """Return the next request; messages are parsed when their turn comes."""
        while self._next is None:
            self._next = next(self._current, None)
            if self._next is None:
                if not self._messages:
                    return None
                self._current = requests(self._messages.popleft())
        return self._next

    def _lose(self) -> None:
        """Note that the connection is broken; complete messages that have come are still done."""
        self._gone = self.hung_up = True
        self._outbox.clear()
