"""The planner: behaviour that neither random streams nor tests of its parts cover."""

from itertools import count

import pytest
from stream_play import planner_of, play, processor_clock

from rosoclingo.oclingo import ReactiveProgram, SolverError
from rosoclingo.planning.grounding import Grounding
from rosoclingo.planning.idling import may_idle
from rosoclingo.planning.question import UNKNOWN
from rosoclingo.planning.solver import PlanSolver


@pytest.mark.parametrize("options", [{"plan_time": 9.0}, {}])
def test_solver_counts_the_time_until_an_answer(options):
    """The time for improving the answer is not counted."""
    solver = planner_of("#cumulative t. { a(t) }. #volatile t. :- t < 3.", **options)
    with processor_clock(count(100.0).__next__):
        assert play(solver, "#step 1 : 9.").statistics["needed"] == 2.0


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


@pytest.mark.parametrize("number", [1, 2])
def test_may_idle_tries_again_after_a_stop(monkeypatch, number):
    asked, ask = [], Grounding.ask

    def stopped_once(grounding, question, stopped):
        asked.append(question)
        return UNKNOWN if len(asked) == number else ask(grounding, question, stopped)

    monkeypatch.setattr(Grounding, "ask", stopped_once)
    program = ReactiveProgram.from_text("#program cumulative(t). { a(t) }. #program volatile(t).")
    assert [may_idle(program, lambda: False) for _ in range(2)] == [False, True]


def test_solver_reports_errors_of_the_idling_test():
    solver = planner_of("{ p(1..3) }. :- #sum { 2147483647,X : p(X) } > 3. #program cumulative(t).")
    with pytest.raises(SolverError, match="Integer overflow"):
        solver.solve()
