"""The live page's server, in its own thread: the page, and a WebSocket that sends the changes of a run."""

import asyncio
import hashlib
import hmac
import json
import logging
import re
import socket
import threading
import time
from collections import deque
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any, Callable, Deque, Dict, Optional, Sequence, Set, Tuple

from tornado.httpserver import HTTPServer
from tornado.ioloop import PeriodicCallback
from tornado.platform.asyncio import AsyncIOLoop
from tornado.web import Application, HTTPError, RequestHandler
from tornado.websocket import WebSocketClosedError, WebSocketHandler

from rosoclingo.nodes.pages.order_desk import Answer, Taken
from rosoclingo.runs.report_page import live_page, report_page
from rosoclingo.runs.run_view import RunView

#: Seconds between two checks for changes.
PERIOD = 0.2

#: Limits of simultaneous viewers, and of bytes of a viewer's message.
MOST_VIEWERS, MOST_BYTES = 50, 4096

#: Limit of messages of a viewer within WINDOW seconds.
MOST_MESSAGES, WINDOW = 20, 10.0

#: Seconds without a response after which a viewer is disconnected.
SILENCE = 30

COOKIE = "rosoclingo"

#: Host names of this machine, and a ``Host`` header.
LOCAL = frozenset({"127.0.0.1", "localhost", "::1"})
_HOST = re.compile(r"(\[[0-9a-f:.]+\]|[\w.-]+)(:\d{1,5})?\Z", re.ASCII | re.IGNORECASE)

#: The headers of a page, and what it can connect to on a host, besides the policy of the page itself.
HEADERS = {
    "Content-Type": "text/html; charset=utf-8",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cache-Control": "no-store",
}
POLICY = "connect-src 'self' ws://{host} wss://{host}; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"


class PageServer:
    """Serves the view of a run; all callbacks run in the server's thread, ``put`` and ``stop`` work from any thread.

    ``look`` returns the view, which can be replaced, and further data for the page; it is called before each check for
    changes. ``sockets`` already listen. ``take`` answers requests of viewers, or returns a function that
    waits for the answer in a thread of its own.

    Viewers need the ``token``. It is empty for a page on this machine only. Then the page accepts only this machine's
    host names, so that no page of another site can reach it through its own host name.
    """

    def __init__(
        self,
        look: Callable[[], Tuple[RunView, Dict[str, Any]]],
        web: Path,
        token: str,
        sockets: Sequence[socket.socket],
        take: Callable[[Dict[str, Any]], Taken],
    ) -> None:
        logging.getLogger("tornado.access").setLevel(logging.ERROR)
        self.proof = _proof(token) if token else ""  # a browser stores it in place of the token
        self.viewers: Set[_Viewer] = set()
        self._look, self._web, self.take = look, web, take
        self.page, policy = live_page(web)
        self.policy = f"{policy}; {POLICY}"
        self._sockets = list(sockets)
        self._loop = AsyncIOLoop(make_current=False)
        self._thread = threading.Thread(target=self._serve, name="pages", daemon=True)

    def start(self) -> None:
        """Start to serve."""
        self._thread.start()

    def put(self, job: Callable[[], object]) -> None:
        """Queue a job for the server's thread, from any thread."""
        self._loop.add_callback(job)

    def wait_for(self, job: Callable[[], Answer], then: Callable[[Answer], object]) -> None:
        """Call a function in a thread of its own, and then another one with its result in the server's thread."""
        threading.Thread(target=lambda: self.put(partial(then, job())), name="waiting", daemon=True).start()

    def report(self) -> str:
        """Return the run so far as a report."""
        return report_page(self._look()[0].changes(), self._web)

    def stop(self, timeout: float = 2.0) -> None:
        """Stop the server, and wait for its thread."""
        self.put(self._loop.stop)
        self._thread.join(timeout)

    def _serve(self) -> None:
        asyncio.set_event_loop(self._loop.asyncio_loop)
        application = Application(
            [
                (path, kind, {"server": self})
                for path, kind in (("/", _Page), ("/report.html", _Report), ("/run", _Viewer))
            ],
            websocket_max_message_size=MOST_BYTES,
            websocket_ping_interval=SILENCE,
        )
        server = HTTPServer(application, max_header_size=16384, max_body_size=MOST_BYTES, idle_connection_timeout=60)
        server.add_sockets(self._sockets)
        ticks = PeriodicCallback(self._tick, 1000 * PERIOD)
        ticks.start()
        self._loop.start()
        ticks.stop()
        server.stop()
        self._loop.run_sync(self._disconnect)
        self._loop.close(all_fds=True)

    async def _disconnect(self) -> None:
        """Disconnect the viewers, and cancel tasks that wait for a browser."""
        for viewer in list(self.viewers):
            viewer.close(1001, "the page's server shuts down")
        await asyncio.sleep(0)  # sends the messages above
        waiting = asyncio.all_tasks() - {asyncio.current_task()}
        for task in waiting:
            task.cancel()
        await asyncio.gather(*waiting, return_exceptions=True)

    def _tick(self) -> None:
        """Send each viewer its changes; skip viewers that have not received the previous message yet."""
        view, extra = self._look()
        for viewer in self.viewers:
            viewer.send_news(view, extra)


class _Handler(RequestHandler):
    """Handles requests for this host, with errors in plain text."""

    def initialize(self, server: PageServer) -> None:
        """Set the server."""
        self._server = server

    def prepare(self) -> None:
        """Refuse other host names."""
        host = _HOST.match(self.request.host)
        if host is None or not (self._server.proof or host.group(1).strip("[]").lower() in LOCAL):
            raise HTTPError(403, reason="Wrong host name")

    def check_token(self) -> None:
        """Refuse requests of browsers that have not opened the page with the token."""
        if self._server.proof and not _equal(self.get_cookie(COOKIE, "") or "", self._server.proof):
            raise HTTPError(403, reason="Token needed: open the address in the node's log")

    def write_error(self, status_code: int, **_more: Any) -> None:
        """Answer with an error."""
        self.set_header("Content-Type", "text/plain; charset=utf-8")
        self.finish(f"{status_code} {self._reason}\n")


class _Page(_Handler):
    """The live page. A token in its address becomes a cookie."""

    def prepare(self) -> None:
        """Set the headers."""
        super().prepare()
        self.set_header("Content-Security-Policy", self._server.policy.format(host=self.request.host))
        for name, value in HEADERS.items():
            self.set_header(name, value)

    def get(self) -> None:
        """Answer with the page."""
        try:
            token = self.get_query_argument("token", None)
        except HTTPError:
            raise HTTPError(400, reason="The token is not UTF-8") from None
        if token is not None and _equal(_proof(token), self._server.proof):
            self.set_cookie(COOKIE, self._server.proof, httponly=True, samesite="Lax")
            self.redirect("/")
            return
        self.check_token()
        self.finish(self._server.page)


class _Report(_Page):
    """The report of the run so far, as a file to save."""

    def get(self) -> None:
        """Answer with the report."""
        self.check_token()
        self.set_header("Content-Disposition", 'attachment; filename="run.html"')
        self.finish(self._server.report())


class _Viewer(_Handler, WebSocketHandler):
    """The connection of a viewer."""

    def initialize(self, server: PageServer) -> None:
        """Set the server."""
        super().initialize(server)
        self._busy = False
        self._received: Deque[float] = deque(maxlen=MOST_MESSAGES)  # times of messages
        self._view: Optional[RunView] = None  # the view that the viewer has
        self._known = -1  # its revision there
        self._sent: Dict[str, Any] = {}  # the further data that the viewer has

    def check_origin(self, origin: str) -> bool:
        """Return whether the request comes from a page of this server."""
        with suppress(ValueError):  # not a URL
            return super().check_origin(origin)
        return False

    def prepare(self) -> None:
        """Refuse requests without access, and viewers above the limit."""
        super().prepare()
        self.check_token()
        if "Origin" not in self.request.headers:
            raise HTTPError(403, reason="Not a page of this server")
        if len(self._server.viewers) >= MOST_VIEWERS:
            raise HTTPError(503, reason="Too many viewers")

    def open(self, *_arguments: str, **_more: str) -> None:
        """Add the viewer."""
        self._server.viewers.add(self)

    def on_message(self, message: Any) -> None:
        """Answer a viewer's request; disconnect a viewer that sends no JSON object, or too many messages."""
        now = time.monotonic()
        too_often = len(self._received) == MOST_MESSAGES and now - self._received[0] < WINDOW
        self._received.append(now)
        if too_often:
            self.close(1008, f"at most {MOST_MESSAGES} messages in {WINDOW:g} s")
            return
        found = None
        with suppress(ValueError, RecursionError):
            found = json.loads(message)
        if not isinstance(found, dict):
            self.close(1008, "a message has to be a JSON object")
            return
        number = found.get("number")
        if type(number) not in (int, type(None)):
            self._answer(None, {"fault": "'number' is not an integer"})
            return
        taken = self._server.take(found)
        if isinstance(taken, dict):
            self._answer(number, taken)
        else:
            self._server.wait_for(taken, partial(self._answer, number))

    def _answer(self, number: Optional[int], answer: Answer) -> None:
        text = json.dumps({"answer": {**answer, "number": number}})
        self._server.put(lambda: self._say(text))

    def on_close(self) -> None:
        """Remove the viewer."""
        self._server.viewers.discard(self)

    def send_news(self, view: RunView, extra: Dict[str, Any]) -> None:
        """Send the changes since the last message, also of ``extra``; another view is sent as a whole."""
        if view is not self._view:
            self._view, self._known, self._sent = view, -1, {}
        seconds = {**extra, "seconds": int(view.seconds)}
        if self._busy or (self._known == view.revision and self._sent == seconds):
            return
        fresh = {name: value for name, value in extra.items() if name not in self._sent or self._sent[name] != value}
        changes = {**view.changes(max(0, self._known)), **fresh, "whole": self._known < 0}
        text = json.dumps(changes, separators=(",", ":"))
        self._known, self._sent, self._busy = view.revision, seconds, True
        self._server.put(lambda: self._write(text))

    async def _write(self, text: str) -> None:
        await self._say(text)
        self._busy = False

    async def _say(self, text: str) -> None:
        try:
            await self.write_message(text)
        except WebSocketClosedError:
            self._server.viewers.discard(self)


def _proof(token: str) -> str:
    return hashlib.sha256(token.encode("utf-8")).hexdigest()


def _equal(one: str, other: str) -> bool:
    """Compare two proofs in a time that does not depend on them."""
    return hmac.compare_digest(one.encode("utf-8"), other.encode("utf-8"))
