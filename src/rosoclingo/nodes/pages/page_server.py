"""The live page's server, in its own thread: the page, and a WebSocket that sends the changes of a run."""

import asyncio
import json
import logging
import socket
import threading
import time
from collections import deque
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any, Callable, Deque, Dict, Optional, Sequence, Set

from tornado.httpserver import HTTPServer
from tornado.ioloop import IOLoop, PeriodicCallback
from tornado.web import Application, HTTPError, RequestHandler
from tornado.websocket import WebSocketClosedError, WebSocketHandler

from rosoclingo.nodes.pages.access import Access
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

#: What the page can connect to on a host, and who can show it, besides the policy of the page itself.
POLICY = "connect-src 'self' ws://{host} wss://{host}; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"

#: Types of the number of a message, which its answer repeats.
_NUMBERS = (int, type(None))


class PageServer:
    """Serves the view of a run; all callbacks run in the server's thread, ``put`` and ``stop`` work from any thread.

    ``look`` is called before each check for changes and returns further data for the page; ``view`` returns the view,
    which can be replaced. ``sockets`` already listen. ``take`` answers requests of viewers, or returns a function that
    waits for the answer in a thread of its own.
    """

    def __init__(
        self,
        view: Callable[[], RunView],
        look: Callable[[], Dict[str, Any]],
        web: Path,
        access: Access,
        sockets: Sequence[socket.socket],
        take: Callable[[Dict[str, Any]], Taken],
    ) -> None:
        logging.getLogger("tornado.access").setLevel(logging.ERROR)
        self.access = access
        self.viewers: Set[_Viewer] = set()
        self._view, self._look, self._web, self.take = view, look, web, take
        self.page, policy = live_page(web)
        self.policy = f"{policy}; {POLICY}"
        self._sockets = list(sockets)
        self._loop: Optional[IOLoop] = None
        self._ready = threading.Event()
        self._thread = threading.Thread(target=self._serve, name="pages", daemon=True)

    def start(self) -> None:
        """Start to serve."""
        self._thread.start()
        self._ready.wait()

    def put(self, job: Callable[[], object]) -> None:
        """Queue a job for the server's thread, from any thread."""
        if self._loop is not None:
            self._loop.add_callback(job)

    def wait_for(self, job: Callable[[], Answer], then: Callable[[Answer], object]) -> None:
        """Call a function in a thread of its own, and then another one with its result in the server's thread."""
        threading.Thread(target=lambda: self.put(partial(then, job())), name="waiting", daemon=True).start()

    def report(self) -> str:
        """Return the run so far as a report."""
        return report_page(self._view().changes(), self._web)

    def stop(self, timeout: float = 2.0) -> None:
        """Stop the server, and wait for its thread."""
        self.put(lambda: self._loop.stop() if self._loop is not None else None)
        self._thread.join(timeout)

    def _serve(self) -> None:
        asyncio.set_event_loop(asyncio.new_event_loop())
        self._loop = IOLoop.current()
        server = HTTPServer(
            self._application(), max_header_size=16384, max_body_size=MOST_BYTES, idle_connection_timeout=60
        )
        server.add_sockets(self._sockets)
        ticks = PeriodicCallback(self._tick, 1000 * PERIOD)
        ticks.start()
        self._loop.add_callback(self._ready.set)
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

    def _application(self) -> Application:
        handlers = {"/": _Page, "/report.html": _Report, "/run": _Viewer}
        return Application(
            [(path, handler, {"server": self}) for path, handler in handlers.items()],
            websocket_max_message_size=MOST_BYTES,
            websocket_ping_interval=SILENCE,
            default_handler_class=_Nothing,
        )

    def _tick(self) -> None:
        """Send each viewer its changes; skip viewers that have not received the previous message yet."""
        extra = self._look()  # first, as it can replace the view
        view = self._view()
        for viewer in self.viewers:
            viewer.send_news(view, extra)


def _check(handler: RequestHandler, server: PageServer) -> None:
    """Raise HTTPError for a request without access."""
    host = handler.request.host
    if not server.access.accepts_host(host):
        raise HTTPError(403, reason="Wrong host name")
    if not server.access.is_proof(handler.get_cookie(COOKIE, "") or ""):
        raise HTTPError(403, reason="Token needed: open the address in the node's log")


class _PlainErrors(RequestHandler):
    """Answers with errors in plain text."""

    def write_error(self, status_code: int, **_more: Any) -> None:
        """Answer with an error."""
        self.set_header("Content-Type", "text/plain; charset=utf-8")
        self.finish(f"{status_code} {self._reason}\n")


class _Nothing(_PlainErrors):
    """A path that does not exist."""

    def prepare(self) -> None:
        """Answer that the path does not exist."""
        raise HTTPError(404)


class _Page(_PlainErrors):
    """The live page. A token in its address becomes a cookie."""

    def initialize(self, server: PageServer) -> None:
        """Set the server."""
        self._server = server

    def prepare(self) -> None:
        """Set the headers."""
        self.set_header("Content-Security-Policy", self._server.policy.format(host=_plain(self.request.host)))
        self.set_header("Content-Type", "text/html; charset=utf-8")
        self.set_header("X-Content-Type-Options", "nosniff")
        self.set_header("X-Frame-Options", "DENY")
        self.set_header("Referrer-Policy", "no-referrer")
        self.set_header("Cache-Control", "no-store")

    def get(self) -> None:
        """Answer with the page."""
        try:
            token = self.get_query_argument("token", None)
        except HTTPError:
            raise HTTPError(400, reason="The token is not UTF-8") from None
        if token is not None and self._server.access.is_token(token):
            self.set_cookie(COOKIE, self._server.access.proof, httponly=True, samesite="Lax")
            self.redirect("/")
            return
        _check(self, self._server)
        self.finish(self._server.page)


class _Report(_Page):
    """The report of the run so far, as a file to save."""

    def get(self) -> None:
        """Answer with the report."""
        _check(self, self._server)
        self.set_header("Content-Disposition", 'attachment; filename="run.html"')
        self.finish(self._server.report())


class _Viewer(_PlainErrors, WebSocketHandler):
    """The connection of a viewer."""

    def initialize(self, server: PageServer) -> None:
        """Set the server."""
        self._server = server
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
        _check(self, self._server)
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
        found = _read(message)
        if found is None:
            self.close(1008, "a message has to be a JSON object")
            return
        number = found.get("number")
        if type(number) not in _NUMBERS:
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


def _read(message: Any) -> Optional[Dict[str, Any]]:
    """Return the JSON object of a viewer's message, None for an invalid message."""
    try:
        found = json.loads(message)
    except (ValueError, RecursionError):
        return None
    return found if isinstance(found, dict) else None


def _plain(host: str) -> str:
    """Return a host without characters that are special in a policy."""
    return "".join(letter for letter in host if letter.isalnum() or letter in ".-:[]")
