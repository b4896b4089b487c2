"""Access control of the live page: hosts and tokens."""

import hashlib
import hmac
import re
from typing import FrozenSet, Optional

#: Host names of this machine.
LOCAL = frozenset({"127.0.0.1", "localhost", "::1"})

_HOST = re.compile(r"(\[[0-9a-fA-F:.]+\]|[\w.-]+)(:\d{1,5})?\Z")


class Access:
    """Checks hosts and tokens of requests: viewers on other machines need a token.

    ``token`` is empty for a page on this machine only. Then the page accepts only this machine's host names, so that no
    page of another site can reach it through its own host name.
    """

    def __init__(self, token: str = "") -> None:
        self.proof = hashlib.sha256(token.encode("utf-8")).hexdigest() if token else ""
        self._names: Optional[FrozenSet[str]] = None if token else LOCAL

    def accepts_host(self, host: str) -> bool:
        """Return whether the page accepts the host name of a ``Host`` header."""
        found = _HOST.match(host)
        if found is None:
            return False
        return self._names is None or found.group(1).strip("[]").lower() in self._names

    def is_token(self, token: str) -> bool:
        """Return whether this is the token."""
        return self.is_proof(hashlib.sha256(token.encode("utf-8")).hexdigest())

    def is_proof(self, proof: str) -> bool:
        """Return whether this ``proof``, which a browser stores in place of the token, is valid."""
        return not self.proof or hmac.compare_digest(proof.encode("utf-8"), self.proof.encode("utf-8"))
