"""Kill the core at any instant, while actions of several cycles run or with preemption; `test_both_killed` has errands.

Each goal ends once, with the right outcome, and no action runs twice.
"""

import copy
import tempfile
from pathlib import Path

import pytest
from core_driver import shortest
from hypothesis import given
from hypothesis import strategies as st
from killed_core import HAPPENED, KILLS, PROGRAM, Fate, Play, World
from team_programs import TEAM

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.reasoning.core import Core
from rosoclingo.reasoning.journal import folder
from rosoclingo.reasoning.journal.database import NAME, history
from rosoclingo.reasoning.settings import CoreSettings

#: Rows of the journal that belong to the keeper rather than the core.
KEEPERS = ("client:", "unmet:")


#: Goals do(Machine,Id) as those of the errands, any number of them at once.
ERRANDS_AT_ONCE = TEAM.replace("job(M,I)", "do(M,I)").replace("M != broken", "M != never")


class Team(World):
    """A world in which several errands run at once, and go on from cycle to cycle."""

    program = ReactiveProgram.from_text(ERRANDS_AT_ONCE)


def played(script, kills=(), preempt=False, world=World):
    """Play a script with kills and return the result."""
    fate = Fate(kills)
    with tempfile.TemporaryDirectory() as name, fate.rules():
        return Play(Path(name), fate, preempt, world()).play(script), fate


#: Goals that are met, rejected, cancelled and aborted, a failure, a fact, concurrent and consecutive goals.
SCRIPT = [
    ("goal", "walk"),
    ("goal", "quick"),
    ("goal", "nonsense"),
    ("answer", 0, False),
    ("goal", "run"),
    ("cancel", 4),
    ("fact", "_seen(ball)"),
    ("answer", 1, True),
    ("goal", "never"),
    ("answer", 0, True),
    ("goal", "walk"),
    ("cancel", 6),
    ("goal", "run"),
    ("answer", 0, False),
]


#: Errands that start and end in several cycles, failures with and without others under way, a cancel, an abort.
TEAM_SCRIPT = [
    ("goal", "walk"),
    ("goal", "run"),
    ("answer", 0, False),
    ("goal", "quick"),
    ("goal", "walk"),
    ("answer", 1, True),
    ("goal", "never"),
    ("fact", "_seen(ball)"),
    ("cancel", 4),
    ("answer", 2, False),
    ("answer", 0, True),
]


@pytest.mark.slow
@pytest.mark.once
def test_core_survives_kill_at_every_instant():
    play, fate = played(TEAM_SCRIPT, world=Team)
    assert (play.kills, bool(fate.writes)) == (0, True)
    for instant, share in fate.kills_at_every_instant():
        assert played(TEAM_SCRIPT, [(instant, share, share < 1000)], world=Team)[0].kills == 1


@pytest.fixture(scope="module")
def states():
    """Return the states that an undisturbed core writes, from its first record on."""
    with tempfile.TemporaryDirectory() as name:
        fate = Fate()
        with fate.rules(), pytest.MonkeyPatch.context() as patch:
            patch.setattr(folder, "RECORDS", 10**9)
            Play(Path(name), fate, preempt=False).play(SCRIPT)
        return [copy.deepcopy(state) for state, _ in history(Path(name) / NAME)[1]]


@pytest.mark.slow
def test_journal_state_equals_state_of_resumed_core(states):
    limits = CoreSettings(8, 0.0, goals_at_once=3, search_timeout=0.0)
    assert len(states) > 20
    for state in states:
        own = {name: value for name, value in state.items() if not name.startswith(KEEPERS)}
        core = Core(PROGRAM, lambda: shortest(PROGRAM), lambda event: None, limits, record=copy.deepcopy(own))
        assert core.state() == own


@pytest.mark.slow
@given(script=st.lists(HAPPENED, min_size=3, max_size=14), kills=KILLS, long_actions=st.booleans())
def test_core_survives_repeated_kills(script, kills, long_actions):
    played(script, kills, not long_actions, Team if long_actions else World)
