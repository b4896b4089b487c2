"""The planner: behaviour that neither random streams nor tests of its parts cover."""

import pytest
from stream_play import planner_of, play

from rosoclingo.oclingo import ReactiveProgram, SolverError
from rosoclingo.planning.solver import PlanSolver


def test_solver_reports_messages_of_clingo_once():
    solver = planner_of("#cumulative t. #external e(t). c(Y+t) :- e(t), p(Y). #base. p(1). p(a).")
    found = [one for step in (1, 2) for one in play(solver, f"#step {step} : 0. e({step}). e(x).").warnings]
    assert sum("e(x)" in one for one in found) == 2, "each update has an ignored fact"
    assert sum("undefined operation" in one for one in found) == 1


@pytest.mark.parametrize(
    ("rule", "horizon"), [("", 9), (":- t = 1.", 1), (":- t = 2.", 2), (":- t = 4.", 2), (":- t = 5.", 9)]
)
def test_steps_are_ground_in_blocks_if_answers_idle(rule, horizon, searches):
    """Otherwise, further steps could exclude an answer; the program is tested once."""
    text = f"#external go. #program cumulative(t). {{ a(t) }}. {rule} #program volatile(t). :- go, t < 2."
    program, numbers = ReactiveProgram.from_text(text), []
    for _ in range(2):
        solver = PlanSolver(program)
        searches.clear()
        play(solver, "#step 1 : 20. go.")
        assert solver.reached == horizon
        numbers.append(len(searches))
    assert numbers[0] > numbers[1]


def test_solver_reports_errors_of_the_idling_test():
    solver = planner_of("{ p(1..3) }. :- #sum { 2147483647,X : p(X) } > 3. #program cumulative(t).")
    with pytest.raises(SolverError, match="Integer overflow"):
        solver.solve()
