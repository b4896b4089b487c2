"""One grounding: blocks of steps, and memory after a question (see also test_stream_answers.py)."""

import gc
import weakref

import pytest

from rosoclingo.oclingo import DroppedError, ReactiveProgram
from rosoclingo.planning.grounding import Grounding, pieces
from rosoclingo.planning.question import Question
from rosoclingo.planning.snapshot import Snapshot

PROGRAM = ReactiveProgram.from_text("#cumulative t. #external e(t). { a(t) }. #volatile t. s(t) :- e(t).")


@pytest.mark.parametrize(
    ("keep_from", "end", "ends"),
    [
        (0, 10, [4, 8, 10]),
        (2, 10, [1, 5, 9, 10]),
        (5, 10, [4, 8, 10]),
        (6, 10, [4, 5, 9, 10]),
        (6, 5, [4, 5]),
        (6, 0, []),
    ],
)
def test_pieces_end_where_compaction_can_start(keep_from, end, ends):
    assert list(pieces(1, end, 4, keep_from)) == ends


def test_dropped_grounding_ends_between_two_pieces():
    looks = []
    with pytest.raises(DroppedError):
        Grounding(PROGRAM, Snapshot(), 1000, dropped=lambda: looks.append(1) or len(looks) > 3)
    assert len(looks) == 4


@pytest.mark.parametrize("predicts", [False, True])
def test_grounding_without_references_is_freed_at_once(predicts):
    grounding = Grounding(PROGRAM, Snapshot(), 3, predicts=predicts)
    assert grounding.undefined_between(1, 3)
    assert grounding.ask(Question(1, 3), lambda: False).satisfiable
    reference = weakref.ref(grounding)
    gc.disable()
    try:
        del grounding
        assert reference() is None
    finally:
        gc.enable()
