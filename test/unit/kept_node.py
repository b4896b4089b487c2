"""Cores with a keeper of their state, driven as their node does."""

from core_driver import ERRANDS, shortest

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.reasoning.core import Core
from rosoclingo.reasoning.journal.database import Header
from rosoclingo.reasoning.journal.folder import Journal
from rosoclingo.reasoning.journal.keeper import ClientGoal, Keeper
from rosoclingo.reasoning.settings import CoreSettings

PROGRAM = ReactiveProgram.from_text(ERRANDS, "errands.lp")


class KeptCore:
    """A core over an open journal, None for none; ``tell`` gets its durable events."""

    def __init__(self, tell, journal, program, settings, make=shortest, clock=lambda: 0.0):
        kept = None if journal is None else journal.read()
        record = None if kept is None else kept.state
        self.keeper = Keeper(tell, journal, lambda: 0.0, clock)
        self.core = Core(program, lambda: make(program), self.keeper, settings, record=record)
        self.keeper.attach(self.core, record)

    def goal(self, key, text, stamp=(1, 2)):
        """Send a goal."""
        self.keeper.add(key, ClientGoal(text, stamp))
        self.keeper.keep()
        self.core.add_goal(key, text)
        return self

    def cancel(self, key):
        """Send a cancel."""
        self.keeper.cancel(key)
        self.keeper.keep()
        self.core.cancel_goal(key)
        return self

    def run(self):
        """Advance as far as possible."""
        self.keeper.send()
        while self.core.advance(1.0):
            self.keeper.send()
        self.keeper.send()
        return self


class Node(KeptCore):
    """A core over the journal in a folder; ``published`` are its events."""

    def __init__(self, path, program=PROGRAM, horizon_limit=8):
        self.folder = Journal(path, Header("run", "program"))
        self.published, self.at_event = [], lambda event: None
        settings = CoreSettings(horizon_limit=horizon_limit, search_timeout=0.0)
        super().__init__(self._tell, self.folder, program, settings)
        self.core.start()
        self.keeper.send()

    def _tell(self, event):
        self.at_event(event)
        self.published.append(event)

    @property
    def on_disk(self):
        """Return the state that another core would read."""
        return self.folder.read().state

    def succeed(self):
        """Let the actions under way succeed."""
        for one in self.core.awaited:
            self.core.receive("hand", [f"_return({one.interface},{one.parameter},{one.cycle})"])
        return self.run()
