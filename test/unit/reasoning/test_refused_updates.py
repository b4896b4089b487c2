"""What is taken of an update that the solver refuses, or drops since its search does not end."""

import pytest

from rosoclingo.oclingo import DroppedError, SolveOutcome, SolverError, SolveResult, parse_atom, parse_term
from rosoclingo.reasoning import Outcome
from rosoclingo.reasoning.goals import Goal
from rosoclingo.reasoning.input_feeder import InputFeeder
from rosoclingo.reasoning.keywords import action_of
from rosoclingo.reasoning.stream_planner import feed_less

COMMITMENT, REQUEST, FACT = ":- not _action_lib(a,x,4).", "_request(g(1),6).", "_seen(ball)."
RESULT = SolveResult(SolveOutcome.SATISFIABLE, (), 5, 5)


class Planner:
    """Raises the errors that it was given, one a call, then has a result."""

    def __init__(self, *errors, ended_by=""):
        self.errors, self.ended_by, self.calls = list(errors), ended_by, []

    def update(self, update):
        return self._call("update", update)

    def take(self, update):
        return self._call("take", update)

    def _call(self, name, update):
        self.calls.append(" ".join([name, *map(str, update.items)]))
        if self.errors:
            raise self.errors.pop(0)
        return RESULT


class Ends:
    """Keeps which goals ended how."""

    def __init__(self):
        self.ends = []

    def end(self, goals, outcome, why):
        self.ends += [(goal.key, outcome, why) for goal in goals]


def fed(planner, facts=True, others=False):
    """What came of feeding a batch, how its goal ended, and the problems."""
    feeder, goal, ended, problems = InputFeeder(), Goal("a", parse_term("g(1)"), lambda _goal, _event: None), Ends(), []
    feeder.add_goal(goal)
    if facts:
        feeder.add_fact(parse_atom("_seen(ball)"))
    feeder.add_executed([action_of(parse_atom("_action_lib(a,x,4)"))])
    batch = feeder.next_update(5)
    error = planner.errors.pop(0)
    return feed_less(planner, batch, error, ended.end, problems.append, others), ended.ends, problems


@pytest.mark.parametrize("times", [1, 2])
def test_of_an_update_that_is_refused_goals_are_left_out_then_all_but_commitments(times):
    planner = Planner(*[SolverError("no"), SolverError("nor that")][:times], ended_by="it took too long")
    result, ends, problems = fed(planner)
    assert result is RESULT
    assert ends == [("a", Outcome.REJECTED, "is refused by the solver: no")]
    assert problems == [f"update 5 is refused by the solver: {why}" for why in ("no", "nor that")[:times]]
    calls = [f"update {COMMITMENT} {FACT}", f"update {COMMITMENT}"]
    assert planner.calls == calls[:times]


@pytest.mark.parametrize("times", [1, 2, 3])
def test_one_that_was_dropped_is_fed_without_looking_ahead(times):
    planner = Planner(*[DroppedError("ended")] * times, ended_by="it took too long")
    result, ends, problems = fed(planner)
    assert result is RESULT
    assert ends == [], "what takes long is no reason to end a goal"
    assert problems == ["update 5 is dropped: it took too long: ended"] * times
    calls = [f"{COMMITMENT} {REQUEST} {FACT}", f"{COMMITMENT} {FACT}", COMMITMENT]
    assert planner.calls == [f"take {call}" for call in calls][:times]


@pytest.mark.parametrize("times", [1, 2, 3])
def test_of_one_that_was_dropped_new_goals_are_left_out_where_there_is_a_plan_for_others(times):
    planner = Planner(*[DroppedError("ended")] * times, ended_by="it took too long")
    result, ends, problems = fed(planner, others=True)
    assert result is RESULT
    assert ends == []
    assert problems == ["update 5 is dropped: it took too long: ended"] * times
    assert planner.calls == [f"update {COMMITMENT} {FACT}", f"take {COMMITMENT} {FACT}", f"take {COMMITMENT}"][:times]


@pytest.mark.parametrize(("kind", "times"), [(SolverError, 2), (DroppedError, 3)])
def test_nothing_is_taken(kind, times):
    errors = [kind(str(number)) for number in range(times)]
    planner = Planner(*errors)
    with pytest.raises(SolverError) as raised:
        fed(planner, facts=False)
    assert raised.value is errors[-1]
    assert len(set(planner.calls)) == len(planner.calls), "without facts only the commitments are left, and tried once"
