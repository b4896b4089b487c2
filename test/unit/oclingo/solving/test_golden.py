"""The library gives the recorded answers of the original oClingo (test/data/oclingo_golden.json)."""

import pytest
from shipped import GOLDEN
from stream_play import drop_grounding

from rosoclingo.oclingo import ReactiveProgram, ReactiveSolver, SolveOutcome, parse_update


def words(answer):
    """Return the answer in the format of the file: the distinct words of its text, sorted."""
    return sorted(set(" ".join(map(str, answer)).split()))


@pytest.mark.parametrize("way", ["in place", "regrounding"])
@pytest.mark.parametrize("case", GOLDEN, ids=[case["name"] for case in GOLDEN])
def test_solver_gives_the_answers_of_oclingo(case, way):
    solver = ReactiveSolver(ReactiveProgram.from_text(case["program"]), models=0)
    for update in case["updates"]:
        if way == "regrounding":
            drop_grounding(solver)
        result = solver.update(parse_update(update["update"]))
        assert sorted(map(words, result.answers)) == sorted(sorted(answer) for answer in update["answers"])
        assert result.horizon == update["horizon"]
        assert (result.outcome is SolveOutcome.SATISFIABLE) == (update["end"] == "ok")
