"""Kill the core at any instant while actions go on: each goal ends once, and no action runs twice."""

import tempfile
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from killed_core import HAPPENED, KILLS, Fate, Play, World
from team_programs import TEAM

from rosoclingo.oclingo import ReactiveProgram

#: Goals do(Machine,Id) as those of the errands, any number of them at once.
ERRANDS_AT_ONCE = TEAM.replace("job(M,I)", "do(M,I)").replace("M != broken", "M != never")


class Team(World):
    """A world in which several errands run at once, and go on from cycle to cycle."""

    program = ReactiveProgram.from_text(ERRANDS_AT_ONCE)


def played(script, kills=()):
    fate = Fate(kills)
    with tempfile.TemporaryDirectory() as name, fate.rules():
        return Play(Path(name), fate, preempt=False, world=Team()).play(script), fate


#: Errands that start and end in several cycles, failures with and without others under way, a cancel, an abort.
SCRIPT = [
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


def test_long_actions_end_once_without_a_kill():
    play, _ = played(SCRIPT)
    assert play.kills == 0


@pytest.mark.slow
@pytest.mark.once
def test_long_actions_survive_kill_at_every_instant():
    _, fate = played(SCRIPT)
    for instant, share in fate.kills_at_every_instant():
        assert played(SCRIPT, [(instant, share, share < 1000)])[0].kills == 1


@pytest.mark.slow
@given(script=st.lists(HAPPENED, min_size=3, max_size=14), kills=KILLS)
def test_long_actions_survive_random_kills(script, kills):
    played(script, kills)
