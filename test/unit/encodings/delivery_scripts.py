"""Scripts for delivery robots: expected actions and moves, in addition to the words of core_scripts."""

import re

from core_driver import Driver
from core_scripts import play
from shipped import shipped

from rosoclingo.reasoning.settings import CoreSettings

FILES = {"mailbot": ("mailbot.lp", "office.lp"), "house": ("house.lp", "home.lp"), "paper": ("paper.lp",)}


class Delivery(Driver):
    """A driver of a shipped program; ``acts`` and ``drives`` expect the actions since the last such expectation."""

    def __init__(self, name, preempt=False, **others):
        self.seen = 0
        super().__init__(settings=CoreSettings(preempt=preempt), program=shipped(*FILES[name]), **others)

    def since(self):
        found = [re.sub(r"^_action_lib\(|,\d+\)$", "", one) for one in self.journal.actions[self.seen :]]
        self.seen = len(self.journal.actions)
        return found

    def acts(self, *actions):
        """Expect these actions, as INTERFACE,PARAMETER."""
        assert self.since() == list(actions)

    def drives(self, *places):
        """Expect moves to these places."""
        assert [one.split(",")[1] for one in self.since() if one.startswith("move_base")] == list(places)

    def reach(self, action):
        """Let all actions succeed until this action, as INTERFACE,PARAMETER, is under way."""
        while not any(one.startswith(f"_action_lib({action},") for one in self.awaited):
            assert self.awaited, f"{action} is never under way"
            self.succeed()


def deliver(name, script, **others):
    """Play a script on the driver of a program."""
    return play(Delivery(name, **others), script)
