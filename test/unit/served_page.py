"""A live page's server for tests, and its viewers."""

import asyncio
import json
import socket
import threading
from contextlib import contextmanager
from http.client import HTTPResponse
from pathlib import Path
from urllib.error import HTTPError
from urllib.request import HTTPRedirectHandler, Request, build_opener

from published_runs import delivery
from tornado.httpclient import HTTPRequest
from tornado.websocket import websocket_connect
from waiting import PATIENCE

from rosoclingo.nodes.pages.page_server import PageServer

WEB = Path(__file__).resolve().parents[2] / "web"


class Served:
    """A server of a view on a port of this machine."""

    def __init__(self, view, token="", port=0, take=None):
        self.view = view
        self.extra = {"core": True}
        self.connected = []
        listener = socket.socket()
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(("127.0.0.1", port))
        listener.listen()
        listener.setblocking(False)
        self.port = listener.getsockname()[1]
        self.server = PageServer(lambda: (self.view, self.extra), WEB, token, [listener], take)
        self.server.start()

    @property
    def address(self):
        return f"http://127.0.0.1:{self.port}"

    def do(self, job):
        """Change the view in the server's thread."""
        done = threading.Event()
        self.server.put(lambda: (job(self.view), done.set()))
        assert done.wait(PATIENCE)

    def viewers(self):
        return len(self.server.viewers)

    def get(self, path="/", **headers):
        """Return status, headers and body of an answer; redirections are not followed."""
        try:
            with build_opener(Stay).open(Request(self.address + path, headers=headers), timeout=PATIENCE) as answer:
                return answer.status, answer.headers, answer.read().decode()
        except HTTPError as error:
            return error.code, error.headers, error.read().decode()

    def shake_hands(self, **headers):
        """Return status and body of the answer to a WebSocket request with these headers; its bytes are Latin-1."""
        usual = {
            "Host": f"127.0.0.1:{self.port}",
            "Origin": self.address,
            "Upgrade": "websocket",
            "Connection": "Upgrade",
            "Sec-WebSocket-Key": "AAAAAAAAAAAAAAAAAAAAAA==",
            "Sec-WebSocket-Version": "13",
        }
        lines = ["GET /run HTTP/1.1", *(f"{name}: {value}" for name, value in {**usual, **headers}.items()), "", ""]
        with socket.create_connection(("127.0.0.1", self.port), PATIENCE) as one:
            one.sendall("\r\n".join(lines).encode("utf-8"))
            answer = HTTPResponse(one)
            answer.begin()
            return answer.status, b"" if answer.status == 101 else answer.read()

    def connect(self, origin=None, **headers):
        """Return a viewer; the headers are those of its request, which has by default the origin of this page."""
        headers["Origin"] = self.address if origin is None else origin
        given = {key: value for key, value in headers.items() if value}
        self.connected.append(Viewer(HTTPRequest(f"ws://127.0.0.1:{self.port}/run", headers=given)))
        return self.connected[-1]


class Viewer:
    """A viewer of the page; its methods run its connection. Raises HTTPClientError if the server refuses it."""

    loop = asyncio.new_event_loop()

    def __init__(self, request):
        self._client, self._has_ended = self._run(websocket_connect, request), False

    def _run(self, function, *arguments):
        async def run():
            return await asyncio.wait_for(function(*arguments), PATIENCE)

        return self.loop.run_until_complete(run())

    def send(self, text):
        """Send a text."""
        self._run(self._client.write_message, text)

    def receive(self):
        """Return the next message, None if the server has closed the connection."""
        text = None if self._has_ended else self._run(self._client.read_message)
        self._has_ended = text is None
        return text and json.loads(text)

    def answer(self):
        """Return the next answer, None if the connection is closed."""
        message = self.receive()
        while message is not None and "answer" not in message:
            message = self.receive()
        return message and message["answer"]

    def end(self):
        """Read up to the end of the connection; return its code."""
        while self.receive() is not None:
            pass
        return self._client.close_code

    def close(self):
        """Close the connection."""
        self._client.close()


class Stay(HTTPRedirectHandler):
    def redirect_request(self, *_arguments):
        return None


@contextmanager
def serving(view=None, token="", port=0, take=None):
    served = Served(view or delivery(), token, port, take)
    try:
        yield served
    finally:
        served.server.stop(PATIENCE)
        for viewer in served.connected:
            viewer.end()
