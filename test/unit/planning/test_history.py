"""Histories: each reader gives the answers of the writer and of a reference that solves from scratch."""

import json
from contextlib import nullcontext
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from random_streams import ITEMS, LITERALS, PARTS, RULES, UPDATES, VOLATILE, function, without_undeclared
from solver_reference import Parts, ShortestReference
from stream_logs import copied, cut, text_of, texts
from workloads import sized

from rosoclingo.oclingo import ReactiveProgram, SolveOutcome, parse_update
from rosoclingo.oclingo.progression.updates import CloseCycles, Expire, Literal, Statement, StreamUpdate, Withdraw
from rosoclingo.planning.grounding import Grounding
from rosoclingo.planning.history import AcceptedUpdate, History, Plan
from rosoclingo.planning.snapshot import Snapshot
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.planning.text import snapshot_from_message, snapshot_to_message
from rosoclingo.planning.workers.pool import WorkerPool
from rosoclingo.planning.workers.process_solver import ProcessSolver

# ---- Random streams --------------------------------------------------------------------------------------------------

#: Programs with loops over several steps, which statements can close.
LOOPS = st.sampled_from(
    [
        "c(t) :- e(t).",
        "c(t) :- f(x,t).",
        "d(t) :- c(t).",
        "d(t) :- d(t-1), not p(t).",
        "w(t) :- d(t-1), e(t).",
        ":- c(t), not d(t).",
    ]
)
LOOPING = st.builds(
    lambda loops, rules, volatile: Parts(
        ("{ a }.", "{ b }."),
        ("{ p(t) }.", "#defined q/1.", "#defined g/2.", "#defined c/1.", "#defined d/1.", *loops, *rules),
        tuple(volatile),
        ("e(t)", "f(x,t)", "f(y,t)"),
        (),
        ("x", "y"),
    ),
    st.lists(LOOPS, max_size=4),
    st.lists(RULES.filter(lambda rule: "g(" not in rule), max_size=2),
    st.lists(VOLATILE, max_size=1),
)
HEADS = st.sampled_from([function(name, 1) for name in "exy"] + [function("e", 2), function("f", "x", 1)])
SUPPORTS = (HEADS | st.builds(function, st.sampled_from("cdw"), st.integers(1, 3))).map(Literal) | LITERALS
CLOSING = st.builds(Statement, HEADS, st.lists(SUPPORTS, min_size=1, max_size=2).map(tuple))
LOOPING_UPDATES = st.builds(
    StreamUpdate,
    st.integers(1, 3),
    st.integers(0, 2),
    st.lists(st.one_of(CLOSING, CLOSING, CLOSING, ITEMS), max_size=4).map(tuple),
)
#: Many statements, with steps in ascending order.
IN_ORDER = st.builds(
    lambda steps, items: [StreamUpdate(*pair) for pair in zip(steps, [0, 1, 0, 2, 0], items)],
    st.lists(st.integers(1, 3), min_size=1, max_size=5).map(sorted),
    st.lists(st.lists(ITEMS, min_size=2, max_size=8).map(tuple), min_size=5, max_size=5),
)
STREAMS = st.one_of(
    st.tuples(PARTS, st.lists(UPDATES, min_size=1, max_size=5) | IN_ORDER),
    st.tuples(LOOPING, st.lists(LOOPING_UPDATES, min_size=1, max_size=6)),
)
OPTIONS = {"models": 0, "log_limit": 3, "idles": False}


def readings(writer, old):
    """Return histories to restore: the same one, its text, its snapshot, or an ``old`` snapshot with later entries."""
    log, snapshot = old
    rest = writer.log.entries_after(log)
    return [
        writer.log,
        copied(writer.log),
        cut(writer),
        copied(writer.log if rest is None else snapshot.with_entries(*rest)),
    ]


def check(mine, its):
    """Check that two results are equal; one of them can be permanent."""
    assert texts(mine) == texts(its)
    assert mine.outcome is its.outcome
    if not (mine.permanent or its.permanent):
        assert (mine.horizon, mine.step, set(mine.warnings)) == (its.horizon, its.step, set(its.warnings))


def check_grounding(solver, reference):
    """Check that statements and forgotten externals agree with the reference."""
    snapshot = solver.snapshot
    assert snapshot_from_message(json.loads(json.dumps(snapshot_to_message(snapshot)))) == snapshot
    grounding = Grounding(solver.program, snapshot, snapshot.horizon)
    facts = snapshot.permanent_facts(frozenset())
    given_facts = {str(one) for one in facts if solver.program.is_open_signature(one)}
    held = [one.statement for one in reference.held if not one.waiting]
    held = {str(one) for one in held if not (one.body and str(one.head) in given_facts)}
    facts = {str(Statement(one)) for one in grounding.open_facts}
    assert {str(one.statement) for one in grounding.statements} | facts == held
    false = {str(one) for one in grounding.definitions.false}
    assert false | reference.closed == reference.forgotten | reference.closed


@pytest.mark.slow
@settings(max_examples=sized(20, settings.default.max_examples * 3))
@given(STREAMS, st.lists(st.none() | st.integers(0, 3), min_size=6, max_size=6))
def test_history_readers_answer_as_writer_and_reference(stream, ways):
    """``ways`` selects how a new reader is restored before each update; None keeps the last reader."""
    parts, updates = stream
    program, reference = ReactiveProgram.from_text(parts.text()), ShortestReference(parts)
    writer = reader = PlanSolver(program, **OPTIONS)
    old = writer.log, cut(writer)
    for update, way in zip(updates, ways):
        update = without_undeclared(parts, update)
        if way is not None or reader is writer:
            reader = PlanSolver(program, **OPTIONS)
            reader.restore(readings(writer, old)[way or 0])
            assert reader.snapshot == writer.snapshot
            old = writer.log, cut(writer)
        satisfiable, answers, horizon, ignored = reference.update(update)
        result, its = writer.update(update), reader.update(update)
        check(result, its)
        assert texts(result) == answers, (parts.text(), list(map(str, updates)), str(update))
        assert len(result.answers) == len(answers)
        assert (result.outcome is SolveOutcome.SATISFIABLE) == satisfiable
        if result.permanent or its.permanent:
            return
        assert result.horizon == horizon
        assert sum("declared external" in warning for warning in result.warnings) <= ignored
        if not satisfiable:
            reference.end_at(writer.horizon)
        assert writer.horizon == reader.horizon == reference.horizon
        check_grounding(writer, reference)


PAST = st.one_of(
    st.builds(lambda step: CloseCycles(step, step), st.integers(1, 3)),
    st.builds(Expire, st.integers(1, 3)),
    st.builds(Withdraw, HEADS),
)


@pytest.mark.slow
@settings(max_examples=settings.default.max_examples * 2 // 3)
@given(
    LOOPING,
    st.lists(st.tuples(LOOPING_UPDATES, st.lists(PAST, max_size=2)), min_size=2, max_size=6),
    st.sampled_from([True, False, False, False, False]),
    st.data(),
)
def test_restored_history_continues_as_before(parts, updates, in_worker, data):
    """Also with closed cycles, steps that are over, and withdrawals; in other solvers and in a worker."""
    program, options = ReactiveProgram.from_text(parts.text()), {"models": 0, "log_limit": 3}
    solver, played = PlanSolver(program, **options), []
    for update, past in updates:
        update = replace(update, items=(*past, *update.items))
        played.append((solver.log, update, solver.update(update)))
        if played[-1][-1].permanent:
            break
    log, update, result = data.draw(st.sampled_from(played))
    with WorkerPool(program, shortest=True, **options) if in_worker else nullcontext() as pool:
        for reader in (solver, PlanSolver(program, **options), *([ProcessSolver(pool)] if pool else [])):
            reader.restore(log if reader is solver else copied(log))
            check(result, reader.update(update))
            assert text_of(reader.log) == text_of(solver.log)


# ---- Entries ---------------------------------------------------------------------------------------------------------


def accepted(text, horizon=1):
    return AcceptedUpdate(parse_update(f"{text} #endstep."), horizon)


ONE, TWO, THREE = (accepted(f"#over {step}.") for step in (1, 2, 3))


def test_history_key_does_not_depend_on_checkpoints():
    log, plan = History().with_entries(ONE, TWO, THREE), Plan(frozenset(), 1)
    first = History().with_entries(ONE).checkpoint(Snapshot()).with_entries(TWO)
    second = first.checkpoint(Snapshot(step=2)).adopt(plan).with_entries(THREE)
    assert log.key == second.key == copied(second).key == History().with_entries(*second.entries).key
    others = [History(), first, first.with_entries(ONE), History().with_entries(TWO, ONE, THREE)]
    assert log.key not in [one.key for one in others]
