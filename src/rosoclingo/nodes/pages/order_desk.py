"""Orders from pages: each becomes a goal, which only the same page can cancel."""

import hmac
from collections import OrderedDict
from typing import Any, Callable, Dict, Mapping, Sequence

from rosoclingo.runs.orders import OrderError, OrderForm
from rosoclingo.runs.run_view import RunView

__all__ = ["OrderDesk"]

#: Limits of open and of remembered goals of pages (open goals are always remembered), and of characters of a key.
MOST_OPEN, MOST_KNOWN, LONGEST_KEY = 50, 1000, 100

Answer = Dict[str, Any]


class OrderDesk:
    """Processes orders and cancellations.

    ``send`` sends a goal and returns its id, ``cancel`` cancels the goal of an id; both raise OrderError on failure.
    Each order has a ``key`` that only its browser knows; the cancellation needs the same key.
    """

    def __init__(self, forms: Sequence[OrderForm], send: Callable[[str], str], cancel: Callable[[str], None]) -> None:
        self._forms = forms
        self._send, self._cancel = send, cancel
        self._keys: OrderedDict[str, str] = OrderedDict()  # by the goal's id

    def describe(self, view: RunView) -> Sequence[Dict[str, Any]]:
        """Return the forms for a page."""
        return [form.describe(*_world(view)) for form in self._forms]

    def take(self, message: Mapping[str, Any], view: RunView) -> Answer:
        """Process a request of a page; the answer has ``ordered``, ``canceled`` or ``fault``."""
        key = message.get("key")
        try:
            if not isinstance(key, str) or not 8 <= len(key) <= LONGEST_KEY:
                raise OrderError("the page sent no key")
            if not is_unicode(key):
                raise OrderError("the key is not valid Unicode: it has a lone surrogate")
            if "order" in message:
                return self._order(message, key, view)
            if "cancel" in message:
                return self._withdraw(message["cancel"], key)
            raise OrderError("the message needs 'order' or 'cancel'")
        except OrderError as error:
            return {"fault": str(error)}

    def _order(self, message: Mapping[str, Any], key: str, view: RunView) -> Answer:
        number, chosen = message["order"], message.get("chosen")
        if type(number) is not int or not 0 <= number < len(self._forms) or not isinstance(chosen, dict):
            raise OrderError("there is no such order")
        text = self._forms[number].fill(chosen, *_world(view))
        still = [one for one in self._keys if not view.has_ended(one)]  # the view can lack a goal that was just sent
        if len(still) >= MOST_OPEN:
            raise OrderError("too many orders are open: wait until some have ended")
        for one in [one for one in self._keys if view.has_ended(one)][: max(0, len(self._keys) + 1 - MOST_KNOWN)]:
            del self._keys[one]
        found = self._send(text)
        self._keys[found] = key
        return {"ordered": found, "text": text}

    def _withdraw(self, found: Any, key: str) -> Answer:
        known = self._keys.get(found) if isinstance(found, str) else None
        if known is None or not hmac.compare_digest(known.encode("utf-8"), key.encode("utf-8")):
            raise OrderError("this page did not send that order")
        self._cancel(found)
        return {"canceled": found}


def is_unicode(text: str) -> bool:
    """Return whether a text can be encoded: JSON can contain lone surrogates."""
    return not any("\ud800" <= letter <= "\udfff" for letter in text)


def _world(view: RunView) -> "tuple[Sequence[str], Mapping[str, str]]":
    """Return the labels, and the places of the packages."""
    last = view.tables["packages"].last
    return list(view.about["labels"]), dict(last["places"]) if last is not None else {}
