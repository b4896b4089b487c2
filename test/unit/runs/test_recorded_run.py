"""The content of a recording, assembled despite messages out of order and missing topics."""

import pytest

from rosoclingo.oclingo import ReactiveProgram, parse_atom
from rosoclingo.planning.history import Plan
from rosoclingo.runs.recorded_run import RecordingError, RunCollector, RunProgram

GO = "_action_lib(go,{0},{0})"


def update(step, items=""):
    return f"#step {step} : 5. {items} #end step."


def program(run, text="a."):
    return RunProgram.of(run, ReactiveProgram.from_text(text), {}).text()


def cycles(collector):
    return [[(one.cycle, len(one.updates), len(one.plans)) for one in run.cycles] for run in collector.runs()]


def test_recorded_run_accepts_topics_out_of_order():
    collector = RunCollector()
    collector.plan(0.0, 1, 1, [])
    collector.dispatched(0.0, [GO.format(1)])
    collector.plan(0.0, 1, 3, [GO.format(1), GO.format(2)])
    collector.program(0.0, program("first"))
    collector.update(0.0, update(1))
    collector.problem(0.0, 2, "it rains")
    collector.plan(0.0, 2, 3, [GO.format(1), GO.format(2)])
    collector.update(0.0, update(2))
    (run,) = collector.runs()
    assert run.program.run == "first"
    assert [one.plans[-1] for one in run.cycles] == [
        Plan(frozenset({parse_atom(GO.format(1)), parse_atom(GO.format(2))}), 3),
        Plan(frozenset({parse_atom(GO.format(2))}), 3),
    ]
    assert [one.dispatched for one in run.cycles] == [[GO.format(1)], None]
    assert [one.problems for one in run.cycles] == [[], ["it rains"]]
    assert run.stream.count("#end step.") == 2


def test_recorded_run_ignores_repeated_and_invalid_actions():
    collector = RunCollector()
    collector.update(0.0, update(1))
    collector.dispatched(0.0, ['_run("x")', GO.format(1), "_cancel(go,1,1)", "no term ("])
    collector.dispatched(0.0, [GO.format(1)])  # sent to a late subscriber
    assert collector.runs()[0].cycles[0].dispatched == [GO.format(1)]


def test_recorded_run_of_restarted_core_is_another_run():
    collector = RunCollector()
    collector.program(0.0, program("first"))
    collector.update(0.0, update(1))
    collector.plan(0.0, 1, 3, [GO.format(1)])
    collector.plan(0.0, 1, 1, [])  # the next core's start message, which arrives before its program
    collector.program(0.0, program("second"))
    collector.program(0.0, program("second"))
    collector.update(0.0, update(1))
    collector.update(0.0, update(2))
    collector.update(0.0, update(1))  # a third core, whose program was not received
    runs = collector.runs()
    assert [run.program and run.program.run for run in runs] == ["first", "second", None]
    assert [[one.cycle for one in run.cycles] for run in runs] == [[1], [1, 2], [1]]
    assert [len(one.plans) for one in runs[0].cycles] == [1]


def test_recorded_run_program_restart_replays_cycles_in_few_steps():
    collector = RunCollector()
    for step in range(1, 130):
        collector.update(0.0, update(step))
    collector.update(0.0, update(100, "#anew. #closed 1..99."))
    collector.update(0.0, update(130, "#closed 100..129."))
    collector.update(0.0, update(131))
    assert cycles(collector)[0][-2:] == [(130, 2, 0), (131, 1, 0)]
    collector = RunCollector()
    collector.update(0.0, update(1, "#anew."))
    assert cycles(collector) == [[(1, 1, 0)]]


@pytest.mark.parametrize(
    ("steps", "text"),
    [
        ([3, 4], "cycles 1 to 2 are missing.*before the first request"),
        ([1, 3], "cycle 2 are missing.*see its notes"),
        ([], "no update of a core"),
    ],
)
def test_recorded_run_reports_missing_topics(steps, text):
    collector = RunCollector()
    collector.program(0.0, program("first"))
    for step in steps:
        collector.update(0.0, update(step))
    with pytest.raises(RecordingError, match=text):
        collector.runs()


def test_recorded_run_reports_an_invalid_update():
    with pytest.raises(RecordingError, match="an update is damaged: 1:5"):
        RunCollector().update(0.0, "step")
