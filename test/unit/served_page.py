"""A live page's server for tests, and its viewers."""

import asyncio
import json
import socket
import threading
import time
from contextlib import contextmanager
from http.client import HTTPResponse
from pathlib import Path
from urllib.error import HTTPError
from urllib.request import HTTPRedirectHandler, Request, build_opener

from published_runs import delivery
from tornado.httpclient import HTTPRequest
from tornado.websocket import websocket_connect

from rosoclingo.nodes.pages.access import Access
from rosoclingo.nodes.pages.page_server import PageServer

WEB = Path(__file__).resolve().parents[2] / "web"
PATIENCE = 300.0


class Served:
    """A server of a view on a port of this machine."""

    def __init__(self, view, token="", port=0, take=None):
        self.view = view
        self.extra = {"core": True}
        listener = socket.socket()
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(("127.0.0.1", port))
        listener.listen()
        listener.setblocking(False)
        self.port = listener.getsockname()[1]
        self.server = PageServer(lambda: self.view, lambda: self.extra, WEB, Access(token), [listener], take)
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

    async def connect(self, origin=None, **headers):
        headers["Origin"] = self.address if origin is None else origin
        request = HTTPRequest(
            f"ws://127.0.0.1:{self.port}/run", headers={key: value for key, value in headers.items() if value}
        )
        return await asyncio.wait_for(websocket_connect(request), PATIENCE)


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


def play(scene):
    """Run a scene of clients."""
    return asyncio.new_event_loop().run_until_complete(asyncio.wait_for(scene, 3 * PATIENCE))


async def next_message(client):
    """Return the next message, None if the server has closed the connection."""
    text = await asyncio.wait_for(client.read_message(), PATIENCE)
    return None if text is None else json.loads(text)


def wait_until(condition):
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.02)


async def answered(client):
    """Return the next answer, None if the connection is closed."""
    while True:
        found = await next_message(client)
        if found is None or "answer" in found:
            return found and found["answer"]
