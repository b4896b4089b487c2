"""The stream planner: compaction, the meaning of a stopped search, and trial planners."""

import pytest
from core_driver import ERRANDS

from rosoclingo.oclingo import (
    DroppedError,
    ReactiveProgram,
    SolveOutcome,
    SolverError,
    SolveResult,
    StreamUpdate,
    parse_atom,
    parse_update,
)
from rosoclingo.oclingo.progression.updates import Expire
from rosoclingo.planning.history import AcceptedUpdate, History
from rosoclingo.planning.question import UNKNOWN, Reply
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.reasoning.keywords import action_of
from rosoclingo.reasoning.stream_planner import LONG_AGO, MANY_STEPS, RECENT, DisturbedError, Halt, Planner, steps_for


class Solver(PlanSolver):
    """Checks once whether to stop, and drops the update or answers anyway, as configured."""

    def __init__(self, program):
        super().__init__(program)
        self.drops = self.ignores = False

    def update(self, update, stopped=None):
        if self.drops:
            stopped()
            raise DroppedError("ended by the test")
        if self.ignores:
            stopped()
            return super().update(update)
        return super().update(update, stopped)


class Bench:
    """A planner with such solvers, whose searches end for the reason ``halt``."""

    def __init__(self, text=ERRANDS, lookahead=8):
        self.program, self.halt, self.solvers = ReactiveProgram.from_text(text), None, []
        self.planner = Planner(self.make, lookahead, lambda: lambda: self.halt)

    def make(self):
        self.solvers.append(Solver(self.program))
        return self.solvers[-1]

    def update(self, text):
        return self.planner.update(parse_update(text + " #endstep."))

    @property
    def solver(self):
        return self.solvers[0]


def plan(result):
    return [str(atom) for answer in result.answers for atom in sorted(answer) if atom.name == "_action_lib"]


@pytest.mark.parametrize(
    ("cycle", "since", "over"),
    [
        (500, 499, 500 - RECENT),  # recent events can need an explanation in any case
        (500, 500 - RECENT - 20, 500 - RECENT - 20),  # an open request looks back to its beginning
        (500, 1, 500 - LONG_AGO),  # but not for ever
    ],
)
def test_planner_computes_past_steps(cycle, since, over):
    planner = Planner(LoggingSolver, 8)
    assert planner.first_open(cycle + 1, since) == over
    planner.update(StreamUpdate(cycle + 1, items=(Expire(over),)))
    assert planner.first_open(cycle + 2) == max(over, cycle + 1 - LONG_AGO), "past steps stay past"


def test_planner_closes_the_past():
    bench = Bench()
    bench.update("#step 1.")
    result = bench.update("#step 2. _request(do(walk,1),2). :- not _action_lib(walk,1,1).")
    assert plan(result) == ["_action_lib(walk,1,1)"], "the committed actions were executed"
    trial = bench.planner.restarted()
    for planner in (bench.planner, trial):
        result = planner.update(parse_update("#step 3. _request(do(run,2),3). #endstep."))
        assert plan(result) == ["_action_lib(run,2,3)", "_action_lib(walk,1,1)"]
        assert planner.can_begin_with(parse_atom("_action_lib(run,2,3)"), 1)
        assert not planner.can_begin_with(parse_atom("_action_lib(run,2,2)"), 1), "cycle 2 is over"


def test_planner_without_lookahead_reports_no_answer_found():
    bench = Bench()
    update = parse_update("#step 1. _request(do(never,1),2). #endstep.")
    assert bench.planner.take(update).outcome is SolveOutcome.INTERRUPTED
    bench = Bench(ERRANDS + ":- _seen(end).")
    assert bench.planner.take(parse_update("#step 1. _seen(end). #endstep.")).outcome is SolveOutcome.UNSATISFIABLE


def test_planner_names_reason_for_missing_plan():
    bench = Bench(lookahead=3)
    result = bench.update("#step 1. _request(do(never,1),2).")
    assert bench.planner.why_none(result) == "there is no plan of at most 3 steps"
    result = bench.planner.take(parse_update("#step 2. #endstep."))
    assert bench.planner.why_none(result) == "no plan was found before the search was ended"
    bench.halt = Halt("it takes too long")
    result = bench.update("#step 3.")
    assert bench.planner.why_none(result) == "no plan was found before the search was ended: it takes too long"


def test_planner_treats_completed_search_as_not_stopped():
    bench = Bench()
    bench.halt, bench.solver.ignores = Halt("it takes too long", disturbed=True), True
    assert plan(bench.update("#step 1. _request(do(walk,1),2).")) == ["_action_lib(walk,1,1)"]
    assert bench.planner.ended_by == ""


def test_planner_names_reason_of_a_dropped_search():
    bench = Bench()
    bench.solver.drops, bench.halt = True, Halt("it takes too long")
    with pytest.raises(DroppedError):
        bench.update("#step 1.")
    assert bench.planner.ended_by == "it takes too long"
    bench.halt = None
    with pytest.raises(DroppedError):
        bench.update("#step 1.")
    assert bench.planner.ended_by == ""


@pytest.mark.parametrize("kept", [True, False])
def test_planner_keeps_or_drops_update_of_stopped_search(kept):
    bench = Bench()
    bench.update("#step 1. _request(do(walk,1),2).")
    bench.halt, bench.solver.drops = Halt("news", disturbed=True), not kept
    with pytest.raises(DisturbedError, match="the search was interrupted: news") as caught:
        bench.update("#step 2. :- not _action_lib(walk,1,1). _request(do(run,2),3).")
    assert caught.value.accepted == kept
    bench.halt, bench.solver.drops = None, False
    trial = bench.planner.restarted()
    actions = plan(trial.update(parse_update("#step 3. #endstep.")))
    assert any("run" in action for action in actions) == kept


def test_planner_trial_agrees_with_a_fresh_planner():
    trial = Bench().planner.restarted()
    assert plan(trial.update(parse_update("#step 1. _request(do(walk,1),2). #endstep."))) == ["_action_lib(walk,1,1)"]


class LoggingSolver:
    """A solver that keeps its log, checks a few times whether to stop, and has an answer ready.

    Instead of accepting an update it raises the ``error``; it also has the answer to one inquiry ready.
    """

    def __init__(self, outcome=SolveOutcome.SATISFIABLE, asks=0, verdict=None):
        self.log, self.outcome, self.asks = History(), outcome, asks
        self.verdict, self.inquired, self.error = verdict, [], None

    @property
    def step(self):
        return self.log.step

    def restore(self, log):
        self.log = log

    def update(self, update, stopped):
        if self.error is not None:
            raise self.error
        for _ in range(self.asks):
            stopped()
        self.log = self.log.with_entries(AcceptedUpdate(update, update.step + 9))
        return SolveResult(self.outcome, (), update.step, update.step)

    def inquire(self, *question):
        *question, stopped = question
        self.inquired.append(question)
        stopped()
        return self.verdict

    def improve(self, stopped):
        if self.error is not None:
            raise self.error
        return stopped()


def words(update):
    return " ".join(str(update).split()).replace(" #end step.", "")


def entries_of(planner):
    """Return the entries of the planner's log, as texts."""
    return [words(one.update) for one in planner.log.entries]


def fed(planner, *texts):
    """Return the planner after these updates."""
    for text in texts:
        planner.update(parse_update(text + " #endstep."))
    return planner


def test_planner_sends_expected_entries_to_solver():
    planner = Planner(LoggingSolver, 8)
    assert planner.ended_by == ""
    assert words(planner.last_update) == "#step 1."
    planner.solve()
    assert planner.first_open(RECENT + 2) == 0, "nobody looks back to cycle 0, but nothing is said of it"
    fed(planner, "#step 11. #over 2. _seen(a).", "#step 14. #over 2. #over 3. _seen(b).")
    planner.take(parse_update("#step 15. _seen(c). #endstep."))
    assert entries_of(planner) == [
        "#step 1 : 8.",
        "#step 11 : 8. #closed 1..10. #over 2. _seen(a).",
        "#step 14 : 8. #closed 11..13. #over 3. _seen(b).",
        "#step 15 : 0. #closed 14. _seen(c).",
    ]
    assert planner.log.keep_from == 3
    assert str(planner.last_update).startswith("#step 15 : 0.")


def test_planner_trial_repeats_last_update_without_lookahead():
    planner = fed(Planner(LoggingSolver, 8), "#step 1. _seen(a).", "#step 2. _seen(b). _seen(c).")
    trial = planner.restarted(frozenset({parse_atom("_seen(b)")}))
    assert (planner.log.horizon, trial.log.horizon) == (11, 2)
    trial.update(parse_update("#step 3. #endstep."))
    taken = ["#step 2 : 8. #closed 1. _seen(c).", "#step 3 : 8. #closed 2."]
    assert entries_of(trial) == ["#step 1 : 8. _seen(a).", "#withdraw _seen(b).", *taken]
    assert len(entries_of(planner)) == 2


def test_planner_trial_has_the_horizon_of_its_step():
    planner = fed(Planner(LoggingSolver, 8), "#step 1.", "#step 30.")
    assert planner.restarted().log.horizon == 30, "the lookahead of cycle 1 lies before"


def test_planner_replaces_the_last_update():
    planner = fed(Planner(LoggingSolver, 8), "#step 1. _seen(a).", "#step 2. _seen(b). _seen(c).")
    other = parse_update("#step 2. _seen(d). _seen(e). #endstep.")
    trial, result = planner.replace_update(other)
    assert entries_of(trial) == ["#step 1 : 8. _seen(a).", "#step 2 : 8. #closed 1. _seen(d). _seen(e)."]
    assert result.step == 2
    assert trial.last_update.step == 2
    again, _ = planner.replace_update(planner.last_update)
    assert entries_of(again) == entries_of(planner), "the past is sent once"
    trial, _ = Planner(LoggingSolver, 8).replace_update(parse_update("#step 1. _seen(d). #endstep."))
    assert entries_of(trial) == ["#step 1 : 8. _seen(d)."]


def test_planner_with_corrected_update_withdraws_older_facts():
    lines = "#step 1. _seen(a). _seen(b).", "#step 2. :- not _action_lib(walk,1,1). _seen(c). _seen(d)."
    planner = fed(Planner(LoggingSolver, 8), *lines)
    wrong = parse_atom("_seen(a)"), parse_atom("_seen(c)"), parse_atom("_action_lib(walk,1,1)")
    right = parse_atom("_seen(e)"), parse_atom("_seen(d)"), parse_atom("_seen(e)")
    trial, _ = planner.corrected(frozenset(wrong), right)
    assert entries_of(trial) == [
        "#step 1 : 8. _seen(a). _seen(b).",
        "#step 2 : 8. #withdraw _seen(a). #closed 1. _seen(d). _seen(e).",
    ]
    moved, _ = planner.corrected(frozenset(wrong[:2]), (wrong[1],))
    assert entries_of(moved)[1].endswith("_seen(d). _seen(c)."), "one is withheld, another is redated to it"


@pytest.mark.parametrize(
    ("steps", "arguments"),
    [
        # a tenth for each further goal
        *(
            (100, (0, 100)),
            (100, (1, 100)),
            (110, (2, 100)),
            (140, (5, 100)),
            (10, (3, 8)),
            (13, (2, 11)),
            (11, (2, 10)),
        ),
        # the present plan, and a quarter for each new goal
        *((100, (1, 100, 300, 1)), (110, (2, 100, 0, 2)), (110, (2, 100, 20, 1)), (400, (28, 100, 302, 0))),
        *((600, (36, 100, 302, 8)), (600, (36, 100, 299, 8))),
    ],
)
def test_planner_bounds_horizon_by_goals_and_plan(steps, arguments):
    assert steps_for(*arguments) == steps


@pytest.mark.parametrize("outcome", SolveOutcome)
def test_planner_trial_checks_whether_plan_is_valid(outcome):
    made = []

    def make():
        made.append(LoggingSolver(outcome))
        return made[-1]

    planner = fed(Planner(make, 8), "#step 1. _seen(a).", "#step 2. _seen(b).")
    actions = [action_of(parse_atom(text)) for text in ("_action_lib(go,1,3)", "_action_lib(go,2,5)")]
    result = planner.solve_with(actions)
    assert (result is None) == (outcome is not SolveOutcome.SATISFIABLE)
    asked = made[-1].log.entries[-1].update
    assert words(asked) == "#step 2 : 3. #volatile. :- not _action_lib(go,1,3). :- not _action_lib(go,2,5)."
    assert entries_of(planner) == ["#step 1 : 8. _seen(a).", "#step 2 : 8. #closed 1. _seen(b)."], "nothing is taken"


def test_planner_discards_a_refused_plan():
    solvers = [LoggingSolver(), LoggingSolver()]
    planner = fed(Planner(iter(solvers).__next__, 8), "#step 1.")
    solvers[1].error = SolverError("no")
    assert planner.solve_with([action_of(parse_atom("_action_lib(go,1,3)"))]) is None


@pytest.mark.parametrize(
    ("satisfiable", "halt", "ended_by"),
    [
        (True, None, ""),
        (False, None, ""),
        (None, None, ""),
        (None, Halt("the test"), "the test"),
        (True, Halt("the test", disturbed=True), ""),
        (False, Halt("the test"), ""),
    ],
)
def test_planner_inquiry_is_an_unaccepted_update(satisfiable, halt, ended_by):
    solver = LoggingSolver(verdict=Reply(satisfiable))
    planner = Planner(lambda: solver, 8, lambda: lambda: halt)
    planner.update(parse_update("#step 1. _seen(a). #endstep."))
    a, b = frozenset([parse_atom("_seen(a)")]), frozenset([parse_atom("_seen(b)")])
    planner.ended_by = "another search"
    assert planner.inquire(parse_update("#step 3. _seen(b). #endstep."), a | b, b, 5) is solver.verdict
    ((update, *facts),) = solver.inquired
    assert (words(update), facts) == ("#step 3 : 5. #closed 1..2. _seen(b).", [a | b, b])
    assert planner.ended_by == ended_by
    assert len(entries_of(planner)) == 1


def test_planner_inquiry_stops_on_arrival():
    planner = Planner(lambda: LoggingSolver(verdict=UNKNOWN), 8, lambda: lambda: Halt("news", disturbed=True))
    with pytest.raises(DisturbedError):
        planner.inquire(parse_update("#step 1. #endstep."), frozenset(), frozenset(), 5)


def test_planner_ignores_an_improvement_that_fails():
    solver = LoggingSolver()
    planner = Planner(lambda: solver, 8)
    assert planner.improve(lambda: "better") == "better"
    solver.error = SolverError("lost")
    assert planner.improve(lambda: "better") is None


@pytest.mark.parametrize(("outcome", "may"), [*zip(SolveOutcome, (True, False, True))])
def test_planner_asks_first_actions_without_side_effects(outcome, may):
    solver = LoggingSolver()
    planner = fed(Planner(lambda: solver, 8), "#step 4.")
    solver.outcome = outcome
    assert planner.can_begin_with(parse_atom("_action_lib(go,1,4)"), 3) is may
    assert entries_of(planner)[-1] == "#step 4 : 3. #volatile. :- not _action_lib(go,1,4)."


@pytest.mark.parametrize(
    ("step", "updates"),
    [
        (1, ["#step 1 : 8. #anew."]),
        (2, ["#step 2 : 8. #anew. #closed 0..1."]),
        (RECENT + 5, ["#step 15 : 8. #anew. #closed 0..14. #over 5."]),
        (MANY_STEPS, [f"#step {MANY_STEPS} : 8. #anew. #closed 0..{MANY_STEPS - 1}. #over {MANY_STEPS - RECENT}."]),
        (
            MANY_STEPS + 1,
            [
                "#step 100 : 8. #anew. #closed 0..99. #over 90.",
                "#step 101 : 8. #closed 100. #over 91.",
            ],
        ),
    ],
)
def test_planner_restarts_from_scratch(step, updates):
    planner = fed(Planner(LoggingSolver, 8), "#step 1. _seen(a).")
    trial, given, result = planner.reset(step)
    assert entries_of(trial) == updates
    assert list(map(words, given)) == updates
    assert result.step == step


def test_planner_reports_why_a_search_ended():
    halts = iter([None, Halt("first"), Halt("later", disturbed=True)])
    planner = Planner(lambda: LoggingSolver(SolveOutcome.INTERRUPTED, asks=3), 8, lambda: lambda: next(halts))
    planner.solve()
    assert planner.ended_by == "first"
    planner = Planner(lambda: LoggingSolver(SolveOutcome.INTERRUPTED), 8)
    planner.solve()
    assert planner.ended_by == "", "nobody ended it"


def test_planner_without_watch_never_stops_a_search():
    planner = Planner(lambda: LoggingSolver(asks=2), 8)
    assert planner.solve().outcome is SolveOutcome.SATISFIABLE
    assert planner.take(parse_update("#step 2. #endstep.")).outcome is SolveOutcome.SATISFIABLE
