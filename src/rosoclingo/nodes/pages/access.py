"""Who may see and use the live page."""

import hashlib
import hmac
import re
from typing import FrozenSet, Optional
from urllib.parse import urlsplit

__all__ = ["Access"]

#: Names of this machine alone.
LOCAL = frozenset({"127.0.0.1", "localhost", "::1"})

_HOST = re.compile(r"(\[[0-9a-fA-F:.]+\]|[\w.-]+)(:\d{1,5})?\Z")


class Access:
    """Viewers on this machine need no token, others do.

    ``token`` is empty for a page on this machine alone; then it answers only to this machine's own names, so that no
    page of another site can reach it by a name of its own.
    """

    def __init__(self, token: str = "") -> None:
        self.proof = hashlib.sha256(token.encode("utf-8")).hexdigest() if token else ""
        self._names: Optional[FrozenSet[str]] = None if token else LOCAL

    def named(self, host: str) -> bool:
        """Whether the page answers to the name in a ``Host`` header."""
        found = _HOST.match(host)
        if found is None:
            return False
        return self._names is None or found.group(1).strip("[]").lower() in self._names

    def known(self, token: str) -> bool:
        """Whether this is the token."""
        return self.proven(hashlib.sha256(token.encode("utf-8")).hexdigest())

    def proven(self, proof: str) -> bool:
        """Whether somebody with this ``proof``, which a browser keeps in place of the token, may see the page."""
        return not self.proof or hmac.compare_digest(proof.encode("utf-8"), self.proof.encode("utf-8"))

    @staticmethod
    def own(origin: Optional[str], host: str) -> bool:
        """Whether a page of this very address asks; a request without an ``Origin`` is no browser's."""
        try:
            return origin is not None and urlsplit(origin).netloc.lower() == host.lower()
        except ValueError:  # not a URL
            return False
