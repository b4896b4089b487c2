"""Solvers in a process of their own: the same answers, whatever becomes of the process."""

import json
import os
import random
import signal
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import pytest
from children import ended, kill
from core_journal import Journal
from plain_walk import RUN
from shipped import shipped

from rosoclingo.oclingo import (
    DroppedError,
    ProgramError,
    ReactiveProgram,
    ReactiveSolver,
    SolveOutcome,
    SolverError,
    parse_atom,
    parse_update,
)
from rosoclingo.planning.compaction import SHOWN_STEPS
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.planning.workers import child as child_module
from rosoclingo.planning.workers.child import WorkerProcess
from rosoclingo.planning.workers.pool import WorkerPool
from rosoclingo.reasoning import Core, CoreSettings, GoalChanged, Halt, Outcome

DATA = Path(__file__).parents[3] / "data"
CASES = json.loads((DATA / "oclingo_golden.json").read_text(encoding="utf-8"))

ECHO = "#cumulative t.\n#external e(t).\nc(t) :- e(t).\n"
ENDLESS = ECHO + "#volatile t.\n:- not c(t).\n"
#: Grounding of step 2 has no end.
EXPLODING = "#cumulative t.\n#external e(t).\nn(0,t) :- t > 1.\nn(X+1,t) :- n(X,t), X < 2000000000.\n"
#: Grounding a fact big(1) takes some tenths of a second, and every step of it can be seen by all.
HEAVY = "#external big/1.\nn(1..300000,B) :- big(B).\n#show big/1.\n"
#: The same, but for every step; blocks of steps are ground one after the other.
IN_PIECES = "#external big/1.\n#cumulative t.\nn(t) :- big(B), X = 1..20000, X * t == 19999 * t.\n"


@pytest.fixture(scope="module")
def echo():
    with WorkerPool(ReactiveProgram.from_text(ECHO), models=0) as process:
        process.start()
        yield process


def process_of(text, **options):
    return WorkerPool(ReactiveProgram.from_text(text), **options)


def atoms(result):
    return [sorted(map(str, answer)) for answer in result.answers]


def at_look(number):
    """A stop request from the look of that number on."""
    looks = []

    def stopped():
        looks.append(None)
        return len(looks) >= number

    return stopped


def after_work(process, seconds=0.1):
    """A stop request once the child has worked for so long: it is in the midst of what it was asked for."""
    before = process.worked
    return lambda: process.worked > before + seconds


@pytest.mark.slow
@pytest.mark.parametrize("case", [case for case in CASES if len(case["updates"]) > 2], ids=lambda case: case["name"])
def test_answers_are_those_of_a_solver_in_this_process(case):
    program = ReactiveProgram.from_text(case["program"])
    here = ReactiveSolver(program, models=0)
    with WorkerPool(program, models=0) as process:
        there = process.solver()
        for update in case["updates"]:
            expected, found = here.update(parse_update(update["update"])), there.update(parse_update(update["update"]))
            assert sorted(atoms(found)) == sorted(atoms(expected))
            assert (found.outcome, found.horizon, found.step) == (expected.outcome, expected.horizon, expected.step)
            assert (found.warnings, found.permanent) == (expected.warnings, expected.permanent)
            assert (there.horizon, there.step) == (here.horizon, here.step)


@pytest.mark.slow
def test_a_solver_that_is_killed_starts_again_where_it_was(echo):
    solver = echo.solver()
    solver.update(parse_update("#step 1. e(1). #endstep."))
    kill(echo)
    result = solver.update(parse_update("#step 2. e(2). #endstep."))
    assert atoms(result) == [["c(1)", "c(2)", "e(1)", "e(2)"]]


@pytest.mark.slow
def test_what_is_asked_for_when_the_process_dies_is_dropped():
    with process_of(ENDLESS) as process:
        solver = process.solver()
        solver.update(parse_update("#step 1 : 0. e(1). #endstep."))

        def stopped():
            kill(process)
            return False

        with pytest.raises(DroppedError, match="ended by signal SIGKILL; what it was asked for was dropped"):
            solver.update(parse_update("#step 2. #endstep."), stopped)
        assert atoms(solver.update(parse_update("#step 1 : 0. #endstep."))) == [["c(1)", "e(1)"]]


@pytest.mark.slow
def test_a_worker_that_crashes_costs_time_alone():
    with process_of(ENDLESS) as process:
        solver, killed = process.solver(), []

        def stopped():
            if not killed:
                killed.append(process.pid)
                kill(process)
            return solver.reached > 3

        result = solver.update(parse_update("#step 1. #endstep."), stopped)
        assert (result.outcome, process.pid != killed[0]) == (SolveOutcome.INTERRUPTED, True)
        assert solver.step == 1
        late = solver.update(parse_update(f"#step {result.horizon} : 0. e({result.horizon}). #endstep."))
        assert late.outcome is SolveOutcome.SATISFIABLE


@pytest.mark.slow
def test_a_stop_ends_a_search_and_leaves_the_update_in_force():
    with process_of(ENDLESS, patience=600.0, grace=600.0) as process:
        solver = process.solver()
        solver.update(parse_update("#step 1 : 0. #endstep."))
        pid = process.pid
        result = solver.update(parse_update("#step 1. #endstep."), after_work(process))
        assert result.outcome is SolveOutcome.INTERRUPTED
        assert process.pid == pid, "it heeded the stop"
        assert result.horizon == solver.horizon > 1
        late = solver.update(parse_update(f"#step {result.horizon} : 0. e({result.horizon}). #endstep."))
        assert late.outcome is SolveOutcome.SATISFIABLE


@pytest.mark.slow
def test_how_far_a_search_is_can_be_seen_in_its_midst():
    with process_of(ENDLESS) as process:
        for solver in (process.solver(), ReactiveSolver(ReactiveProgram.from_text(ENDLESS))):
            result = solver.update(parse_update("#step 1. #end step."), lambda solver=solver: solver.reached > 3)
            assert result.outcome is SolveOutcome.INTERRUPTED
            assert solver.reached == solver.horizon == result.horizon > 3
            solver.update(parse_update("#step 2 : 1. #end step."))
            assert solver.reached == solver.horizon


@pytest.mark.slow
def test_a_stop_ends_grounding_and_drops_the_update():
    with process_of(EXPLODING, patience=0.1) as process:
        solver = process.solver()
        solver.update(parse_update("#step 1. e(1). #endstep."))
        pid = process.pid
        with pytest.raises(DroppedError, match="did not heed a stop, since it was grounding"):
            solver.update(parse_update("#step 2. e(2). #endstep."), after_work(process))
        assert process.pid != pid
        assert (solver.step, solver.horizon) == (1, 1)
        assert atoms(solver.update(parse_update("#step 1. #endstep."))) == [["e(1)"]]


@pytest.mark.slow
def test_the_work_of_all_children_is_counted():
    with process_of(EXPLODING, patience=0.1) as process:
        solver, elapsed = process.solver(), process.stopwatch()
        solver.update(parse_update("#step 1. e(1). #endstep."))
        before = process.worked
        assert before > 0.0
        with pytest.raises(DroppedError):
            solver.update(parse_update("#step 2. e(2). #endstep."), after_work(process))
        assert process.worked > before + 0.1, "what was ended has worked as well"
        assert elapsed() > 0.1


@pytest.mark.slow
def test_a_grounding_in_pieces_is_dropped_between_them():
    with process_of(IN_PIECES, patience=600.0, grace=0.0) as process:
        solver = process.solver()
        wanted = sorted(["big(1)", *(f"n({step})" for step in range(1, 321))])
        solver.update(parse_update("#step 320. #endstep."))
        pid = process.pid
        with pytest.raises(DroppedError, match="stopped while the program was grounded again"):
            solver.update(parse_update("#step 320. big(1). #endstep."), after_work(process))
        assert atoms(solver.update(parse_update("#step 320. #endstep."))) == [[]], "the update was dropped as a whole"
        assert atoms(solver.update(parse_update("#step 320. big(1). #endstep."))) == [wanted]
        assert process.pid == pid


@pytest.mark.slow
def test_a_short_grounding_comes_to_its_end():
    with process_of(IN_PIECES, patience=600.0, grace=600.0) as process:
        solver = process.solver()
        solver.update(parse_update("#step 320. #endstep."))
        pid = process.pid
        assert solver.update(parse_update("#step 320. big(1). #endstep."), after_work(process)).step == 320
        assert "big(1)" in atoms(solver.update(parse_update("#step 320. #endstep.")))[0]
        assert process.pid == pid


@pytest.mark.slow
def test_a_process_that_is_lost_is_replaced_by_one_kept_ready():
    with process_of(EXPLODING, patience=0.1, spare=True) as process:
        solver = process.solver()
        process.start()
        assert process.spare_pid is None, "one starts after the other"
        for cycle in range(3):
            solver.update(parse_update(f"#step 1. {'e(1).' if cycle == 0 else ''} #endstep."))
            lost, spare = process.pid, process.spare_pid
            assert spare is not None
            with pytest.raises(DroppedError):
                solver.update(parse_update("#step 2. #endstep."), after_work(process))
            assert ended(lost)
            assert (process.pid, process.spare_pid) == (spare, None)
        assert atoms(solver.update(parse_update("#step 1. #endstep."))) == [["e(1)"]]
        spare = process.spare_pid
    assert ended(spare)


@pytest.mark.slow
def test_the_process_kept_ready_may_be_lost_as_well():
    with process_of(ECHO, spare=True) as process:
        solver = process.solver()
        solver.update(parse_update("#step 1. e(1). #endstep."))
        spare = process.spare_pid
        for pid in (process.pid, spare):
            os.kill(pid, signal.SIGKILL)
            assert ended(pid)
        assert atoms(solver.update(parse_update("#step 2. #endstep."))) == [["c(1)", "e(1)"]]
        assert process.spare_pid not in (None, spare)
        os.kill(process.spare_pid, signal.SIGKILL)
        assert ended(process.spare_pid)
        solver.update(parse_update("#step 3. #endstep."))
        assert Path(f"/proc/{process.spare_pid}").exists(), "there is another one after the next answer"


@pytest.mark.slow
@pytest.mark.once
@pytest.mark.parametrize("files", [["mailbot.lp", "office.lp"], ["house.lp", "home.lp"]], ids=["office", "house"])
def test_stops_at_any_time_cost_no_process_with_our_encodings(files, monkeypatch):
    monkeypatch.setattr(child_module, "GROWTH", 2**60)  # none is replaced for its size
    chance, speed, looks = random.Random(3), random.Random(3), [0]
    program = shipped(*files)

    def watch():
        """Every other search is left for something that has come, at some time or other."""
        looks[0] = speed.choice([1, 1, 20, 30, 50, 10**9, 10**9])

        def look():
            looks[0] -= 1
            return Halt("a goal was cancelled", disturbed=True) if looks[0] <= 0 else None

        return look

    journal = Journal()
    with WorkerPool(program, patience=600.0, grace=0.0, shortest=True, oclingo_strings=False) as process:
        process.start()
        core = Core(program, process.solver, journal, CoreSettings(), watch)
        core.start()
        pid, number = process.pid, 0
        while core.cycle < 40:
            if len(core.live_goals) < 2:
                number += 1
                rooms = chance.sample(["kitchen", "study", "bedroom", "hallway"], 2)
                house = f"bring({rooms[0]},{chance.choice(['cup', 'book', 'tray', 'towel'])})"
                office = f"goal(office{number % 4 + 1},office{(number + 1) % 4 + 1},{number})"
                core.add_goal(str(number), office if "office.lp" in files else house)
                unwanted = chance.random() < 0.2 and str(number)  # so many of the goals, however often a search is left
            elif unwanted in [goal.key for goal in core.live_goals]:
                core.cancel_goal(unwanted)
                unwanted = None
            core.advance(0.0)
            for action in core.awaited:
                core.receive("test", [f"_return({action.interface},{action.parameter},{action.cycle})"])
        assert process.pid == pid
    outcomes = [event.outcome for event in journal.of(GoalChanged) if event.outcome is not None]
    assert outcomes.count(Outcome.SUCCEEDED) > len(outcomes) / 2
    assert Outcome.ABORTED not in outcomes, "what was not cancelled was met"
    assert any("the search was left" in problem for problem in journal.problems)


@pytest.mark.slow
def test_a_stop_while_the_process_is_rebuilt_lets_it_go_on():
    with process_of(HEAVY, patience=600.0, grace=600.0) as process:
        solver = process.solver()
        solver.update(parse_update("#step 1. big(1). #endstep."))
        kill(process)
        with pytest.raises(DroppedError, match="stopped before the solver was ready"):
            solver.update(parse_update("#step 2. #endstep."), lambda: True)
        pid = process.pid
        with suppress(DroppedError):
            solver.update(parse_update("#step 2. #endstep."), at_look(3))
        assert atoms(solver.update(parse_update("#step 2. #endstep."))) == [["big(1)"]]
        assert process.pid == pid, "a stop did not begin it anew"


def test_solvers_share_a_process_and_nothing_else(echo):
    one, other = echo.solver(), echo.solver()
    one.update(parse_update("#step 1. e(1). #endstep."))
    assert atoms(other.update(parse_update("#step 1. #endstep."))) == [[]]
    assert atoms(one.update(parse_update("#step 2. #endstep."))) == [["c(1)", "e(1)"]]


def test_going_back(echo):
    solver = echo.solver()
    solver.update(parse_update("#step 1. e(1). #endstep."))
    before = solver.log
    solver.update(parse_update("#step 3. e(2). #endstep."))
    solver.restore(before)
    assert (solver.step, solver.horizon) == (1, 1)
    assert atoms(solver.update(parse_update("#step 2. #endstep."))) == [["c(1)", "e(1)"]]
    other = echo.solver()
    other.restore(before.less(frozenset([parse_atom("e(1)")])))
    assert atoms(other.update(parse_update("#step 2. #endstep."))) == [[]]


#: ``_until(T)`` puts an answer off to horizon T.
LATER = "#external _until/1.\n#program volatile(t).\n:- _until(T), t < T.\n"


@pytest.mark.slow
def test_what_was_answered_beyond_its_bound_is_taken_again():
    with process_of(LATER, shortest=True) as process:
        solver = process.solver()
        solver.update(parse_update("#step 1 : 8. #volatile. _until(3). #endstep."))
        assert solver.update(parse_update("#step 2 : 1. #volatile. _until(7). #endstep.")).horizon == 7
        pid = process.pid
        os.kill(pid, signal.SIGKILL)
        assert ended(pid)
        assert solver.update(parse_update("#step 3 : 5. #endstep.")).horizon == 3


def test_a_refused_update_changes_nothing():
    with process_of(ECHO, horizon_limit=3) as process:
        solver = process.solver()
        solver.update(parse_update("#step 1. e(1). #endstep."))
        with pytest.raises(SolverError, match="step 4 is beyond the horizon limit 3"):
            solver.update(parse_update("#step 4. #endstep."))
        assert atoms(solver.update(parse_update("#step 2. #endstep."))) == [["c(1)", "e(1)"]]


def test_a_program_whose_faults_show_in_the_child_only(tmp_path):
    file = tmp_path / "part.lp"
    file.write_text("#program base.\na.\n", encoding="utf-8")
    program = ReactiveProgram.from_text(f'#include "{file}".\n' + ECHO)
    file.unlink()
    with WorkerPool(program) as process, pytest.raises(ProgramError, match=r"part\.lp"):
        process.start()


def test_a_closed_process_is_told():
    process = process_of(ECHO)
    process.close()
    with pytest.raises(SolverError, match="has been closed"):
        process.solver().solve()


def test_a_stop_at_the_start():
    with process_of(ECHO) as process:
        with pytest.raises(DroppedError):
            process.start(lambda: True)
        assert process.solver().solve().outcome is SolveOutcome.SATISFIABLE


@pytest.mark.slow
def test_a_child_ends_with_its_parent_even_while_it_grounds():
    code = (
        "import sys\nfrom rosoclingo.oclingo import *\n"
        "from rosoclingo.planning.workers.pool import WorkerPool\n"
        f"process = WorkerPool(ReactiveProgram.from_text({EXPLODING!r}))\nprocess.start()\n"
        "looks = []\n"
        "def stopped():\n    looks.append(0)\n    len(looks) == 9 and print(process.pid, flush=True)\n"
        "process.solver().update(parse_update('#step 2. #endstep.'), stopped)\n"
    )
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) as parent:
        child = int(parent.stdout.readline())
        parent.kill()
    assert ended(child), "the child outlived its parent"


def goes(solver, cycle, before):
    """One cycle of a robot that is asked to go here and there; return its action, if there is one."""
    text = "" if before is None else f"#closed {cycle - 1}. #over {max(0, cycle - 10)}. "
    text += "".join(f":- not {atom}. " for atom in before or ())
    text += f"_request({cycle % 5 - 2},{cycle + 1}). " if cycle % 7 == 0 else ""
    answer = solver.update(parse_update(f"#step {cycle}. {text}#endstep.")).answers[0]
    return [atom for atom in answer if atom.name == "_action_lib" and atom.arguments[2].number == cycle], answer


@pytest.mark.once
@pytest.mark.slow
def test_a_long_stream_goes_on_from_a_state_not_from_its_start():
    here = PlanSolver(ReactiveProgram.from_text(RUN))
    with process_of(RUN, shortest=True, oclingo_strings=False) as process:
        there = process.solver()
        mine, its = None, None
        for cycle in range(1, 91):
            mine, answer = goes(here, cycle, mine)
            its, other = goes(there, cycle, its)
            if cycle in (40, 75):
                os.kill(process.pid, signal.SIGKILL)
                assert ended(process.pid)
        assert len(there.log.entries) < 60
        # 84 asked to go to 84 % 5 - 2, which is done by now; what was shown of retired steps is still told
        assert parse_atom("at(2,90)") in answer & other
        shown = {atom.arguments[1].number for atom in other if atom.name == "at"} - {0}  # which base holds
        assert shown >= set(range(min(shown), 91))
        assert min(shown) <= 90 - SHOWN_STEPS


@pytest.mark.once
@pytest.mark.slow
def test_states_that_come_with_searches_lead_back_whatever_ends_the_child():
    with process_of(RUN, shortest=True, oclingo_strings=False, horizon_limit=100, log_limit=2) as process:
        solver = process.solver()
        done, now = [], None
        for cycle in range(1, 25):
            now, answer = goes(solver, cycle, now)
            past = [atom for atom in answer if atom.name == "_action_lib" and atom.arguments[2].number < cycle]
            assert set(past) == set(done), "what was executed, and no more"
            done += now
            before = solver.log
            if cycle % 3 == 0:
                kill(process)
            if cycle % 4 == 0:
                with pytest.raises(SolverError, match="beyond the horizon limit"):
                    solver.update(parse_update("#step 101. #endstep."))
                assert solver.log is before
        assert len(done) >= 3
        assert len(before.entries) <= 4


@pytest.mark.slow
def test_the_state_of_a_search_that_was_ended_has_its_update():
    options = {"shortest": True, "oclingo_strings": False, "horizon_limit": 100_000, "log_limit": 0}
    with process_of(ENDLESS, patience=600.0, grace=600.0, **options) as process:
        solver = process.solver()
        result = solver.update(parse_update("#step 1. e(1). #endstep."))
        assert atoms(result) == [["c(1)", "e(1)"]]
        result = solver.update(parse_update("#step 2. #endstep."), after_work(process))
        assert (result.outcome, solver.step) == (SolveOutcome.INTERRUPTED, 2)
        (checkpoint,) = solver.log.entries
        assert (checkpoint.snapshot.step, checkpoint.snapshot.horizon) == (2, result.horizon)
        kill(process)
        late = solver.update(parse_update(f"#step {result.horizon} : 0. e({result.horizon}). #endstep."))
        assert late.outcome is SolveOutcome.SATISFIABLE
        reader = PlanSolver(ReactiveProgram.from_text(ENDLESS))
        reader.restore(solver.log)
        assert parse_atom("e(1)") in reader.solve().answers[0]


@pytest.mark.slow
def test_a_child_that_has_grown_is_replaced_between_two_searches(monkeypatch):
    """clingo's terms are never freed: only an end of the process gives the memory back."""
    monkeypatch.setattr(child_module, "GROWTH", 100)
    sizes = iter([100, 190, 201, 300, 440, 451, 99])
    monkeypatch.setattr(WorkerProcess, "memory", property(lambda self: next(sizes)))
    with process_of(ENDLESS, shortest=True, oclingo_strings=False, horizon_limit=100, log_limit=0) as process:
        solver, twin = process.solver(), PlanSolver(ReactiveProgram.from_text(ENDLESS))
        children = []
        for step in range(1, 8):
            children.append(process.pid)
            text = f"#step {step} : 0. e({step}). #endstep."
            assert atoms(solver.update(parse_update(text))) == atoms(twin.update(parse_update(text)))
        # the third look finds more than GROWTH, the sixth more than half of the first at that child
        assert [children.index(child) for child in children] == [0, 0, 0, 3, 3, 3, 6]


def test_the_memory_of_a_child_is_known():
    child = WorkerProcess()
    assert child.memory > 0
    child.kill()
    assert child.memory == 0


def test_answers_leave_out_cycles_that_are_long_over():
    """What was shown long ago is not sent again with each answer; the present is, and what has no cycle."""
    shown = "#program base. named(x). #show named/1. #show c/1. " + ECHO
    with process_of(shown, shortest=True) as process:
        solver = process.solver()
        for step in range(1, 31):
            result = solver.update(parse_update(f"#step {step} : 0. e({step}). #endstep."))
    recent = [f"c({step})" for step in range(30 - SHOWN_STEPS, 31)]
    assert atoms(result) == [sorted([*recent, "named(x)"])]
