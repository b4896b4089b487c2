"""The core is killed at any instant: each goal ends once, as it should, and nothing is done twice."""

import tempfile
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from killed_core import HAPPENED, KILLS, Fate, Play


def played(script, kills=(), preempt=False):
    """Play a script with kills."""
    fate = Fate(kills)
    with tempfile.TemporaryDirectory() as name, fate.rules():
        return Play(Path(name), fate, preempt).play(script), fate


#: Goals that are met, refused, cancelled and given up, a failure, a fact, several at once and one after the other.
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


@pytest.mark.slow
def test_killed_at_every_instant():
    _, fate = played(SCRIPT)
    assert fate.writes
    for instant in range(1, fate.instants + 1):
        for cut in (0, 500, 1000) if instant in fate.writes else (0,):
            play, _ = played(SCRIPT, [(instant, cut, cut < 1000)])
            assert play.kills == 1


@pytest.mark.slow
@given(script=st.lists(HAPPENED, min_size=3, max_size=14), kills=KILLS, preempt=st.booleans())
def test_killed_again_and_again(script, kills, preempt):
    played(script, kills, preempt)
