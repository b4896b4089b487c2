"""Histories of streams: whoever reads one answers as the solver that wrote it."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from random_streams import LITERALS, RULES, VOLATILE, function
from solver_reference import Parts, ShortestReference
from stream_logs import copied, cut, texts
from stream_play import planner_of, play

from rosoclingo.oclingo import ReactiveProgram, SolveOutcome, fact, parse_atom, parse_update
from rosoclingo.oclingo.progression.lifetimes import FOREVER
from rosoclingo.oclingo.progression.updates import (
    Assert,
    Cumulative,
    Forget,
    Literal,
    Over,
    Retract,
    Statement,
    StreamUpdate,
    Volatile,
)
from rosoclingo.planning.history import (
    Checkpoint,
    Close,
    History,
    Plan,
    Taken,
    Withdrawal,
    entry_to_message,
    key_after,
)
from rosoclingo.planning.snapshot import Snapshot, Told
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.planning.workers import pool
from rosoclingo.planning.workers.pool import WorkerPool
from rosoclingo.planning.workers.worker import Worker

PROGRAM = """
#cumulative t.
#external e(t).
#volatile t.
"""
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
PARTS = st.builds(
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
STEPS = st.integers(1, 3)
HEADS = st.sampled_from([function(name, 1) for name in "exy"] + [function("e", 2), function("f", "x", 1)])
ATOMS = st.one_of(HEADS, HEADS, st.builds(lambda name, step: function(name, step), st.sampled_from("cdw"), STEPS))
SUPPORTS = st.one_of(ATOMS.map(Literal), ATOMS.map(Literal), ATOMS.map(Literal), LITERALS)
STATEMENTS = st.one_of(
    st.builds(Statement, HEADS, SUPPORTS.map(lambda one: (one,))),
    st.builds(Statement, HEADS, SUPPORTS.map(lambda one: (one,))),
    st.builds(Statement, HEADS, st.lists(SUPPORTS, max_size=2).map(tuple)),
    st.builds(Statement, st.none(), st.lists(LITERALS, min_size=1, max_size=2).map(tuple)),
)
TERMS = st.sampled_from([function("u"), function("v")])
ITEMS = st.one_of(
    STATEMENTS,
    STATEMENTS,
    STATEMENTS,
    st.sampled_from([Cumulative(), Volatile(), Volatile(2)]),
    st.builds(Assert, TERMS),
    st.builds(Retract, TERMS),
    st.builds(Forget, STEPS, STEPS),
)
UPDATES = st.builds(StreamUpdate, STEPS, st.integers(0, 2), st.lists(ITEMS, max_size=4).map(tuple))


def same_log(writer, old, reader):
    """Go on from a history, or back to it."""
    reader.restore(writer.log)


def text_of_log(writer, old, reader):
    """Read a history on disk."""
    reader.restore(copied(writer.log))


def checkpoint(writer, old, reader):
    """Read nothing but the last snapshot."""
    reader.restore(cut(writer))


def checkpoint_and_rest(writer, old, reader):
    """Read what followed an ``old`` history, from its snapshot on."""
    reader.restore(old)
    rest = writer.log.since(old)
    reader.restore(copied(writer.log if rest is None else cut(reader).then(*rest)))


def entry_by_entry(writer, old, reader):
    """Read every entry as it comes."""
    for entry in writer.log.entries:
        reader.restore(copied(reader.log.then(entry)))
        reader.read()


WAYS = [same_log, text_of_log, checkpoint, checkpoint_and_rest, entry_by_entry]


@pytest.fixture(scope="module")
def lent():
    """One worker for all pools of this module, one after the other: most of the time goes into starting one."""
    workers = []

    def borrow(load):
        if workers:
            workers[0].begin(load)
        else:
            workers.append(Worker(load))
        return workers[0]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pool, "Worker", borrow)
        patch.setattr(Worker, "kill", Worker.abandon)
        yield
    for one in workers:
        one.kill()


OPTIONS = {"models": 0, "log_limit": 3, "idles": False}


def check(mine, its):
    """Two solvers have given the same result, though one may know already that it stays so for ever."""
    assert texts(mine) == texts(its)
    assert mine.outcome is its.outcome
    if not (mine.permanent or its.permanent):
        assert (mine.horizon, mine.step, set(mine.warnings)) == (its.horizon, its.step, set(its.warnings))


@pytest.mark.slow
@given(PARTS, st.lists(UPDATES, min_size=1, max_size=6), st.lists(st.sampled_from([None, *WAYS]), min_size=6))
def test_reader_answers_as_writer_and_reference(lent, parts, updates, ways):
    """``ways`` tell how new readers, here and in another process, begin before each update; None: those there are."""
    reference, old = ShortestReference(parts), History()
    program = ReactiveProgram.from_text(parts.text())
    with WorkerPool(program, shortest=True, **OPTIONS) as process:
        writer = reader = PlanSolver(program, **OPTIONS)
        for update, way in zip(updates, ways):
            if way is not None or reader is writer:
                reader, there = PlanSolver(program, **OPTIONS), process.solver()
                (way or same_log)(writer, old, reader)
                there.restore(writer.log)
                assert reader.snapshot == writer.snapshot
                old = writer.log
            satisfiable, answers, horizon, _ = reference.update(update)
            result, its, theirs = (solver.update(update) for solver in (writer, reader, there))
            check(result, its)
            check(result, theirs)
            assert texts(result) == answers, (parts.text(), str(update))
            assert (result.outcome is SolveOutcome.SATISFIABLE) == satisfiable
            if result.permanent or its.permanent or theirs.permanent:
                return
            assert result.horizon == horizon
            assert writer.horizon == reader.horizon == there.horizon
            if not satisfiable:
                reference.end_at(writer.horizon)


@pytest.mark.slow
@given(PARTS, st.lists(UPDATES, min_size=2, max_size=4), st.data())
def test_earlier_history_leads_on_as_at_first(parts, updates, data):
    """With closed cycles, steps that are over, and withdrawals."""
    program = ReactiveProgram.from_text(parts.text())
    solver, logs = PlanSolver(program, models=0, log_limit=3), []
    for update in updates:
        for entry in data.draw(st.lists(LOOSE, max_size=1)):
            solver.restore(solver.log.then(entry))
        before = solver.log
        logs.append((before, update, solver.update(update)))
        if logs[-1][-1].permanent:
            break
    log, update, result = data.draw(st.sampled_from(logs))
    for reader in (solver, PlanSolver(program, models=0)):
        reader.restore(log if reader is solver else copied(log))
        check(result, reader.update(update))


LOOSE = st.one_of(
    st.builds(Close, STEPS, st.just(frozenset())),
    st.builds(Over, STEPS),
    st.builds(Withdrawal, st.sets(HEADS, min_size=1, max_size=2).map(frozenset)),
)


@pytest.mark.slow
def test_another_process_reads_and_writes_the_same_history():
    program = ReactiveProgram.from_text("#cumulative t. #external e(t). { c(t) } :- e(t). #volatile t. :- not c(t).")
    here = PlanSolver(program, models=0, log_limit=3)
    with WorkerPool(program, shortest=True, models=0, log_limit=3) as process:
        for step in range(1, 12):
            there = process.solver()
            there.restore(here.log if step % 2 else copied(here.log))
            update = parse_update(f"#step {step} : 0. e({step}). #endstep.")
            mine, its = here.update(update), there.update(update)
            assert texts(mine) == texts(its)
            assert there.log.text() == here.log.text()
            here.restore(there.log)


def test_text_of_a_history():
    log = History().then(
        Taken(None, 1),
        Taken(parse_update("#step 2 : 3. e(2). #volatile. :- not c(2). #endstep."), 4),
        Close(2, frozenset([parse_atom("_action_lib(go,1,2)")])),
        Over(1),
        Withdrawal(frozenset([parse_atom('e("a b")')])),
    )
    assert log.text().splitlines() == [
        '{"do":"update","update":null,"horizon":1}',
        '{"do":"update","update":"#step 2 : 3.\\ne(2).\\n#volatile.\\n:- not c(2).\\n#end step.\\n","horizon":4}',
        '{"do":"close","cycle":2,"executed":"_action_lib(go,1,2)"}',
        '{"do":"forget","step":1}',
        '{"do":"withdraw","facts":"e(\\"a b\\")"}',
    ]
    assert copied(log).entries == log.entries
    assert copied(log).key == log.key != log.before.key
    assert (log.step, log.horizon, log.length) == (2, 4, 5)
    assert str(log.update).startswith("#step 2")
    assert log.last is log.before.before.before
    assert History().last is None
    assert History().text() == ""


def leads(log):
    return log.step, log.horizon, log.over, log.length


def taken(text, horizon):
    return Taken(parse_update(f"{text} #endstep."), horizon)


def test_step_and_horizon_after_each_entry():
    """Step, horizon, what is over; and the number of entries since the last checkpoint."""
    log = History()
    assert leads(log) == (1, 1, 0, 0)
    for entry, there in (
        (Over(4), (1, 1, 4, 1)),
        (Over(2), (1, 1, 4, 2)),
        (taken("#step 5. #over 3.", 7), (5, 7, 4, 3)),
        (taken("#over 6. #over 1.", 8), (5, 8, 6, 4)),
        (Taken(None, 9), (5, 9, 6, 5)),
        (Close(5, frozenset()), (5, 9, 6, 6)),
        (taken("#anew.", 1), (1, 1, 0, 7)),
        (taken("#step 3. #anew. #over 2.", 4), (3, 4, 2, 8)),
        (Checkpoint(Snapshot(step=7, horizon=8, keep_from=6)), (7, 8, 6, 0)),
        (Over(7), (7, 8, 7, 1)),
    ):
        log = log.then(entry)
        assert leads(log) == there, entry
    assert leads(copied(log)) == leads(log)


def entries_kept(log):
    found = []
    while log is not None:
        found.append(log.entry)
        log = log.before
    return found


def test_cut_drops_entries_before_the_last_checkpoint_but_one():
    first, second = (Checkpoint(Snapshot(step=step, horizon=step)) for step in (1, 2))
    entries = [Over(1), first, Over(2), second, Over(3)]
    whole = History().then(*entries)
    assert entries_kept(History().then(*entries[:3]).cut()) == [Over(2), first, Over(1), None]
    assert entries_kept(whole.cut()) == [Over(3), second, Over(2), first]
    assert whole.entries == [second, Over(3)]
    assert whole.key == History().then(second, Over(3)).key, "it says where the checkpoint and the rest lead"


def test_key_depends_on_entries_since_the_checkpoint_alone():
    many = frozenset(parse_atom(f"e({number})") for number in range(30))
    checkpoint = Checkpoint(Snapshot())
    for entry, name in ((Close(1, many), "executed"), (Withdrawal(many), "facts")):
        assert entry_to_message(entry)[name] == ",".join(f"e({number})" for number in range(30))
        first, second = History().then(Over(1), entry), History().then(Over(2), entry)
        assert first.key != second.key
        keys = {key_after(log.key, entry_to_message(checkpoint)) for log in (History(), first, second)}
        assert keys == {first.then(checkpoint).key} == {second.then(checkpoint).key}


def test_entries_since_an_earlier_history():
    log = History()
    longer = log.then(Over(1), Over(2))
    assert longer.since(longer) == []
    assert longer.since(longer.before) == [Over(2)]
    assert longer.since(log) == longer.entries == [Over(1), Over(2)]
    assert log.since(longer) is None
    assert longer.since(History()) is None, "they begin alike, but it may be another stream's"
    assert log.without(frozenset()) is log
    facts = frozenset([parse_atom("e(1)")])
    assert log.without(facts).entries == [Withdrawal(facts)]


def test_last_update_skips_entries_without_one():
    log = History().then(Taken(None, 1), Over(1))
    assert (log.last, log.update) == (None, None)
    told = log.then(taken("#step 2. e(2).", 2))
    assert told.last is told
    for longer in (told, told.then(Close(2, frozenset())), told.then(Taken(None, 3), Over(2))):
        assert longer.last is told
        assert str(longer.update) == str(parse_update("#step 2. e(2). #endstep."))


def test_plan_has_the_actions_of_known_cycles():
    names = ["_action_lib(go,1,3)", "_action_lib(go,2,2)", "_action_lib(go,2,soon)", "_action_lib(go,2)", "at(1,2,3)"]
    plan = Plan.of(map(parse_atom, names), 4)
    assert plan == Plan(frozenset(map(parse_atom, names[:2])), 4, shortest=False)
    assert (plan.last_cycle, Plan(frozenset(), 4).last_cycle < -1000) == (3, True)
    assert plan.since(3).actions == {parse_atom(names[0])}
    assert plan.since(2) == plan
    moved = {parse_atom("_action_lib(go,1,4)"), parse_atom("_action_lib(go,2,3)")}
    assert plan._replace(shortest=True).later() == Plan(frozenset(moved), 5)


def reader_of(solver):
    """Another solver that reads the text of its history."""
    reader = PlanSolver(solver.program, models=solver.models)
    reader.restore(copied(solver.log))
    return reader


def test_earlier_history_knows_nothing_of_later_updates():
    solver = planner_of("{ a }. #cumulative t. #external e(t). #volatile t.", models=0, idles=False)
    play(solver, "#step 1. e(1).")
    log = solver.log
    assert texts(play(solver, "#step 2. e(2). :- a.")) == {frozenset(["e(1)", "e(2)"])}
    solver.restore(log)
    assert texts(solver.solve()) == {frozenset(["e(1)"]), frozenset(["a", "e(1)"])}


def test_history_of_an_interrupted_update_has_the_update():
    writer = planner_of(PROGRAM)
    update = parse_update("#step 9 : 0. e(2). e(9). #endstep.")
    assert writer.update(update, lambda: True).outcome is SolveOutcome.INTERRUPTED
    reader = reader_of(writer)
    assert reader.snapshot == writer.snapshot
    assert (reader.step, reader.horizon) == (9, 9)
    assert texts(reader.solve()) == texts(writer.solve()) == {frozenset(["e(2)", "e(9)"])}


def test_reader_forgets_up_to_the_horizon_of_the_writer():
    writer = planner_of(PROGRAM + ":- t < 4.")
    assert play(writer, "#step 2 : 2. #forget 1..2.").horizon == 4
    reader = reader_of(writer)
    assert (reader.snapshot.horizon, reader.horizon) == (4, 4)
    for solver in (writer, reader):
        result = play(solver, "e(1). e(2). e(3).")
        assert texts(result) == {frozenset(["e(3)"])}
        assert [warning.split()[1] for warning in result.warnings] == ["e(1)", "e(2)"]


@pytest.mark.parametrize(("atoms", "longer"), [(0, True), (299, True), (300, False)])
def test_large_snapshots_have_fewer_checkpoints(atoms, longer):
    log = History().then(Over(1), Over(2), Over(3))
    snapshot = Snapshot(told=tuple(Told(fact(parse_atom(f"e({number})")), FOREVER, 1) for number in range(atoms)))
    assert log.is_longer(2, snapshot) is longer
    assert not log.is_longer(3, snapshot)


def test_facts_wait_for_their_step_in_a_reader_as_well():
    solver = planner_of(PROGRAM, idles=False)
    play(solver, "#step 1 : 0. e(3).")
    solver.restore(copied(solver.log))
    for step, answer in ((1, set()), (2, set()), (3, {"e(3)"})):
        assert texts(play(solver, f"#step {step} : 0.")) == {frozenset(answer)}


def test_strings_of_oclingo_survive_a_checkpoint():
    text = '#external said/1. heard(X) :- said(X). known :- said("a b"). #cumulative t.'
    solver = planner_of(text, models=0, oclingo_strings=True)
    play(solver, 'said("a b"). said(f("x",1)).')
    answers = texts(solver.solve())
    solver.restore(cut(solver))
    assert texts(solver.solve()) == answers
    assert len(answers) == 1
    solver = planner_of(text, models=0)
    play(solver, 'said("a b"). said(f("x",1)).')
    solver.restore(cut(solver))
    (answer,) = texts(solver.solve())
    assert answer == {'said("a b")', 'said(f("x",1))', 'heard("a b")', 'heard(f("x",1))', "known"}


def test_history_keeps_the_last_two_checkpoints_and_no_more():
    solver = planner_of(PROGRAM, log_limit=4)
    first = solver.log
    lengths, kept = [], []
    for step in range(1, 31):
        play(solver, f"#step {step} : 0. #forget {step}.")
        lengths.append(solver.log.length)
        log, nodes = solver.log, 0
        while log is not None:
            log, nodes = log.before, nodes + 1
        kept.append(nodes)
        assert solver.log.update.step == step
        assert solver.log.last.before is not None
    assert max(lengths) == 4, "then there is a checkpoint"
    assert max(kept) <= 13
    assert solver.log.since(first) is None
    assert isinstance(solver.log.entries[0], Checkpoint)
