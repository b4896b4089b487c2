"""The incremental solver agrees with a reference that solves the accumulated program after each update."""

from hypothesis import given, settings
from hypothesis import strategies as st
from random_streams import PARTS, UPDATES, without_undeclared
from solver_reference import Reference

from rosoclingo.oclingo import ReactiveProgram, ReactiveSolver, SolveOutcome


@settings(max_examples=settings.default.max_examples * 4)
@given(PARTS, st.lists(UPDATES, min_size=1, max_size=5))
def test_random_streams_have_answers_of_a_fresh_solver(parts, updates):
    reference = Reference(parts)
    solver = ReactiveSolver(ReactiveProgram.from_text(parts.text()), models=0)
    for update in updates:
        update = without_undeclared(parts, update)
        satisfiable, answers, horizon, ignored = reference.update(update)
        result = solver.update(update)
        assert {frozenset(map(str, answer)) for answer in result.answers} == answers, (parts.text(), str(update))
        assert len(result.answers) == len(answers)
        assert result.horizon == horizon or result.permanent
        assert (result.outcome is SolveOutcome.SATISFIABLE) == satisfiable
        if result.permanent:
            return
        # a fact that is already permanently true is ignored without a warning
        assert sum("declared external" in warning for warning in result.warnings) <= ignored
