"""Requests from pages: orders, which only the same page can cancel, facts, commands and questions."""

import hmac
import threading
from typing import Any, Callable, Dict, Mapping, Sequence, Union

from rosoclingo.runs.orders import OrderError, OrderForm
from rosoclingo.runs.run_view import RunView

#: Limits of open goals of pages, and of characters of a key.
MOST_OPEN, LONGEST_KEY = 50, 100

#: Limits of explanations and of commands that wait for the core.
MOST_ASKED, MOST_COMMANDS = 2, 4

Answer = Dict[str, Any]

#: An answer, or a function that waits for it, for another thread.
Taken = Union[Answer, Callable[[], Answer]]


class OrderDesk:
    """Processes the requests of pages, by ``core``, a :class:`CoreConnection`.

    Each order has a ``key`` that only its browser knows; the cancellation needs the same key. A desk without ``forms``
    accepts no commands either.
    """

    def __init__(self, forms: Sequence[OrderForm], core: Any) -> None:
        self._forms, self._core = forms, core
        self._keys: Dict[str, str] = {}  # of open goals, by the goal's id
        self._asked = threading.BoundedSemaphore(MOST_ASKED)
        self._commands = threading.BoundedSemaphore(MOST_COMMANDS)

    def describe(self, view: RunView) -> Sequence[Dict[str, Any]]:
        """Return the forms for a page; call this often, as it also forgets the orders that have ended."""
        self._forget_ended(view)
        return [form.describe(*_world(view), view.sentences.titles) for form in self._forms]

    def take(self, message: Mapping[str, Any], view: RunView) -> Taken:
        """Process a request of a page.

        The answer has ``ordered`` (a goal's id), ``reported`` (a fact), ``canceled``, ``done`` (of a command), ``why``
        (lines) or ``fault``.
        """
        key = message.get("key")
        try:
            if not isinstance(key, str) or not 8 <= len(key) <= LONGEST_KEY:
                raise OrderError("the page sent no key")
            if "order" in message:
                return self._order(message, key, view)
            if "cancel" in message:
                return self._withdraw(message["cancel"], key)
            if "why" in message:
                return self._explain(message["why"], view)
            if "pause" in message or "stop" in message:
                return self._command(message)
            raise OrderError("the message needs 'order', 'cancel', 'why', 'pause' or 'stop'")
        except OrderError as error:
            return {"fault": str(error)}

    def _order(self, message: Mapping[str, Any], key: str, view: RunView) -> Answer:
        number, chosen = message["order"], message.get("chosen")
        if type(number) is not int or not 0 <= number < len(self._forms) or not isinstance(chosen, dict):
            raise OrderError("there is no such order")
        form = self._forms[number]
        text, words = form.fill(chosen, *_world(view)), form.words(chosen, view.sentences.titles)
        if form.is_fact:
            self._core.report(text)
            return {"reported": text, "text": text, "words": words}
        self._forget_ended(view)
        if len(self._keys) >= MOST_OPEN:
            raise OrderError("too many orders are open: wait until some have ended")
        found = self._core.send(text)
        self._keys[found] = key
        return {"ordered": found, "text": text, "words": words}

    def _withdraw(self, found: Any, key: str) -> Answer:
        known = self._keys.get(found) if isinstance(found, str) else None
        if known is None or not hmac.compare_digest(_bytes(known), _bytes(key)):
            raise OrderError("this page did not send that order, or it has ended")
        self._core.cancel(found)
        return {"canceled": found}

    def _forget_ended(self, view: RunView) -> None:
        """Forget ended goals; the view can lack a goal that was just sent."""
        self._keys = {one: key for one, key in self._keys.items() if not view.has_ended(one)}

    def _command(self, message: Mapping[str, Any]) -> Callable[[], Answer]:
        """Return the function that executes a command: ``pause`` with true or false, or ``stop`` with true."""
        if not self._forms:
            raise OrderError("this page only shows the robot: it has no orders (~orders)")
        paused = message.get("pause", message.get("stop"))
        if type(paused) is not bool or ("stop" in message and (not paused or "pause" in message)):
            raise OrderError("'pause' needs true or false, and 'stop' true")
        act = (lambda: self._core.pause(paused)) if "pause" in message else self._core.stop
        return _waiting(self._commands, lambda: {"done": act()})

    def _explain(self, found: Any, view: RunView) -> Taken:
        """Answer why a goal is not met: by its reason, or by the core's explanation if it has no plan."""
        state = view.last_state(found) if isinstance(found, str) else None
        if state is None:
            raise OrderError("there is no such goal")
        word, reason = state
        own = [reason or _WITHOUT_REASON.get(word, "the core gives no reason")]
        if word != "aborted":
            return {"why": own, "details": ""}

        sentences = view.sentences

        def ask() -> Answer:
            """Ask the core."""
            lines, details = self._core.explain(found)
            return {"why": [*own, *map(sentences.replace, lines)], "details": details}

        return _waiting(self._asked, ask)


#: Why a goal in a state without a reason is not met yet.
_WITHOUT_REASON = {"pending": "the core has not planned for it yet", "waiting": "other goals come first"}


def _waiting(limit: threading.BoundedSemaphore, act: Callable[[], Answer]) -> Callable[[], Answer]:
    """Return a function that waits for the core; raises OrderError if too many others wait."""
    if not limit.acquire(blocking=False):
        raise OrderError("the core still answers earlier requests: try again")

    def wait() -> Answer:
        """Return the answer of the core."""
        try:
            return act()
        except OrderError as error:
            return {"fault": str(error)}
        finally:
            limit.release()

    return wait


def _bytes(key: str) -> bytes:
    return key.encode("utf-8", "surrogatepass")  # JSON can contain lone surrogates


def _world(view: RunView) -> "tuple[Sequence[str], Mapping[str, str]]":
    """Return the labels, and the places of the packages."""
    last = view.tables["packages"].last
    return list(view.about["labels"]), dict(last["places"]) if last is not None else {}
