"""A core over the journal in a folder, driven as its node does."""

from core_driver import ERRANDS, shortest

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.reasoning.core import Core
from rosoclingo.reasoning.journal.database import Header
from rosoclingo.reasoning.journal.folder import Journal
from rosoclingo.reasoning.journal.keeper import ClientGoal, Keeper
from rosoclingo.reasoning.settings import CoreSettings

PROGRAM = ReactiveProgram.from_text(ERRANDS, "errands.lp")


class Node:
    """Drives a core, a keeper and a journal as a node does; ``published`` are its events."""

    def __init__(self, path, program=PROGRAM, horizon_limit=8):
        self.folder = Journal(path, Header("run", "program"))
        kept = self.folder.read()
        self.published, self.at_event = [], lambda event: None
        self.keeper = Keeper(self._tell, self.folder, lambda: 0.0, lambda: 0.0)
        record = None if kept is None else kept.state
        settings = CoreSettings(horizon_limit=horizon_limit, search_timeout=0.0)
        self.core = Core(program, lambda: shortest(program), self.keeper, settings, record=record)
        self.keeper.attach(self.core, record)
        self.core.start()
        self.keeper.send()

    def _tell(self, event):
        self.at_event(event)
        self.published.append(event)

    @property
    def on_disk(self):
        """Return the state that another core would read."""
        return self.folder.read().state

    def goal(self, key, text):
        """Send a goal."""
        self.keeper.add(key, ClientGoal(text, (1, 2)))
        self.keeper.keep()
        self.core.add_goal(key, text)
        return self.run()

    def run(self):
        """Advance as far as possible."""
        self.keeper.send()
        while self.core.advance(1.0):
            self.keeper.send()
        self.keeper.send()
        return self

    def succeed(self):
        """Let the actions under way succeed."""
        for one in self.core.awaited:
            self.core.receive("hand", [f"_return({one.interface},{one.parameter},{one.cycle})"])
        return self.run()
