"""Programs of how-to documents, each with the course that its page describes."""

import re
from pathlib import Path

import pytest
from core_driver import Driver, soon
from core_scripts import play, scripts

from rosoclingo.checking.check_command import main
from rosoclingo.oclingo import ProgramError

DOCUMENTS = Path(__file__).resolve().parents[2] / "doc"


def programs(page):
    """Return the programs of a page: its blocks in Prolog's colours."""
    return re.findall(r"```prolog\n(.*?)```", (DOCUMENTS / page).read_text(), re.DOTALL)


SMALLEST = ("own_program.md", 0)
WAITING = ("timing.md", 0)
DEADLINES = ("timing.md", 1)

COURSES = {
    "smallest_visits": (
        SMALLEST,
        """goal 1 visit(kitchen); does move_base,kitchen,1; succeed; is 1 succeeded
        goal 2 visit(study); does move_base,study,...; fail blocked; does move_base,study,...; cancel 2; succeed
        is 2 preempted; goal 3 visit(attic); says 3 ...attic is none of kitchen, study...""",
    ),
    "waiting_for_a_door": (
        WAITING,
        """facts _closed(study,now); goal 1 visit(study); does; is 1 active
        goal 2 visit(kitchen); does move_base,kitchen,...; succeed; is 2 succeeded; is 1 active; does
        facts _opened(study,now); does move_base,study,...; succeed; is 1 succeeded""",
    ),
    "waiting_goal_cancelled": (
        WAITING,
        """facts _closed(study,now); goal 1 visit(study); does; cancel 1; is 1 preempted
        goal 2 visit(study); does; is 2 active""",
    ),
    "deadline_order": (
        DEADLINES,
        """facts _hour(9,now); add 1 visit(kitchen,17,1); add 2 visit(study,10,2); run
        does move_base,study,...; succeed; is 2 succeeded; does move_base,kitchen,...; succeed; is 1 succeeded""",
    ),
    "deadline_missed": (
        DEADLINES,
        """facts _hour(9,now); goal 1 visit(kitchen,10,1); does move_base,kitchen,...; fail blocked
        does move_base,kitchen,...; hear hour_sensor _hour(10,now); fail blocked; is 1 aborted; says 1 ...it is 10 h...
        goal 2 visit(study,10,2); is 2 rejected; says 2 ...it is 10 h already...; does""",
    ),
    "deadline_met_in_time": (
        DEADLINES,
        """facts _hour(9,now); goal 1 visit(kitchen,10,1); does move_base,kitchen,...
        hear hour_sensor _hour(10,now); succeed; is 1 succeeded""",
    ),
}


@scripts(COURSES)
def test_document_programs_run_as_described(row):
    (page, number), script = row
    play(Driver(programs(page)[number], solver=soon), script)


WITHOUT = {
    "cancel": (", not _request(cancel(P),t)", "goal 1 visit(study); fail blocked; cancel 1; does move_base,study,..."),
    "one_action": (
        " } 1.",
        " }.",
        "add 1 visit(study); add 2 visit(kitchen); run; does move_base,kitchen,1 move_base,study,1",
    ),
    "requests": ("#external _request/2.\n", "goal 1 visit(study); says 1 ...it declares no external _request/2..."),
    "failures": (", not failed(t)", "goal 1 visit(study); fail blocked; is 1 succeeded"),
    "constraint": (":- wanted(P,t), not visited(P,t).", "goal 1 visit(study); does; is 1 succeeded"),
}


@scripts(WITHOUT)
def test_document_programs_smallest_program_needs_each_part(row):
    text, *other, script = row
    program = programs(SMALLEST[0])[SMALLEST[1]]
    assert text in program
    play(Driver(program.replace(text, *(other or [""])), solver=soon), script)


def test_document_programs_need_their_parts():
    program = programs(SMALLEST[0])[SMALLEST[1]]
    with pytest.raises(ProgramError, match="has no cumulative part"):
        Driver(program.replace("#program cumulative(t).", "#program base."))
    (warning,) = Driver(program.replace("#program volatile(t).", "#program base.")).program.warnings
    assert "has no volatile part" in warning


@pytest.mark.parametrize(("page", "number"), [SMALLEST, WAITING, DEADLINES])
def test_document_programs_have_no_findings(tmp_path, capsys, page, number):
    file = tmp_path / "program.lp"
    file.write_text(programs(page)[number])
    assert main([str(file)]) == 0
    assert "no findings" in capsys.readouterr().out
