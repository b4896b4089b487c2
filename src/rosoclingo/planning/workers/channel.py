"""Pickled messages between a worker and its parent, over a socket."""

import copyreg
import pickle
import select
import socket
import struct
import time
from collections import deque
from contextlib import suppress
from typing import Any, Deque, Optional

import clingo

copyreg.pickle(clingo.Symbol, lambda symbol: (clingo.parse_term, (str(symbol),)))

_CHUNK = 1 << 18
_SIZE = struct.Struct("!Q")

CONNECTION = 3
"""File descriptor of the connection in a new worker process."""


class Channel:
    """One end of a connection.

    Sending never blocks, because a worker does not read while it grounds. Later calls send the data that the socket did
    not accept.

    Attributes:
        unread: received messages, oldest first.

    """

    def __init__(self, connection: socket.socket) -> None:
        """Use ``connection``, which :meth:`close` closes."""
        self._socket = connection
        self._socket.setblocking(False)
        self._unsent, self._received = bytearray(), bytearray()
        self._ended = False
        self.unread: Deque[Any] = deque()

    def send(self, message: object) -> None:
        """Send ``message``; a closed connection is reported by :meth:`wait`."""
        data = pickle.dumps(message)
        self._unsent += _SIZE.pack(len(data)) + data
        self._flush()

    def wait(self, timeout: Optional[float] = None) -> bool:
        """Wait at most ``timeout`` seconds of wall time for a message; return whether one is unread.

        Raises EOFError if the other end is closed and all messages have been read.
        """
        end = None if timeout is None else time.monotonic() + timeout
        poll = select.poll()
        while True:
            self._flush()
            self._read()
            if self.unread:
                return True
            if self._ended:
                raise EOFError
            left = None if end is None else end - time.monotonic()
            if left is not None and left <= 0.0:
                return False
            poll.register(self._socket, select.POLLIN | (select.POLLOUT if self._unsent else 0))
            poll.poll(None if left is None else 1000 * left)

    def close(self) -> None:
        """Close the connection."""
        self._socket.close()

    def _flush(self) -> None:
        with suppress(OSError):  # full, or closed by the other end
            while self._unsent:
                del self._unsent[: self._socket.send(self._unsent[:_CHUNK])]

    def _read(self) -> None:
        while not self._ended:
            try:
                data = self._socket.recv(_CHUNK)
            except BlockingIOError:
                break
            except OSError:  # closed by the other end with unread data
                data = b""
            self._ended = not data
            self._received += data
        while len(self._received) >= _SIZE.size:
            end = _SIZE.size + _SIZE.unpack_from(self._received)[0]
            if len(self._received) < end:
                break
            self.unread.append(pickle.loads(self._received[_SIZE.size : end]))
            del self._received[:end]
