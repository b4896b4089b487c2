"""One open backend for all changes between two groundings or searches: opening one anew for each costs milliseconds."""

from typing import ContextManager, Optional

import clingo
from clingo.backend import Backend

OPEN, HOLDS, RELEASED = clingo.TruthValue.False_, clingo.TruthValue.True_, clingo.TruthValue.Release


class Editor:
    """Ground statements added to a control."""

    def __init__(self, control: clingo.Control) -> None:
        self._control = control
        self._session: Optional[ContextManager[Backend]] = None
        self._backend: Optional[Backend] = None

    @property
    def backend(self) -> Backend:
        """The open backend; opened on first use."""
        if self._backend is None:
            self._session = self._control.backend()
            self._backend = self._session.__enter__()
        return self._backend

    def close(self) -> None:
        """Hand all changes over; to be called before clingo grounds or searches."""
        if self._session is not None:
            session, self._session, self._backend = self._session, None, None
            session.__exit__(None, None, None)

    def new_external(self, value: clingo.TruthValue = OPEN) -> int:
        """Return a new nameless external."""
        literal = self.backend.add_atom()
        self.backend.add_external(literal, value)
        return literal

    def release(self, literal: int) -> None:
        """Make an external false for good."""
        self.backend.add_external(literal, RELEASED)
